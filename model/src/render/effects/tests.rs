use super::friction_compensation::{FrictionCompensation, FrictionCompensationSettings};
use super::*;
use crate::ShaftStep;
use crate::parameters::Kind;

pub(crate) const TIMING: Timing = Timing {
    step_s: 5e-5,
    delay_ticks: 1,
    sensing: Sensing::IDEAL,
};

pub(crate) fn seen(omega_rad_s: f32) -> ShaftEstimate<f32> {
    let shaft = ShaftStep {
        delta_phi_rad: 0.0,
        omega_start_rad_s: omega_rad_s,
        omega_end_rad_s: omega_rad_s,
    };
    ShaftEstimate::taken(&shaft, Position::at(0))
}

/// One without a sample.
pub(crate) fn missing(seen: &ShaftEstimate<f32>) -> Tick<'static, f32> {
    Tick::of(seen, &Checked::Missing(1), None, 1.0)
}

/// A law at these settings.
pub(crate) fn law<F: Real, E: DeviceEffect<F>>(settings: &E::Settings) -> E {
    E::new(E::coefficients(settings, &TIMING).unwrap())
}

#[test]
fn a_tick_that_no_device_has_has_no_scale() {
    let scale = |step_s| Timing { step_s, ..TIMING }.scale::<f64>();
    for step_s in [f64::MIN_POSITIVE, 5e-5, LONGEST_STEP_S] {
        assert!(scale(step_s).is_ok(), "{step_s}");
    }
    for step_s in [0.0, -5e-5, 1.01 * LONGEST_STEP_S, f64::NAN] {
        let error = scale(step_s).map(|_| ()).unwrap_err();
        assert!(matches!(error, SettingsError::Step { .. }), "{step_s}");
    }
}

/// Returns the contribution of an effect to 1 N·m in a tick, and what is shown then.
pub(crate) fn after<E>(
    stage: &mut impl Adds<f32, E>,
    omega_rad_s: f32,
    jump_nm: f32,
) -> (f32, Shown<f32>)
where
    E: DeviceEffect<f32>,
{
    let mut shown = Shown {
        torque_nm: 1.0,
        jump_nm,
        ..Shown::nothing()
    };
    let added_nm = stage.tick(&missing(&seen(omega_rad_s)), &mut shown, &mut ());
    (added_nm, shown)
}

#[test]
fn a_sample_that_is_refused_moves_nothing() {
    let shaft = ShaftStep {
        delta_phi_rad: 1e3,
        ..ShaftStep::default()
    };
    let seen = ShaftEstimate::taken(&shaft, Position::at(0));
    let travel_rad = |input| Tick::of(&seen, &input, None, 1.0).travel_rad;
    assert_eq!(travel_rad(Checked::Missing(1)), 0.0);
    assert_eq!(travel_rad(Checked::Step(shaft)), 1e3);
}

/// A symptom of 0.5 N·m that is always in its third phase.
struct Constant;

impl DeviceEffect<f32> for Constant {
    type Settings = FrictionCompensationSettings;
    type Coefficients = ();
    type Switched = Faded<f32, Self>;

    // As a symptom of the table, as there is no room for phases of another one.
    const SPEC: EffectSpec = SPECS[0];
    const IS_SYMPTOM: bool = true;

    fn coefficients(_: &Self::Settings, _: &Timing) -> Result<(), SettingsError> {
        Ok(())
    }

    fn new((): ()) -> Self {
        Self
    }

    fn added(&mut self, _: &Tick<'_, f32>, _: &mut Shown<f32>, _: &mut impl Observe<f32>) -> f32 {
        0.5
    }

    fn phase(&self) -> u16 {
        2
    }
}

