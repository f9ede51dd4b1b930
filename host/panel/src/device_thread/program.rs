//! The program around the panel.

use crepitus_client::{Client, Error};
use crepitus_protocol::Session;
use crepitus_scene::preset::Preset;

/// Services that the program around the panel provides.
pub trait Program<T> {
    /// An error as text for people.
    fn explain(&self, client: &mut Client<T>, error: Error) -> String;

    /// The program of this session, for people.
    fn holder(&self, client: &mut Client<T>, session: Session) -> String;

    /// The user's own presets; files that cannot be read are left out.
    fn own_presets(&self) -> Vec<Preset>;

    /// Saves one of them.
    ///
    /// # Errors
    /// A text for people.
    fn save_preset(&self, name: &str, preset: &Preset, replace: bool) -> Result<(), String>;

    /// Returns whether the program has been asked to end.
    fn has_ended(&self) -> bool;
}
