//! Checks of the project itself.
//!
//! | to find | look in |
//! |---|---|
//! | what a firmware image holds and what its interrupts can reach, against a budget | [`image`], `crepitus-image` |
//! | planted faults, and which test notices each | [`faults`], `crepitus-faults` |

pub mod faults;
pub mod image;
