//! The lessons that ship: the folder `lessons`, embedded.

use crate::lesson::plan::{Plan, PlanError};

/// A lesson's file, embedded.
#[derive(Clone, Copy, Debug)]
pub struct PlanFile {
    /// File name without `.toml`.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        /// All of them, in the order of lists.
        pub const FILES: &[PlanFile] = &[$(PlanFile {
            name: $name,
            text: include_str!(concat!("../../../../lessons/", $name, ".toml")),
        }),*];
    };
}

files![
    "first-knees",
    "end-feels",
    "grades-of-spasticity",
    "blind-six",
];

impl PlanFile {
    /// Reads it.
    ///
    /// # Errors
    /// [`PlanError::Form`]; a test reads every lesson that ships.
    pub fn read(&self) -> Result<Plan, PlanError> {
        Plan::from_toml(self.text)
    }
}

/// The lesson of this name that ships.
pub fn find(name: &str) -> Option<&'static PlanFile> {
    FILES.iter().find(|file| file.name == name)
}
