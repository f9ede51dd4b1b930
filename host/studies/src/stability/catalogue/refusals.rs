//! Steps and parameters that must be refused.

use super::tools::{CASE, TICK_S};
use crate::stability::case::Case;
use crate::stability::criteria::refused;
use crate::stability::input::{Input, What};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H20",
        name: "bad-steps",
        title: "Steps of zero length, of negative length, of NaN",
        hard: "A step of zero divides by zero, a negative one runs time backwards, and NaN passes every comparison \
               that is written the wrong way round. In a step of 1000 s a joint of the paper makes 31,831 cycles.",
        source: "the documented errors of StepCoefficients and of a step",
        trials: |_| {
            let attempts = [
                ("a step of 0 s", 0.0),
                ("a step of −0 s", -0.0),
                ("a step of −50 µs", -TICK_S),
                ("a step of 1000 s", 1e3),
                ("a step without end", f64::INFINITY),
                ("a step of NaN s", f64::NAN),
            ]
            .map(|(what, step_s)| (what, Parameters::default(), step_s));
            vec![Input::still(What::Refusals(attempts.into())).meets([refused()])]
        },
        ..CASE
    },
    Case {
        id: "H22",
        name: "bad-parameters",
        title: "Invalid parameters",
        hard: "A spring or an inertia of zero divides by zero, Tk above Ts turns the drop into a push, negative \
               damping feeds the swing, and NaN slips through a check that asks whether a value is too large.",
        source: "the documented errors of Settings",
        trials: |_| {
            let (nan, infinite) = (f64::NAN, f64::INFINITY);
            let attempts = [
                ("kr = 0", [0.01, 0.0, 0.0, 0.2, 0.4]),
                ("kr = −400", [0.01, -400.0, 0.0, 0.2, 0.4]),
                ("kr = NaN", [0.01, nan, 0.0, 0.2, 0.4]),
                ("kr = ∞", [0.01, infinite, 0.0, 0.2, 0.4]),
                ("J = 0", [0.0, 400.0, 0.0, 0.2, 0.4]),
                ("J = −0.01", [-0.01, 400.0, 0.0, 0.2, 0.4]),
                ("J = NaN", [nan, 400.0, 0.0, 0.2, 0.4]),
                ("c = −0.1", [0.01, 400.0, -0.1, 0.2, 0.4]),
                ("c = NaN", [0.01, 400.0, nan, 0.2, 0.4]),
                ("Tk = −0.1", [0.01, 400.0, 0.0, -0.1, 0.4]),
                ("Tk = NaN", [0.01, 400.0, 0.0, nan, 0.4]),
                ("Ts below Tk", [0.01, 400.0, 0.0, 0.2, 0.19]),
                ("Ts = NaN", [0.01, 400.0, 0.0, 0.2, nan]),
                ("Ts = ∞", [0.01, 400.0, 0.0, 0.2, infinite]),
            ]
            .map(|(what, values)| (what, Parameters::of(values), TICK_S));
            vec![Input::still(What::Refusals(attempts.into())).meets([refused()])]
        },
        ..CASE
    },
];
