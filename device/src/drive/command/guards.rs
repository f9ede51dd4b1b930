//! Checks that withdraw the permit of a tick.

use crate::counters::Counters;
use crate::drive::coil::CoilOutput;
use crate::drive::command::Command;
use crate::drive::emf_check;
use crate::drive::exchange::Rendered;
use crate::drive::plausibility::Observation;
use crate::drive::safety::Permit;
use crate::drive::sampler::LOST_TICKS;
use crepitus_model::Real;
use crepitus_protocol::Fault;
use crepitus_protocol::counters::DriveCounter;

/// Ticks for which the enable line of comms may be off though comms permits torque:
/// more than the timeout of heartbeats, which says what is the matter. Four ticks with the
/// line make up for one, so that one that comes and goes ends, too.
const COMMS_LINE_TICKS: u32 = 120;
const TICK_WITHOUT: u32 = 4;

/// Largest current of a floating bridge, A: twice the largest offset.
const FLOATING_A: f32 = 0.2;

/// Ticks for which the current of a floating bridge may be larger: it dies away within one.
const FLOATING_TICKS: u32 = 20;

impl Command {
    /// Lets the bridge float while the enable line of comms is off, so that the
    /// checks do not take an open bridge for a broken sensor. The reason follows on
    /// the link; without one, the wire is broken.
    pub(super) fn with_comms(
        &mut self,
        permit: Permit,
        is_on: bool,
        counters: &Counters,
    ) -> Permit {
        let is_driving = matches!(permit, Permit::Torque | Permit::Push(_));
        if is_on || !is_driving {
            self.without_comms = self.without_comms.saturating_sub(1);
            return permit;
        }
        self.without_comms = self.without_comms.saturating_add(TICK_WITHOUT);
        if self.without_comms < TICK_WITHOUT * COMMS_LINE_TICKS {
            return Permit::Line;
        }
        self.safety.fail(Fault::CommsLineOff, counters);
        Permit::Nothing
    }

    /// Withdraws the permit outside the range of motion, or without a zero of it, and for what
    /// changes slowly.
    pub(super) fn guarded(
        &mut self,
        permit: Permit,
        slow: Option<Fault>,
        fades_left: f32,
        current_a: Option<f32>,
        counters: &Counters,
    ) -> Permit {
        let overload = self.overload.tick(current_a);
        let live = if self.lost_ticks > LOST_TICKS && self.safety.is_live() {
            // Another count is taken for the angle, of which the zero is not known.
            Some(Fault::EncoderLost)
        } else if self.safety.is_live() {
            self.range.check(fades_left).or(overload)
        } else {
            None
        };
        match slow.or(live) {
            None => permit,
            Some(fault) => {
                self.safety.fail(fault, counters);
                Permit::Nothing
            }
        }
    }

    /// The angle's zero is no longer known after counts that may be wrong.
    pub(super) fn doubt_zero(&mut self, fault_before: Option<Fault>) {
        let fault = self.safety.fault().filter(|_| fault_before.is_none());
        if fault.is_some_and(Fault::doubts_angle) || self.lost_ticks > LOST_TICKS {
            self.zeroed = false;
        }
    }

    /// Compares back-EMF with the counts; true if they contradict each other.
    pub(super) fn check_emf(
        &mut self,
        rendered: &Rendered,
        current_a: Option<f32>,
        is_late: bool,
    ) -> bool {
        let is_sound = !is_late && rendered.lost_ticks == 0;
        let tick = (self.motor.mean_v().zip(current_a))
            .filter(|_| is_sound)
            .map(|(volts, current_a)| emf_check::Tick {
                volts,
                current_a,
                count: rendered.count,
            });
        let (motor, batch) = (self.motor.plan(), &self.batch);
        self.emf_check
            .contradicts(tick, motor, self.rad_per_count, || {
                batch.ends_blocks_from_here()
            })
    }

    /// Withdraws the permit if a floating bridge has a current: a shorted switch and a diode
    /// would brake. Both sensors have to agree, in its sign, too.
    pub(super) fn floating(
        &mut self,
        permit: Permit,
        currents_a: Option<(f32, f32)>,
        omega_rad_s: f32,
        counters: &Counters,
    ) -> Permit {
        let conducts = currents_a.is_some_and(|(sensor_a, monitor_a)| {
            sensor_a.abs() > FLOATING_A
                && monitor_a.abs() > FLOATING_A
                && sensor_a * monitor_a > 0.0
        });
        let is_slow = omega_rad_s.abs() < self.motor.plan().floats_below_rad_s;
        self.conducting_ticks = if conducts && is_slow && !self.was_driven {
            self.conducting_ticks.saturating_add(1)
        } else {
            0
        };
        if self.conducting_ticks < FLOATING_TICKS {
            return permit;
        }
        self.safety.fail(Fault::CurrentWhileFloating, counters);
        Permit::Nothing
    }

    /// Output of the coil: driven with the torque only, so that every fault of the motor,
    /// the lines and the link silences it. Its own faults leave the motor alone.
    // By value: inputs that are lent would lie in memory in every tick.
    #[inline(never)]
    pub(super) fn drive_coil(
        &mut self,
        may: bool,
        coil_v: f32,
        coil_a: Option<f32>,
        has_tripped: bool,
        counters: &Counters,
    ) -> CoilOutput {
        let (fault_before, was_driven) = (self.coil.fault(), self.coil.is_driven());
        let chirp_v = self.chirped(may, coil_v);
        self.has_chirped = chirp_v.is_some();
        let coil_v = chirp_v.unwrap_or(coil_v);
        let output = self.coil.tick(coil_v, may, coil_a, has_tripped);
        if self.coil.fault() != fault_before {
            counters.count(DriveCounter::Faults);
        }
        if was_driven {
            self.batch.add_coil(coil_a, output == CoilOutput::Asleep);
        }
        self.has_coil = self.coil.is_in_use();
        output
    }

    /// The voltage of the chirp, if one is played. It ends for good with the torque, with
    /// a fault of the coil, and where the renderer has a voltage of its own: a gain that is
    /// committed meanwhile would fade in unseen, and be a step at the chirp's end.
    fn chirped(&mut self, may: bool, coil_v: f32) -> Option<f32> {
        let chirp = self.chirp.as_mut()?;
        if !may || coil_v != 0.0 || self.coil.fault().is_some() || chirp.is_over() {
            self.chirp = None;
            return None;
        }
        Some(chirp.tick())
    }

    /// Withdraws the permit if a plausibility check fails.
    pub(super) fn checked(
        &mut self,
        permit: Permit,
        observation: &Observation,
        counters: &Counters,
    ) -> Permit {
        let limit_rad_s = (self.speed_limit_rad_s).at_most(self.slow_checks.held_rad_s());
        let fault = (self.plausibility).check(observation, &self.motor, limit_rad_s);
        match fault {
            None => permit,
            Some(fault) => {
                self.safety.fail(fault, counters);
                Permit::Nothing
            }
        }
    }
}
