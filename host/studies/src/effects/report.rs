//! The report of the study of effects: what each effect of a scene does to the
//! torque at the hand, against what it costs.
//!
//! ```text
//! EffectsStudy ─┬─> table ──────────────────────────────┐
//!               ├─> influence against cost ─┐           ├─> page
//!               ├─> bands, a row a variant ─┼─> pictures┤
//!               ├─> story: the torque ──────┘           │
//!               └─> the smallest set ───────────────────┘
//! ```

mod bands;
mod influence;
mod look;
mod page;
mod smallest;
mod spots;
mod table;

use crate::effects::EffectsStudy;
use crepitus_pages::plot::{Figure, Paper, pictures as of_figures};

use crate::{Picture, StudyText, story};

/// The report as one HTML page, complete in itself.
pub fn html(study: &EffectsStudy, text: &StudyText) -> String {
    page::html(study, text)
}

/// Every figure as a file of its own.
pub fn pictures(study: &EffectsStudy, paper: Paper) -> Vec<Picture> {
    of_figures(&figures(study, paper))
}

fn figures(study: &EffectsStudy, paper: Paper) -> Vec<Figure> {
    let felt = study.hand_torque.as_ref().map(story::hand_torque::story);
    let stories = felt
        .into_iter()
        .chain(story::build_up::story(&study.build_up_torques));
    // What is felt first.
    let charts = bands::figure(study)
        .into_iter()
        .chain(influence::figure(study, paper));
    charts
        .chain(stories.map(|story| story::figure(&story, paper)))
        .collect()
}
