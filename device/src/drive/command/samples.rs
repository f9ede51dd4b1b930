//! A tick as telemetry shows it.

use crate::counters::Counters;
use crate::drive::command::Command;
use crate::drive::exchange::Rendered;
use crate::drive::milliamperes::milliamperes;
use crepitus_model::control::current_loop::Limit;
use crepitus_protocol::LimitReason;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::telemetry::{NO_CURRENT, Sample, SampleFlags};

impl Command {
    pub(super) fn sample(
        &self,
        applied_nm: Option<f32>,
        fades: bool,
        rendered: &Rendered,
        current_a: Option<f32>,
        is_late: bool,
        counters: &Counters,
    ) -> Sample {
        let is_energised = applied_nm.is_some();
        let by_motor = match self.motor.limited_by() {
            Some(Limit::Current) => LimitReason::Current,
            Some(Limit::Voltage) => LimitReason::Voltage,
            None => LimitReason::None,
        };
        let limit = match (is_energised, rendered.flags.limit()) {
            (false, _) => LimitReason::NotArmed,
            (true, LimitReason::None | LimitReason::NotArmed) if fades => LimitReason::Range,
            (true, LimitReason::None | LimitReason::NotArmed) => by_motor,
            (true, reason) => reason,
        };
        for (counter, is_active) in [
            (DriveCounter::LostSamples, rendered.lost_ticks > 0),
            (DriveCounter::LateTicks, is_late),
            (DriveCounter::MissedCurrents, current_a.is_none()),
            (
                DriveCounter::LimitedTicks,
                is_energised && limit != LimitReason::None,
            ),
        ] {
            if is_active {
                counters.count(counter);
            }
        }
        Sample {
            count: self.count_from_zero(),
            model_torque_nm: rendered.model_torque_nm,
            torque_nm: applied_nm.unwrap_or(0.0),
            current_ma: current_a.map_or(NO_CURRENT, milliamperes),
            flags: rendered
                .flags
                .with_limit(limit)
                .with(SampleFlags::ENERGISED, is_energised)
                .with(SampleFlags::LATE, is_late)
                .with(SampleFlags::CHIRP, self.has_chirped),
        }
    }
}
