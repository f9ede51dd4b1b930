//! A hanging weight that the device pulls aside and lets down, by a soft spring with a neutral angle that moves.

use crate::failure::Failure;
use crate::following::Follower;
use crate::line::{Line, failure};
use crate::status_line::StatusLine;
use crepitus_client::Client;
use crepitus_identify::hanging::{Mean, means};
use crepitus_model::parameters::{Source, Tabled};
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_protocol::telemetry::{Block, NO_CURRENT};
use crepitus_protocol::{DeviceSettings, Revision, Values};
use std::time::Duration;

/// Speed of the neutral angle, rad/s: 8 deg/s. A weight with 0.3 kg·m² that moves as fast has 3 mJ.
const SPEED_RAD_S: f64 = 0.14;

/// Time between two steps of the neutral angle.
const BETWEEN: Duration = Duration::from_millis(20);

/// Largest arc over which the weight is moved, rad: 100 deg.
const ARC_RAD: f64 = 1.75;

/// Share of the lasting torque that is used.
const SHARE: f64 = 0.92;

/// Room before the torque fades at an end of the range, deg.
const ROOM_DEG: f64 = 2.0;

/// Longer than a whole arc takes.
pub(super) const MOST: Duration = Duration::from_secs(90);

/// Time for which the weight is awaited once the neutral angle cannot move further.
const AWAITED: Duration = Duration::from_millis(700);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    There,
    Back,
    Done,
}

/// The experiment.
pub(super) struct Pulled {
    values: Values,
    revision: Revision,
    rad_per_count: f64,
    lead_pipe: LeadPipeSettings,
    most_torque_nm: f64,
    ends_rad: (f64, f64),
    from_rad: f64,
    sense: f64,
    way: Way,
    angle_rad: f64,
    torque_nm: f64,
    neutral_rad: f64,
    moved_at: Option<Duration>,
    stuck_since: Option<Duration>,
    there: Vec<(f64, f64)>,
    back: Vec<(f64, f64)>,
    status: StatusLine,
}

/// Bounds of the neutral angle, rad.
fn neutral_bounds() -> (f64, f64) {
    let spec = LeadPipeSettings::TABLE
        .iter()
        .find(|spec| spec.key == "neutral_deg");
    spec.map_or((0.0, 0.0), |spec| {
        (spec.min.to_radians(), spec.max.to_radians())
    })
}

/// The spring at this angle, as soft as its parameters are but no softer than they allow.
pub(super) fn spring_at(angle_rad: f64) -> LeadPipeSettings {
    let (least, most) = neutral_bounds();
    let stiffest = LeadPipeSettings::TABLE
        .iter()
        .find(|spec| spec.key == "elastic_nm_per_rad");
    LeadPipeSettings {
        torque_nm: 0.0,
        elastic_nm_per_rad: stiffest.map_or(0.0, |spec| spec.max),
        neutral_deg: angle_rad.clamp(least, most).to_degrees(),
        ..LeadPipeSettings::default()
    }
}

impl Pulled {
    /// Returns the experiment with the spring's parameters in use.
    pub(super) fn new(
        values: &Values,
        revision: Revision,
        settings: &DeviceSettings,
        from_rad: f64,
    ) -> Self {
        let lead_pipe: LeadPipeSettings = values.read();
        let range = &settings.range;
        let least = (range.least_deg + range.fade_deg + ROOM_DEG).to_radians();
        let most = (range.most_deg - range.fade_deg - ROOM_DEG).to_radians();
        let lasting_nm = settings
            .motor
            .continuous_a
            .min(settings.current_loop.current_limit_a)
            * settings.joint_constant();
        Self {
            values: *values,
            revision,
            rad_per_count: settings.encoder.rad_per_count(),
            most_torque_nm: SHARE * lasting_nm.min(settings.limits.torque_nm),
            ends_rad: (least, most),
            from_rad,
            sense: if most - from_rad >= from_rad - least {
                1.0
            } else {
                -1.0
            },
            way: Way::There,
            angle_rad: from_rad,
            torque_nm: 0.0,
            neutral_rad: lead_pipe.neutral_deg.to_radians(),
            lead_pipe,
            moved_at: None,
            stuck_since: None,
            there: Vec::new(),
            back: Vec::new(),
            status: StatusLine::new(),
        }
    }

