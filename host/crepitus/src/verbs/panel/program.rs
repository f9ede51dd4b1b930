//! Knowledge and services of the tool for the panel.

use crate::interrupt;
use crate::line::{Line, failure_with, holder, named};
use crate::own_presets;
use crepitus_client::{Client, Error};
use crepitus_panel::Program;
use crepitus_protocol::Session;
use crepitus_scene::preset::Preset;

/// This program.
pub(super) struct ThisProgram;

impl Program<Line> for ThisProgram {
    fn explain(&self, client: &mut Client<Line>, error: Error) -> String {
        failure_with(client, error).into_text()
    }

    fn holder(&self, client: &mut Client<Line>, session: Session) -> String {
        holder(client, session).map_or_else(
            || "another program".to_owned(),
            |program| named(&program).trim_end_matches(',').to_owned(),
        )
    }

    fn own_presets(&self) -> Vec<Preset> {
        let own = own_presets::all().into_iter();
        own.map(|(preset, _)| preset).collect()
    }

    fn save_preset(&self, name: &str, preset: &Preset, replace: bool) -> Result<(), String> {
        match own_presets::write(name, preset, replace) {
            Ok(_) => Ok(()),
            Err(failure) => Err(failure.into_text()),
        }
    }

    fn has_ended(&self) -> bool {
        interrupt::requested()
    }
}
