//! The knee of a page: hand, leg and pipeline, a frame at a time.
//!
//! ```text
//! display, 30 to 120 Hz     hand(angle) ─> advance(ticks) ─> columns of so many samples
//! 20 kHz                                   HandPath ─ Leg ─ counts ─ Pipeline
//! ```
//!
//! The resistance that a tick renders acts on the leg in the next one. Angle and speed are those that the
//! device measures, torque is what it asks of its motor. An examination takes every sample.

mod columns;
#[cfg(target_arch = "wasm32")]
mod exports;
mod findings;

pub use columns::{Columns, MOST_TICKS, ROOM};
pub use findings::{Findings, OUTCOMES};

use crate::examination::{COUNT, Examination, Step};
use crate::hand::{HandPath, HandState};
use crate::leg::Leg;
use crate::pipeline::{Pipeline, healthy};
use columns::Sample;
use crepitus_model::control::device_limits::RangeSettings;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::render::position::Sensing;
use crepitus_model::{Phase, Real, StickSlip};
use crepitus_protocol::parameters::with_id;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{DeviceSettings, TICK_S, ValueError, Values};

/// Ticks in which a device at its defaults settles, at most: 0.1 s.
const SETTLING_TICKS: u32 = 2_000;

/// A knee with the leg that it is of, and the hand that holds it.
struct Knee {
    pipeline: Pipeline,
    leg: Leg,
    /// Path of the hand while it holds the leg.
    hand: Option<HandPath>,
    sensing: Sensing,
    /// Resistance that the last tick rendered.
    torque_nm: f32,
    /// Values of the last commit, and those of the next one.
    committed: Values,
    staged: Values,
    breaks: u32,
    /// Examination of the knee since the last commit, and its ticks.
    examination: Examination,
    examined: u32,
}

impl Knee {
    fn healthy() -> Result<Self, ValueError> {
        let values = healthy();
        let mut pipeline = Pipeline::new(0)?;
        pipeline.commit(&values)?;
        for _ in 0..SETTLING_TICKS {
            if !pipeline.is_settling() {
                break;
            }
            pipeline.tick(0, false);
        }
        // Nobody arms a page: from here on torque is on.
        pipeline.tick(0, true);
        Ok(Self {
            pipeline,
            leg: Leg::straight(&RangeSettings::default()),
            hand: Some(HandPath::taking(HandState::default())),
            sensing: Sensing::of_encoder(&EncoderSettings::default()),
            torque_nm: 0.0,
            committed: values,
            staged: values,
            breaks: 0,
            examination: Examination::default(),
            examined: 0,
        })
    }

    fn commit(&mut self) -> Result<(), ValueError> {
        let committed = self.pipeline.commit(&self.staged);
        if committed.is_ok() {
            self.committed = self.staged;
            self.examine();
        } else {
            self.staged = self.committed;
        }
        committed
    }

    /// Begins the examination of the knee that is committed.
    fn examine(&mut self) {
        self.examined = 0;
        self.examination = DeviceSettings::of(&self.committed).map_or_else(
            |_| Examination::default(),
            |settings| Examination::new(&settings.effects, settings.crepitus.is_some()),
        );
    }

    fn hold(&mut self, angle_rad: f64) {
        // A hand takes the leg where it is, as it moves.
        let leg = HandState {
            angle_rad: self.leg.angle_rad(),
            omega_rad_s: self.leg.omega_rad_s(),
        };
        self.hand
            .get_or_insert_with(|| HandPath::taking(leg))
            .aim(angle_rad);
    }

    /// Count of the encoder: whole counts of the leg's angle, rounded down.
    fn count(&self) -> i32 {
        let place = self.sensing.position::<f64>(self.leg.angle_rad());
        if place.rest_rad < 0.0 {
            place.count.wrapping_sub(1)
        } else {
            place.count
        }
    }