#[test]
fn a_symptom_is_in_the_models_torque_and_its_phase_is_shown() {
    let mut stage = Faded::<f32, Constant>::new(0.1);
    assert!(stage.law().is_none());
    stage.change(&Some(Some(())), 0.1);
    let (added_nm, mut shown) = after(&mut stage, 0.0, 0.0);
    assert_eq!((shown.torque_nm, shown.model_torque_nm), (1.5, 0.0));
    note(stage.law(), added_nm, &mut shown);
    assert_eq!(shown.model_torque_nm, 0.5);
    let place = Constant::SPEC.place();
    assert_eq!(shown.phases, Phases::default().with(place, 2));
    assert_ne!(shown.phases, Phases::default());
    // One that is off has no phase, and what is no symptom is not the model's.
    let mut shown = Shown::nothing();
    note::<f32, Constant>(None, 0.0, &mut shown);
    assert_eq!(shown, Shown::nothing());
    let law: FrictionCompensation<f32> = law(&FrictionCompensationSettings::defaults());
    note(Some(&law), 0.3, &mut shown);
    assert_eq!(shown, Shown::nothing());
    assert_eq!(DeviceEffect::<f32>::phase(&law), 0);
}

#[test]
fn a_line_of_the_table_is_in_everything_that_follows_from_it() {
    let numbers: std::vec::Vec<f64> = FrictionCompensationSettings::defaults().values().into();
    let settings = EffectSettings::given(|name| {
        (name == "friction-compensation").then_some(Chosen {
            numbers: &numbers,
            options: &[],
        })
    });
    assert_eq!(settings.friction_compensation, Some(Tabled::defaults()));
    assert_eq!(settings.bone_shaping, None);
    assert_eq!(SPECS.len(), DEVICE.len());
    for (spec, device) in SPECS.iter().zip(DEVICE) {
        assert!(device.iter().all(|parameter| parameter.group == spec.name));
    }
    let mut laws = settings.laws::<f32>(&TIMING).unwrap();
    let mut shown = Shown::nothing();
    laws.tick(&seen(1.0), &Checked::Missing(1), &mut shown, &mut ());
    assert_eq!(shown.torque_nm, -0.4);
    assert_eq!(shown.model_torque_nm, 0.0);
    let place = |column| SPECS.iter().position(|spec| spec.column == column);
    for (column, nm) in [("compensation_nm", -0.4), ("shaping_nm", 0.0)] {
        assert_eq!(shown.added.get(place(column).unwrap()), Some(nm));
    }
    assert_eq!(shown.added.get(SPECS.len()), None);
    // Nothing changes, or only what is another.
    let changes = settings.changes_from_none(&TIMING).unwrap();
    let unchanged = settings.changes(&TIMING, (&settings, &TIMING)).unwrap();
    let mut stages = SwitchedEffects::<f32>::new(1.0, &TIMING);
    stages.change(&changes, 1.0);
    stages.change(&unchanged, 1.0);
    let mut switched = Shown::nothing();
    stages.tick(&seen(1.0), &Checked::Missing(1), &mut switched, &mut ());
    assert_eq!(switched, shown);
}

#[test]
fn a_parameter_has_the_default_of_what_it_describes() {
    for parameter in DEVICE.iter().copied().flatten() {
        let default = match parameter.kind {
            Kind::Number(spec) => spec.default,
            Kind::Choice(choice) => f64::from(choice.default),
        };
        assert_eq!(parameter.default().to_bits(), default.to_bits());
    }
    let switches = DEVICE.iter().map(|device| switch(device));
    let mut ids: std::vec::Vec<_> = switches.collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert!(
        ids.len() == count && count > 1,
        "each effect has its own switch"
    );
}

#[test]
fn a_parameter_allows_its_range_or_its_choices_only() {
    for parameter in DEVICE.iter().copied().flatten() {
        let (good, bad) = match parameter.kind {
            Kind::Number(spec) => {
                let beyond = 1e-9 + 0.01 * (spec.max - spec.min);
                ([spec.min, spec.max], [spec.min - beyond, spec.max + beyond])
            }
            Kind::Choice(choice) => {
                let last = f64::from(u8::try_from(choice.names.len()).unwrap()) - 1.0;
                ([0.0, last], [-1.0, last + 1.0])
            }
        };
        for value in good {
            assert!(parameter.allows(value), "{parameter:?} {value}");
        }
        for value in bad.into_iter().chain([f64::NAN]) {
            assert!(!parameter.allows(value), "{parameter:?} {value}");
        }
    }
}
