//! Tables, charts, reports and sound: a run as people see and hear it.
//!
//! | to find | look in |
//! |---|---|
//! | one definition of a table as CSV, JSON, terminal text, Markdown and HTML | [`table`] |
//! | charts as SVG and PDF, and the frame of a page | [`plot`] |
//! | the report of a run or a recording | [`report`] |
//! | what a device's samples come to on it | [`recorded`] |
//! | a torque as sound | [`sound`] |
//! | the last line of a page, lines that fit | [`words`] |
#![forbid(unsafe_code)]

pub mod plot;
pub mod recorded;
pub mod report;
pub mod sound;
pub mod table;
pub mod words;