    /// One tick.
    fn tick(&mut self) -> Sample {
        let resistance_nm = f64::from(self.torque_nm);
        self.leg.step(resistance_nm, self.hand.as_mut());
        let count = self.count();
        let rendered = self.pipeline.tick(count.cast_unsigned(), true);
        self.torque_nm = rendered.torque_nm;
        if rendered.flags.has(SampleFlags::BREAK) {
            self.breaks = self.breaks.wrapping_add(1);
        }
        let counted_rad = f64::from(count) * self.sensing.rad_per_count;
        self.examined = self.examined.saturating_add(1);
        self.examination.take(
            f64::from(self.examined) * TICK_S,
            counted_rad,
            f64::from(rendered.omega_rad_s),
            f64::from(rendered.model_torque_nm),
        );
        let leg_rad = self.leg.angle_rad();
        let hand_rad = self.hand.map_or(leg_rad, |hand| hand.state().angle_rad);
        let joint = self.pipeline.joint();
        let object_rad = joint.map_or(0.0, StickSlip::theta_rad);
        Sample {
            torque_nm: rendered.torque_nm,
            angle_rad: f32::from_f64(counted_rad),
            speed_rad_s: rendered.omega_rad_s,
            hand_rad: f32::from_f64(hand_rad),
            object_rad,
            spring_nm: joint.map_or(0.0, |joint| joint.coefficients().stiffness * object_rad),
            states: rendered.phases.states(),
            phase: joint.map_or(0, |joint| match joint.phase() {
                Phase::Stick => 1,
                Phase::Slip(_) => 2,
            }),
        }
    }
}

/// Place of the knee. With a tag of its own, 0 for none, a page is all zeros before it begins: its file leaves
/// them out.
#[repr(u8)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one, and it is never moved"
)]
enum Slot {
    Empty,
    Knee(Knee),
}

/// All that a page computes.
pub struct Page {
    slot: Slot,
    columns: Columns,
    measures: [f32; COUNT],
    findings: Findings,
}

impl Default for Page {
    fn default() -> Self {
        Self::new()
    }
}

impl Page {
    /// A page without a knee: all calls but [`Self::begin`] do nothing.
    pub const fn new() -> Self {
        Self {
            slot: Slot::Empty,
            columns: Columns::EMPTY,
            measures: [0.0; COUNT],
            findings: Findings::EMPTY,
        }
    }

    fn knee(&mut self) -> Option<&mut Knee> {
        match &mut self.slot {
            Slot::Empty => None,
            Slot::Knee(knee) => Some(knee),
        }
    }

    /// Begins, also again: a healthy knee, straight, held by the hand.
    ///
    /// # Errors
    /// [`ValueError`] if the default values are invalid: a bug in their table, which a test excludes.
    pub fn begin(&mut self) -> Result<(), ValueError> {
        self.slot = Slot::Knee(Knee::healthy()?);
        self.examined();
        Ok(())
    }

    /// Takes over what the examination has measured and found.
    fn examined(&mut self) {
        if let Slot::Knee(knee) = &self.slot {
            self.measures = knee.examination.measures().map(f32::from_f64);
            self.findings = Findings::of(&knee.examination);
        }
    }

    /// Stages a value of the next [`Self::commit`]. Returns whether there is such a parameter.
    pub fn set(&mut self, id: u32, value: f64) -> bool {
        let known = u8::try_from(id).ok().filter(|id| with_id(*id).is_some());
        if let (Some(id), Some(knee)) = (known, self.knee()) {
            knee.staged.set(id, value);
        }
        known.is_some()
    }

    /// Applies what is staged, with ramps as on a device.
    ///
    /// # Errors
    /// [`ValueError`] if the values are invalid. Then nothing changes, and nothing is staged.
    pub fn commit(&mut self) -> Result<(), ValueError> {
        let committed = self.knee().map_or(Ok(()), Knee::commit);
        self.examined();
        committed
    }

    /// Moves the hand towards an angle, or lets go of the leg.
    pub fn hand(&mut self, angle_rad: f32, holds: bool) {
        let Some(knee) = self.knee() else { return };
        if holds {
            knee.hold(f64::from(angle_rad));
        } else {
            knee.hand = None;
        }
    }

    /// Advances by so many ticks of 50 µs, at most [`MOST_TICKS`]. Returns the number of samples in the columns.
    pub fn advance(&mut self, ticks: u32) -> u32 {
        let Slot::Knee(knee) = &mut self.slot else {
            return 0;
        };
        for (at, _) in (0..ROOM).zip(0..ticks) {
            self.columns.put(at, &knee.tick());
        }
        self.examined();
        ticks.min(MOST_TICKS)
    }

    /// Samples of the last [`Self::advance`].
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Measures of the examination since the last [`Self::commit`], in the order of
    /// [`Measure::ALL`](crate::examination::Measure::ALL); NaN where there is none.
    pub fn measures(&self) -> &[f32; COUNT] {
        &self.measures
    }

    /// Findings of the examination since the last [`Self::commit`].
    pub fn findings(&self) -> &Findings {
        &self.findings
    }

