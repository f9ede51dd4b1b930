//! Pain at an empty end of the range: nothing resists there, so the patient says where the movement ends.

use super::{Bin, Marks, STATES};
use crepitus_model::render::effects::EffectSettings;
use crepitus_protocol::Values;

/// Effect whose states say that the leg is beyond an end.
const RANGE_LIMIT: &str = "range-limit";

/// The ends of a knee that hurt: those whose torque is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pain {
    /// The [states](STATES) beyond an end; none where no end hurts.
    states: u32,
    /// Angle between both ends, rad.
    middle_rad: f32,
    hurts_in_extension: bool,
    hurts_in_flexion: bool,
}

impl Pain {
    /// The pain of a device with these parameters.
    pub fn of(values: &Values) -> Self {
        let Some(ends) = EffectSettings::read(values).range_limit else {
            return Self::default();
        };
        let states = (0_u32..).zip(&STATES);
        let of_ends = states.filter(|(_, state)| state.effect == RANGE_LIMIT);
        let middle_deg = f64::midpoint(ends.extension_limit_deg, ends.flexion_limit_deg);
        #[expect(clippy::cast_possible_truncation, reason = "a drawn angle")]
        let middle_rad = middle_deg.to_radians() as f32;
        Self {
            states: of_ends.fold(0, |states, (bit, _)| states | 1_u32 << bit),
            middle_rad,
            hurts_in_extension: ends.extension_torque_nm == 0.0,
            hurts_in_flexion: ends.flexion_torque_nm == 0.0,
        }
    }

    /// Returns whether the leg was moved into pain in the time of this bin. Without the motor there is no patient.
    pub fn is_felt(&self, bin: &Bin) -> bool {
        let is_beyond = bin.states & self.states != 0 && bin.marks.0 & Marks::ENERGISED != 0;
        let angle = bin.angle_rad;
        is_beyond
            && (self.hurts_in_flexion && angle.high > self.middle_rad
                || self.hurts_in_extension && angle.low < self.middle_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::Phases;
    use crepitus_plant::Extremes;
    use crepitus_protocol::parameters::find;
    use crepitus_scene::preset;
    use crepitus_scene::values::with_preset;

    fn knee(name: &str) -> Values {
        with_preset(&Values::default(), preset::find(name).unwrap(), false)
    }

    /// A bin at an angle, in this phase of the end of the range.
    fn bin(angle_deg: f32, phase: &str) -> Bin {
        let phases = Phases::default().with_named(RANGE_LIMIT, phase);
        let mut angle_rad = Extremes::default();
        angle_rad.add(angle_deg.to_radians());
        Bin {
            angle_rad,
            states: phases.unwrap().states(),
            marks: Marks(Marks::ENERGISED),
            ..Bin::default()
        }
    }

    #[test]
    fn an_empty_end_hurts_beyond_it_while_the_motor_is_on() {
        let pain = Pain::of(&knee("end-feel-empty"));
        for phase in ["in-the-wall", "at-its-cap"] {
            assert!(pain.is_felt(&bin(110.0, phase)), "{phase}");
            assert!(pain.is_felt(&bin(5.0, phase)), "{phase}");
        }
        assert!(!pain.is_felt(&bin(60.0, "free")));
        let off = Bin {
            marks: Marks::default(),
            ..bin(110.0, "at-its-cap")
        };
        assert!(!pain.is_felt(&off));
        assert!(!pain.is_felt(&Bin::gap()));
    }

    #[test]
    fn an_end_that_resists_does_not_hurt() {
        for name in ["end-feel-firm", "coarse", "texture-bone-on-bone"] {
            let pain = Pain::of(&knee(name));
            assert!(!pain.is_felt(&bin(140.0, "at-its-cap")), "{name}");
        }
        // Firm in extension, empty in flexion.
        let mut values = knee("end-feel-firm");
        values.set(find("range-limit.flexion_torque_nm").unwrap().0, 0.0);
        let pain = Pain::of(&values);
        assert!(pain.is_felt(&bin(110.0, "at-its-cap")));
        assert!(!pain.is_felt(&bin(5.0, "in-the-wall")));
    }
}
