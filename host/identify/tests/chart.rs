//! The figure shows what was measured and what was fitted.

mod support;

use crepitus_identify::actuator::{MassEvidence, Weighed, chart, identify};
use crepitus_model::control::chirp::ChirpSettings;
use crepitus_pages::plot::pictures;
use support::{NOMINAL, band};

#[test]
fn the_figure_has_three_panels_over_the_band() {
    let chirp = ChirpSettings::default();
    let series = NOMINAL.played(&chirp, &mut fastrand::Rng::with_seed(1));
    let mass = Weighed {
        mass_kg: 0.06,
        share: 0.01,
    };
    let found = identify(&series, band(&chirp), &MassEvidence::Weighed(mass)).unwrap();
    let figure = chart::figure(&found);
    let pictures = pictures([&figure]);
    let svg = &pictures[0].svg;
    for title in ["|Z| (Ω)", "Phase (°)", "Residual (%)", "Frequency (Hz)"] {
        assert!(svg.contains(title), "{title}");
    }
    // Measured and fitted twice, the residual, and no number that is none.
    assert!(svg.matches("<path").count() + svg.matches("<polyline").count() >= 5);
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert!(figure.caption.contains("35"), "{}", figure.caption);
}
