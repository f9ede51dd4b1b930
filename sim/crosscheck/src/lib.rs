//! # A second solver, and a corpus to compare it on
//!
//! Every other solver is measured against `reference`. This crate checks
//! `reference`: it solves the same problems by other mathematics, with
//! twice the digits, on thousands of random cases. The book's page on the
//! cross-check has the equations and the figures.
//!
//! | to find | look in |
//! |---|---|
//! | numbers of 31 digits; sine and arc tangent from their series | [`double_double`], [`circle`] |
//! | Taylor polynomials with a bound of the remainder; their first zero | [`series`], [`mod@first_fall`] |
//! | the shaft's and the object's motion as such polynomials | [`shaft`], [`swing`] |
//! | the joint from event to event | [`solver`], [`event`] |
//! | cases decided by the rounding of f64 | [`rounding`] |
//! | the random cases | [`corpus`] |
//! | `reference` under a time limit, and its sign law | [`theirs`], [`wire`], [`watched`] |
//! | the verdict on a case | [`compare`] |
//! | pieces, counts, tables | [`journal`], [`summary`] |

pub mod circle;
pub mod compare;
pub mod corpus;
pub mod double_double;
pub mod event;
pub mod first_fall;
pub mod journal;
pub mod rounding;
pub mod series;
pub mod shaft;
pub mod solver;
pub mod summary;
pub mod swing;
pub mod theirs;
pub mod watched;
pub mod wire;
