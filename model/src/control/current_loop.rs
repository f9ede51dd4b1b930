//! The motor's current: a PI loop, once a tick.
//!
//! ```text
//! setpoint ─ limit ─(+)── e ── K ──(+)── limit ──┬── v ── winding ──┬── i
//!                    │−             │+           │   a, 1/R         │
//!                    │              x <── lag a ─┘                  │
//!                    └──────────────────────────────────────────────┘
//!
//! v = limited(x + K·e)              a = e^(−R·h/L)   what a tick leaves of a current
//! x ← x + (1 − a)·(v − x)           g = 1 − e^(−2π·f·h)       K = g·R/(1 − a)
//! ```
//!
//! Unlimited, this is the PI law with the gain K and (1 − a)·K a tick. Its
//! zero is a, exactly the pole of the winding under a voltage that is held for
//! a tick, so i ← i + g·(setpoint − i): first order, without overshoot. At
//! 20 kHz, 1 kHz and the default winding K = 2.00 V/A and 6632 V/(A·s), where
//! the gains of continuous time, 2π·f·L = 2.14 V/A and 2π·f·R = 7728 V/(A·s),
//! put the zero at 0.819 instead of 0.835. Steps of the current, with the
//! voltage at once and a tick late (PWM registers that load at the next
//! period):
//!
//! | gains | late, ticks | overshoot | within 1 % after | −3 dB at |
//! |---|---|---|---|---|
//! | of the sampled winding | 0 | 0 | 15 ticks | 1009 Hz |
//! | | 1 | 0.06 % | 9 ticks | 1687 Hz |
//! | of continuous time | 0 | 0.6 % | 11 ticks | 1158 Hz |
//! | | 1 | 3.5 % | 15 ticks | 1949 Hz |
//!
//! With a tick of lateness the poles are those of z² − z + g: inside the
//! circle for every bandwidth, and just beyond critical at 1 kHz.
//!
//! The integrator x is a lag of the voltage that was *given*, with the
//! winding's own time: it is what the winding's current and the back-EMF
//! explain, R·i + E. So it stays right while the supply limits, cannot leave
//! ±supply, and there is nothing to unwind.
//!
//! A steady back-EMF is cancelled; one that jumps by 1 V moves the current by
//! 0.26 A for 0.3 ms, and one that grows by Ė leaves an error of Ė/6632 A (at
//! 20 rad/s² of the joint 10 mA, 33 mN·m).
//!
//! A real bridge loses voltage in its dead times, and its current is measured late: with `dead_time_us` or `lag_us`
//! the loop corrects that ([`current_path`](crate::control::current_path)), and costs nothing where both are zero.
//!
//! Sources: winding R and L of the maxon RE35 with 30 V winding, public
//! transcriptions of its data sheet; 1 kHz is an engineering estimate for
//! L/R = 0.28 ms; the current limit is the gear's short-time torque through its
//! losses, 6.5 N·m·0.7/(3.33 N·m/A).

use crate::control::current_path::{PathCorrection, PathNumbers};
use crate::joint::{LONGEST_STEP_S, SettingsError};
use crate::parameters::{Tabled, settings};
use crate::real::Real;

settings! {
    /// Assumed winding parameters, and limits of the current loop.
    pub struct CurrentLoopSettings, group "motor" {} {
        // The largest is a tenth of the tick: beyond, a voltage that is a tick late rings.
        bandwidth_hz (20 disarmed) "f" "Hz", 1.0..=2000.0, 1000.0,
            "bandwidth of the current loop: a step is followed with the time constant 1/2πf";
        resistance_ohm (21 disarmed) "R" "Ω", 0.01..=100.0, 1.23,
            "resistance of the winding that the device assumes; copper gains 39 % per 100 K";
        inductance_h (22 disarmed) "L" "H", 1e-6..=1.0, 0.34e-3, "inductance of the winding that the device assumes";
        // A quarter more has to be within what the supply's converter shows, 52.8 V.
        supply_v (23 disarmed) "U" "V", 1.0..=40.0, 24.0, "supply voltage of the bridge, in either direction";
        // The gear's short-time torque is the largest; the hardware trips at 1.95 A.
        current_limit_a (24 disarmed) "I" "A", 0.01..=1.37, 1.37,
            "largest current setpoint: 6.5 N·m at the joint of a hand that back-drives the gear";
        dead_time_us (141 disarmed) "td" "µs", 0.0..=1.0, 0.0,
            "dead time of timer and driver, fed forward as voltage against the sign of the current; 0 is an ideal bridge";
        lag_us (142 disarmed) "λ" "µs", 0.0..=2.0, 0.0,
            "time for which the measured current is late, taken out by the slope of the current; 0 is none";
    }
}

impl CurrentLoopSettings {
    /// Lag of the current behind its setpoint, in ticks of `step_s`
    /// between a tick's request and its measurement: 1/g = 1/(1 − e^(−2π·f·h)),
    /// 3.71 ticks by default, whether the voltage comes at once or a tick late.
    ///
    /// Each tick the current gains g of what it lacks, so it follows a ramp
    /// 1/g ticks behind. Together with the half tick for which a request is
    /// held, this is by how much a rendered spring lags: 4.21 ticks.
    pub fn lag_ticks(&self, step_s: f64) -> f64 {
        -1.0 / libm::expm1(-core::f64::consts::TAU * self.bandwidth_hz * step_s)
    }
}

