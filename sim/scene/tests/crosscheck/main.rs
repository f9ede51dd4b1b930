//! # A second solver, and a corpus to compare it on
//!
//! Every other solver is measured against `reference`. This program checks
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
//! | the tests on the corpus; one case in full | [`runs`], [`show`] |
//! | the tests on the cases with 50 digits | [`reference_cases`] |
#![allow(unreachable_pub)]

mod circle;
mod compare;
mod corpus;
mod double_double;
mod event;
mod first_fall;
mod journal;
mod reference_cases;
mod rounding;
mod runs;
mod series;
mod shaft;
mod show;
mod solver;
mod summary;
mod swing;
mod theirs;
mod watched;
mod wire;
