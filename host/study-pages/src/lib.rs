//! # The pages of the studies
//!
//! A study yields data; here it is decided how they are drawn. Each page is one
//! HTML file that needs nothing else, and each of its charts can be a picture
//! of its own.
//!
//! | to find | look in |
//! |---|---|
//! | work-precision diagrams: what accuracy costs in time | [`accuracy`] |
//! | the matrix of hard cases | [`stability`] |
//! | pictures that explain one hard case each | [`story`] |
//! | the map of stiffness on a leg | [`coupled`] |
//! | what the hand gets of the actuator on the shell | [`vibration`] |
//! | the effects of a scene: influence against cost | [`effects`] |

// Counts become numbers to be drawn; none comes near 2^53.
#![allow(clippy::cast_precision_loss)]

pub mod accuracy;
pub mod coupled;
pub mod effects;
pub mod stability;
pub mod story;
pub mod vibration;

pub use crepitus_pages::plot::page::Section;
pub use crepitus_pages::plot::{Column, Paper, Picture};

/// The words of a page. All of them are escaped on it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StudyText {
    /// The title of the page.
    pub title: String,
    /// Subject, method and result; line breaks are kept.
    pub intro: String,
    /// Notes for the reader, one paragraph each, at the end.
    pub notes: Vec<String>,
    /// The tables, in order, below the charts.
    pub tables: Vec<Section>,
    /// The last line: versions, for example.
    pub footer: String,
}