impl CurrentLoopSettings {
    fn path(&self) -> PathNumbers {
        PathNumbers {
            inductance_h: self.inductance_h,
            supply_v: self.supply_v,
            dead_time_s: 1e-6 * self.dead_time_us,
            lag_s: 1e-6 * self.lag_us,
        }
    }
}

/// Limits of the current loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limit {
    /// The setpoint exceeds the current limit.
    Current,
    /// The supply has no more voltage; the current may have been limited too.
    Voltage,
}

/// The loop of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop<F> {
    /// K, V/A.
    gain: F,
    /// 1 − a.
    share_per_tick: F,
    /// Largest voltage, V.
    most_v: F,
    current_limit_a: F,
    /// x: the voltage that current and back-EMF explain, V.
    explained_v: F,
    limited_by: Option<Limit>,
    missed: u32,
    /// Corrections for bridge and amplifier, if there are any.
    path: Option<PathCorrection<F>>,
    /// Voltage of the last tick against the dead time, V.
    fed_v: F,
}

impl<F: Real> CurrentLoop<F> {
    /// A loop at rest that is called every `step_s`. Gains are computed in f64
    /// and rounded once.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting or the step is out of range.
    pub fn new(settings: &CurrentLoopSettings, step_s: f64) -> Result<Self, SettingsError> {
        settings.validate()?;
        if !(step_s > 0.0 && step_s <= LONGEST_STEP_S) {
            return Err(SettingsError::Step { step_s });
        }
        // 1 − e^(−x), exact for small x too.
        let share = |x: f64| -libm::expm1(-x);
        let winding = share(settings.resistance_ohm * step_s / settings.inductance_h);
        let reach = share(core::f64::consts::TAU * settings.bandwidth_hz * step_s);
        Ok(Self {
            gain: F::from_f64(reach * settings.resistance_ohm / winding),
            share_per_tick: F::from_f64(winding),
            most_v: F::from_f64(settings.supply_v),
            current_limit_a: F::from_f64(settings.current_limit_a),
            explained_v: F::ZERO,
            limited_by: None,
            missed: 0,
            path: PathCorrection::new(&settings.path(), step_s, reach),
            fed_v: F::ZERO,
        })
    }

    /// Returns the loop with this share of the supply's voltage as its largest.
    #[must_use]
    pub fn with_largest_duty(self, share: F) -> Self {
        Self {
            most_v: self.most_v * share,
            ..self
        }
    }

    /// The measured current, A, without the lag of its measurement.
    #[inline]
    pub fn corrected_a(&self, measured_a: F) -> F {
        match &self.path {
            Some(path) => path.corrected_a(measured_a, self.explained_v),
            None => measured_a,
        }
    }

    /// The part of the last tick's voltage that the dead time takes, V: the winding gets the rest.
    #[inline]
    pub fn fed_v(&self) -> F {
        self.fed_v
    }

    /// Runs one tick; returns the voltage of the bridge, V, for the current setpoint and the one
    /// just measured, [corrected](Self::corrected_a), A.
    ///
    /// Without a finite number for both it is 0 V, the integrator stays, and
    /// the tick is counted in [`Self::missed`]. 0 V never drives the motor, but
    /// it shorts the terminals: the shaft is braked, by 0.45 A a tick for each
    /// rad/s of the joint. So where a measurement stays away, let the bridge
    /// float instead.
    #[inline]
    pub fn tick(&mut self, setpoint_a: F, measured_a: F) -> F {
        if !(setpoint_a.is_finite() && measured_a.is_finite()) {
            self.missed = self.missed.saturating_add(1);
            return F::ZERO;
        }
        let allowed_a = setpoint_a.within(self.current_limit_a);
        let unlimited_v = self.explained_v + self.gain * (allowed_a - measured_a);
        let (asked_v, fed_v) = match &mut self.path {
            Some(path) => {
                let fed_v = path.feed_v(allowed_a, unlimited_v.within(self.most_v));
                (unlimited_v + fed_v, fed_v)
            }
            None => (unlimited_v, F::ZERO),
        };
        let volts = asked_v.within(self.most_v);
        self.limited_by = if volts != asked_v {
            Some(Limit::Voltage)
        } else if allowed_a != setpoint_a {
            Some(Limit::Current)
        } else {
            None
        };
        self.fed_v = fed_v;
        self.explained_v += self.share_per_tick * (volts - fed_v - self.explained_v);
        self.explained_v = self.explained_v.settled();
        volts
    }

    /// Takes over from a voltage that current and back-EMF explain: a shaft
    /// that already turns is not jolted.
    pub fn start(&mut self, volts: F) {
        self.explained_v = volts.within(self.most_v);
        self.forget_path();
    }

    /// Resets the loop, for disarming. The counters are kept.
    pub fn reset(&mut self) {
        self.explained_v = F::ZERO;
        self.limited_by = None;
        self.forget_path();
    }

    fn forget_path(&mut self) {
        self.fed_v = F::ZERO;
        if let Some(path) = &mut self.path {
            path.reset();
        }
    }

    /// Limit that acted in the last tick that had its measurement.
    pub fn limited_by(&self) -> Option<Limit> {
        self.limited_by
    }

    /// Ticks without a measurement so far.
    pub fn missed(&self) -> u32 {
        self.missed
    }
}

#[cfg(test)]
mod tests;