    /// Mean currents of both ways.
    pub(super) fn means(&self) -> Vec<Mean> {
        let mut all = means(&self.there, self.sense);
        all.extend(means(&self.back, -self.sense));
        all
    }

    /// Returns whether both ways were taken to their ends.
    pub(super) fn is_done(&self) -> bool {
        self.way == Way::Done
    }

    /// Arc over which the weight was moved, rad.
    pub(super) fn arc_rad(&self) -> f64 {
        let furthest = self
            .there
            .iter()
            .map(|(angle, _)| (angle - self.from_rad) * self.sense);
        furthest.fold(0.0, f64::max)
    }

    /// Returns whether the present way is at its end. The torque grows only until the weight gives way.
    fn is_at_end(&self, now: Duration) -> bool {
        let gone = (self.angle_rad - self.from_rad) * self.sense;
        let is_stuck = self.stuck_since.is_some_and(|since| now >= since + AWAITED);
        // T > 0 opposes growing angle: on the leg it acts the other way.
        let pull = -self.torque_nm * self.sense;
        match self.way {
            Way::There => {
                let is_at_range = if self.sense > 0.0 {
                    self.angle_rad >= self.ends_rad.1
                } else {
                    self.angle_rad <= self.ends_rad.0
                };
                gone >= ARC_RAD || is_at_range || pull >= self.most_torque_nm || is_stuck
            }
            Way::Back => gone <= 0.0 || pull <= -self.most_torque_nm || is_stuck,
            Way::Done => true,
        }
    }

    /// Moves the neutral angle on.
    fn pull(&mut self, client: &mut Client<Line>, passed: Duration) -> Result<(), Failure> {
        let sense = if self.way == Way::There {
            self.sense
        } else {
            -self.sense
        };
        let (least, most) = neutral_bounds();
        let step = SPEED_RAD_S * passed.min(4 * BETWEEN).as_secs_f64();
        let neutral = (self.neutral_rad + sense * step).clamp(least, most);
        if (neutral - self.neutral_rad).abs() < 1e-9 {
            self.stuck_since.get_or_insert(client.now());
            return Ok(());
        }
        self.stuck_since = None;
        self.neutral_rad = neutral;
        self.lead_pipe.neutral_deg = neutral.to_degrees();
        self.values = self.values.with(&self.lead_pipe);
        self.revision = client
            .commit(self.revision, &self.values)
            .map_err(failure)?;
        Ok(())
    }
}

impl Follower for Pulled {
    fn block(&mut self, _: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        let currents = block
            .samples
            .iter()
            .filter(|sample| sample.current_ma != NO_CURRENT);
        let (sum, count) = currents.fold((0.0, 0.0), |(sum, n), s| {
            (sum + f64::from(s.current_ma) * 1e-3, n + 1.0)
        });
        if let Some(last) = block.samples.last() {
            self.angle_rad = f64::from(last.count) * self.rad_per_count;
            self.torque_nm = f64::from(last.torque_nm);
        }
        if count > 0.0 && self.moved_at.is_some() {
            match self.way {
                Way::There => self.there.push((self.angle_rad, sum / count)),
                Way::Back => self.back.push((self.angle_rad, sum / count)),
                Way::Done => {}
            }
        }
        self.status.block(block);
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        self.status.show(client.accounting());
        let now = client.now();
        let moved_at = *self.moved_at.get_or_insert(now);
        if self.is_at_end(now) {
            self.stuck_since = None;
            self.way = if self.way == Way::There {
                Way::Back
            } else {
                Way::Done
            };
        }
        if self.way == Way::Done {
            return Ok(true);
        }
        if now >= moved_at + BETWEEN {
            self.pull(client, now.saturating_sub(moved_at))?;
            self.moved_at = Some(now);
        }
        Ok(false)
    }
}
