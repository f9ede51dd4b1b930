//! The target of a hand: chosen, scored, shown.

use super::DeviceThread;
use crate::live::{Aim, Pace, Target};
use crate::request::AimAt;
use crate::shared::Outcome;
use crepitus_client::Transport;
use serde_json::{Value, json};
use std::time::Instant;

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn set_target(&mut self, target: Option<AimAt>) -> Outcome {
        let target = match target {
            None => None,
            Some(AimAt::Named(name)) => Some(Target::find(&name).ok_or_else(|| {
                let names: Vec<_> = crate::live::NAMED.iter().map(|t| t.name).collect();
                format!("no target {name:?}: expected one of {}", names.join(", "))
            })?),
            Some(AimAt::Beat { beats_per_min }) => Some(own(Aim::Metronome { beats_per_min })?),
            Some(AimAt::Band {
                low_deg_per_s,
                high_deg_per_s,
            }) => Some(own(Aim::Speed {
                low_deg_per_s,
                high_deg_per_s,
            })?),
        };
        self.pace = target.map(Pace::new);
        self.publish_target();
        Ok(Value::Null)
    }

    pub(super) fn set_scoring(&mut self, running: bool) -> Outcome {
        let Some(pace) = &mut self.pace else {
            return Err("no target is chosen: choose one first".to_owned());
        };
        pace.set_scoring(running);
        self.publish_target();
        Ok(Value::Null)
    }

    pub(super) fn publish_target(&mut self) {
        self.score_at = Instant::now();
        let target = match &self.pace {
            None => json!({ "target": Value::Null, "by_person": self.examined.by_person }),
            Some(pace) => {
                let mut target = json!(pace.score());
                target["target"] = json!(pace.target());
                target["running"] = json!(pace.is_scoring());
                target["verdict"] = json!(pace.verdict());
                target["by_person"] = json!(self.examined.by_person);
                target
            }
        };
        self.publish(|latest| &mut latest.target, &json!({ "target": target }));
    }
}

fn own(aim: Aim) -> Result<Target, String> {
    Target::own(aim).map_err(|error| error.to_string())
}
