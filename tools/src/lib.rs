//! Checks of the project itself.
//!
//! | to find | look in |
//! |---|---|
//! | what a firmware image holds and what its interrupts can reach, against a budget | [`image`], `crepitus-image` |
//! | planted faults, and which test notices each | [`faults`], `crepitus-faults` |
//! | the page's knee in WebAssembly, and that it is built of these sources | [`knee_page`], `crepitus-knee-page` |

pub mod faults;
pub mod image;
pub mod knee_page;