    /// Steps of the examination that were done, a bit each in the order of [`Step::ALL`].
    pub fn steps(&self) -> u32 {
        let Slot::Knee(knee) = &self.slot else {
            return 0;
        };
        let done = (0..).zip(Step::ALL);
        done.filter(|(_, step)| knee.examination.has_done(*step))
            .fold(0, |steps, (bit, _)| steps | 1_u32.unbounded_shl(bit))
    }

    /// Ticks since [`Self::begin`] in which a stick broke; wraps.
    pub fn breaks(&self) -> u32 {
        match &self.slot {
            Slot::Empty => 0,
            Slot::Knee(knee) => knee.breaks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examination::Measure;
    use crepitus_protocol::parameters::{find, id};
    use std::boxed::Box;

    /// Place of the last sample of a millisecond.
    const LAST: usize = 19;

    fn page() -> Box<Page> {
        let mut page = Box::new(Page::new());
        page.begin().unwrap();
        page
    }

    fn set(page: &mut Page, name: &str, value: f64) {
        let (id, _) = find(name).unwrap();
        assert!(page.set(u32::from(id), value));
    }

    /// Bends the leg towards an angle for so many milliseconds.
    fn bend(page: &mut Page, deg: f32, ms: u32) {
        page.hand(deg.to_radians(), true);
        for _ in 0..ms {
            assert_eq!(page.advance(20), 20);
        }
    }

    #[test]
    fn nothing_happens_before_a_page_begins() {
        let mut page = Box::new(Page::new());
        page.hand(1.0, true);
        assert!(page.set(u32::from(id::CREPITUS), 1.0));
        assert_eq!(page.commit(), Ok(()));
        assert_eq!((page.advance(20), page.breaks()), (0, 0));
    }

    #[test]
    fn a_healthy_leg_follows_the_hand_without_resistance() {
        let mut page = page();
        bend(&mut page, 90.0, 1_500);
        let columns = page.columns();
        let angle_rad = columns.angle_rad[LAST];
        assert!((angle_rad.to_degrees() - 90.0).abs() < 0.1);
        assert!((columns.hand_rad[LAST] - angle_rad).abs() < 1e-3);
        assert!(columns.torque_nm.iter().all(|torque| *torque == 0.0));
        assert!(columns.phase.iter().all(|phase| *phase == 0));
        assert_eq!(page.breaks(), 0);
    }

    #[test]
    fn an_advance_has_room_for_a_tenth_of_a_second() {
        let mut page = page();
        assert_eq!(page.advance(0), 0);
        assert_eq!(page.advance(u32::MAX), 2048);
    }

    /// A second at 50 deg/s: a slip lasts 30 ms.
    #[test]
    fn crepitus_sticks_slips_and_loads_its_spring() {
        let mut page = page();
        set(&mut page, "crepitus.render", 1.0);
        assert_eq!(page.commit(), Ok(()));
        page.advance(200);
        let stiffness = f32::from_f64(Values::default().get(id::STIFFNESS).unwrap());
        let mut ticks = [0; 3];
        for step in 1_u8..=100 {
            bend(&mut page, 0.5 * f32::from(step), 10);
            let columns = page.columns();
            for at in 0..=LAST {
                ticks[columns.phase[at] as usize] += 1;
                let object_nm = stiffness * columns.object_rad[at];
                assert!((columns.spring_nm[at] - object_nm).abs() < 1e-5);
                if columns.phase[at] == 1 {
                    // In stick the spring is what resists.
                    let off_nm = columns.spring_nm[at] - columns.torque_nm[at];
                    assert!(off_nm.abs() < 1e-5, "{off_nm}");
                }
            }
        }
        assert!((15..40).contains(&page.breaks()), "{}", page.breaks());
        let [without, stick, slip] = ticks;
        assert!(without == 0 && stick > 20 && slip > 1_000, "{ticks:?}");
    }

    #[test]
    fn a_symptom_resists_the_hand_and_shows_its_state() {
        let mut page = page();
        set(&mut page, "lead-pipe.render", 1.0);
        assert_eq!(page.commit(), Ok(()));
        bend(&mut page, 60.0, 200);
        let columns = page.columns();
        assert!((columns.torque_nm[LAST] - 1.2).abs() < 1e-3);
        assert_ne!(columns.states[LAST], 0);
        assert!(columns.hand_rad[LAST] > columns.angle_rad[LAST]);
    }

    #[test]
    fn an_examination_measures_what_the_hand_does_and_begins_with_a_knee() {
        let measured = |page: &Page, measure: Measure| page.measures()[measure as usize];
        let mut page = page();
        assert!(measured(&page, Measure::Range).is_nan());
        // Slowly there and back, then fast.
        for deg in (1_u8..=60).chain((0..=59).rev()) {
            bend(&mut page, f32::from(deg), 25);
        }
        assert_eq!(page.steps(), 0);
        bend(&mut page, 90.0, 500);
        assert_eq!(page.steps(), 0b11, "slow and fast");
        let range_deg = measured(&page, Measure::Range);
        assert!((88.0..110.0).contains(&range_deg), "{range_deg}");
        let fastest_deg_s = measured(&page, Measure::PeakSpeed);
        assert!((150.0..328.0).contains(&fastest_deg_s), "{fastest_deg_s}");
        set(&mut page, "lead-pipe.render", 1.0);
        assert_eq!(page.commit(), Ok(()));
        page.advance(20);
        assert_eq!(page.steps(), 0);
        assert!(measured(&page, Measure::Range) < 1.0);
    }

    /// The catch at its defaults appears from 40 deg/s on.
    #[test]
    fn an_examination_finds_what_the_movements_lacked() {
        let outcome = |page: &Page| OUTCOMES[page.findings().outcomes[0] as usize];
        let mut page = page();
        assert_eq!(page.findings().count, 0);
        set(&mut page, "spasticity.render", 1.0);
        assert_eq!(page.commit(), Ok(()));
        assert_eq!((page.findings().count, outcome(&page)), (1, "not-moved"));
        // 20 deg/s.
        for step in 1_u8..=120 {
            bend(&mut page, 0.5 * f32::from(step), 25);
        }
        assert_eq!(outcome(&page), "too-slow");
        let (reached, needed) = (page.findings().reached[0], page.findings().needed[0]);
        assert!((15.0..35.0).contains(&reached), "{reached}");
        assert_eq!(needed, 40.0);
        bend(&mut page, 100.0, 600);
        assert_eq!(outcome(&page), "shown");
        assert!(page.findings().reached[0].is_nan());
        assert_eq!(page.commit(), Ok(()));
        assert_eq!(outcome(&page), "not-moved");
    }

    #[test]
    fn a_refused_commit_names_what_is_wrong_and_is_forgotten() {
        let mut page = page();
        assert!(!page.set(255, 1.0) && !page.set(256, 1.0));
        set(&mut page, "crepitus.stiffness_nm_per_rad", -1.0);
        let id = id::STIFFNESS;
        assert_eq!(page.commit(), Err(ValueError::OutOfRange { id }));
        assert_eq!(page.commit(), Ok(()));
        // A page is armed from its beginning.
        set(&mut page, "encoder.lines", 1_000.0);
        let id = id::LINES;
        assert_eq!(page.commit(), Err(ValueError::NeedsDisarmed { id }));
    }

    #[test]
    fn a_leg_that_is_let_go_falls_and_is_taken_where_it_is() {
        let mut page = page();
        page.hand(0.0, false);
        for _ in 0..200 {
            page.advance(20);
        }
        let falling_rad = page.columns().angle_rad[LAST];
        assert!(falling_rad > 0.2, "{falling_rad}");
        let off_rad = page.columns().hand_rad[LAST] - falling_rad;
        assert!(off_rad.abs() < 1e-4, "{off_rad}");
        // The hand begins where the leg is, as fast, and brings it to where it wants.
        let falling_rad_s = page.columns().speed_rad_s[LAST];
        page.hand(2.0, true);
        page.advance(2);
        let [first_rad, next_rad, ..] = page.columns().hand_rad;
        assert!((first_rad - falling_rad).abs() < 1e-3, "{first_rad}");
        let share = (next_rad - first_rad) / (5e-5 * falling_rad_s);
        assert!((share - 1.0).abs() < 0.2, "{share}");
        bend(&mut page, 20.0, 2_000);
        let angle_deg = page.columns().angle_rad[LAST].to_degrees();
        assert!((angle_deg - 20.0).abs() < 0.1, "{angle_deg}");
    }

    #[test]
    fn begun_again_a_page_is_as_at_first() {
        fn torques(page: &mut Page) -> [u32; ROOM] {
            set(page, "crepitus.render", 1.0);
            page.commit().unwrap();
            bend(page, 60.0, 100);
            page.advance(2_000);
            page.columns().torque_nm.map(f32::to_bits)
        }
        let mut page = page();
        let first = torques(&mut page);
        page.begin().unwrap();
        assert_eq!(torques(&mut page), first);
    }
}
