//! The limits of a symptom's torque over the knee's angle, from its settings, as lines
//! to be drawn: degrees and N·m.

use crate::plot::number::rounded;
use crate::plot::palette::{AXIS, ENCODER, Ink};
use crate::plot::{Mark, Point};
use crate::report::symptoms::occurrences::Met;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::play::Limits;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_scene::static_limits;
use crepitus_scene::trace::Word;

/// Inks of the limits: of the outer or only ones, and of the others.
const OUTER: Ink = AXIS;
const INNER: Ink = ENCODER;

/// Catches of which the limits are drawn: more would hide each other.
const CATCHES: usize = 6;

/// Points of a curved line.
const POINTS: u8 = 60;

/// A line.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) ink: Ink,
    pub(crate) name: &'static str,
    /// CSS pixels.
    pub(crate) width: f64,
    pub(crate) points: Vec<Point>,
}

/// Drawn limits of a symptom.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drawn {
    pub(crate) lines: Vec<Line>,
    /// Angles that decide something, deg.
    pub(crate) marks: Vec<Mark>,
    /// Angles that a chart should show besides, deg.
    pub(crate) also_deg: Vec<f64>,
}

/// Limits of the symptom with this name, over these angles, deg, with the catches that
/// there were; nothing if its settings are not known.
pub(crate) fn of(settings: &EffectSettings, effect: &str, ends: (f64, f64), met: &[Met]) -> Drawn {
    let mut drawn = Drawn::default();
    let d = &mut drawn;
    match effect {
        "range-limit" => settings.range_limit.iter().for_each(|s| range_limit(d, s)),
        "lead-pipe" => settings
            .lead_pipe
            .iter()
            .for_each(|s| lead_pipe(d, s, ends)),
        "cogwheel" => settings.cogwheel.iter().for_each(|s| cogwheel(d, s, ends)),
        "spasticity" => {
            if let Some(s) = &settings.spasticity {
                spasticity(d, s, ends, met);
            }
        }
        "clasp-knife" => {
            if let Some(s) = &settings.clasp_knife {
                clasp_knife(d, s, ends, met);
            }
        }
        "clonus" => settings.clonus.iter().for_each(|s| clonus(d, s, ends)),
        "texture" => settings.texture.iter().for_each(|s| texture(d, s, ends)),
        _ => {}
    }
    drawn
}

impl Drawn {
    fn line(&mut self, ink: Ink, name: &'static str, points: Vec<Point>) {
        // A line of the path covers neither.
        let width = if ink == OUTER { 5.5 } else { 4.5 };
        self.lines.push(Line {
            ink,
            name,
            width,
            points,
        });
    }

    /// A curve from angle to angle, deg, of a torque by angle, rad.
    fn curve(
        &mut self,
        ink: Ink,
        name: &'static str,
        (from, to): (f64, f64),
        nm: impl Fn(f64) -> f64,
    ) {
        let share = |i| f64::from(i) / f64::from(POINTS);
        let points = (0..=POINTS).map(|i| {
            let deg = from + share(i) * (to - from);
            Point::new(deg, nm(deg.to_radians()))
        });
        self.line(ink, name, points.collect());
    }

    fn band(
        &mut self,
        ink: Ink,
        name: &'static str,
        ends: (f64, f64),
        limits: impl Fn(f64) -> Limits<f64>,
    ) {
        self.curve(ink, name, ends, |rad| limits(rad).upper_nm);
        self.curve(ink, name, ends, |rad| limits(rad).lower_nm);
    }

    fn mark(&mut self, deg: f64, name: &str) {
        self.marks.push(Mark {
            at: deg,
            name: format!("{name} {}°", rounded(deg)),
        });
    }
}

fn range_limit(drawn: &mut Drawn, s: &RangeLimitSettings) {
    const NAME: &str = "limit of the end-feel";
    for (deg, end, along, name) in [
        (
            s.extension_limit_deg,
            s.extension(),
            -1.0,
            "extension ends at",
        ),
        (s.flexion_limit_deg, s.flexion(), 1.0, "flexion ends at"),
    ] {
        // As far as the cap, and as far again.
        let beyond_deg = (2.0 * end.cap_rad().to_degrees()).max(2.0);
        let far_deg = deg + along * beyond_deg;
        drawn.curve(OUTER, NAME, (deg, far_deg), |rad| {
            let limits = static_limits::range_limit::limits_at(s, rad);
            limits.lower_nm + limits.upper_nm
        });
        drawn.mark(deg, name);
        drawn.also_deg.push(far_deg);
    }
}

fn lead_pipe(drawn: &mut Drawn, s: &LeadPipeSettings, ends: (f64, f64)) {
    drawn.band(OUTER, "limits of the rigidity", ends, |rad| {
        static_limits::lead_pipe::limits_at(s, rad)
    });
}

fn cogwheel(drawn: &mut Drawn, s: &CogwheelSettings, ends: (f64, f64)) {
    drawn.band(OUTER, "limits at a tooth", ends, |rad| {
        static_limits::cogwheel::limits_at(s, rad, true)
    });
    drawn.band(INNER, "limits between teeth", ends, |rad| {
        static_limits::cogwheel::limits_at(s, rad, false)
    });
}

/// Range from an angle, deg, to the end of the chart in the sense of the stretch.
fn onwards(deg: f64, sense: f64, (low, high): (f64, f64)) -> (f64, f64) {
    (
        deg,
        if sense > 0.0 {
            high.max(deg)
        } else {
            low.min(deg)
        },
    )
}

fn spasticity(drawn: &mut Drawn, s: &SpasticitySettings, ends: (f64, f64), met: &[Met]) {
    let threshold_deg = static_limits::spasticity::threshold_rad(s, 0.0).to_degrees();
    drawn.mark(threshold_deg, "threshold of a slow stretch:");
    let sense = static_limits::spasticity::sense(s);
    if !s.catches() {
        let slow = onwards(threshold_deg, sense, ends);
        drawn.curve(OUTER, "a very slow stretch", slow, |rad| {
            static_limits::spasticity::reflex_nm(s, rad, 0.0)
        });
    }
    for Met { event, .. } in met.iter().take(CATCHES) {
        let (caught_rad, rad_s) = (event.angle_rad, event.omega_rad_s);
        let from_deg = caught_rad.to_degrees();
        let after = onwards(from_deg, sense, ends);
        if s.catches() {
            let height_nm = sense * static_limits::spasticity::catch_nm(s, rad_s);
            let height = [0.0, height_nm];
            let height = height.map(|nm| Point::new(from_deg, nm)).to_vec();
            drawn.line(OUTER, "height of a catch at its speed", height);
            drawn.curve(INNER, "what is left after its release", after, |rad| {
                static_limits::spasticity::left_nm(s, caught_rad, rad_s, rad)
            });
        } else {
            drawn.curve(
                INNER,
                "at the speed of the stretch, without its delay",
                after,
                |rad| static_limits::spasticity::reflex_nm(s, rad, rad_s),
            );
        }
    }
}

fn clasp_knife(drawn: &mut Drawn, s: &ClaspKnifeSettings, ends: (f64, f64), met: &[Met]) {
    let released = met.iter().map(|met| met.event);
    let released = released.filter(|event| event.word == Word::Release);
    let released_rad = released.map(|event| event.angle_rad).next();
    let sense = static_limits::clasp_knife::sense(s);
    let release_rad = static_limits::clasp_knife::release_rad(s);
    let end_deg = match release_rad.or(released_rad) {
        Some(rad) => rad.to_degrees(),
        None => onwards(s.onset_deg, sense, ends).1,
    };
    drawn.curve(OUTER, "builds up along", (s.onset_deg, end_deg), |rad| {
        static_limits::clasp_knife::building_nm(s, rad)
    });
    drawn.mark(s.onset_deg, "resistance begins at");
    if let Some(rad) = release_rad {
        drawn.mark(rad.to_degrees(), "collapses at");
    }
    if let Some(rad) = released_rad {
        let left_nm = static_limits::clasp_knife::left_nm(s, rad);
        drawn.curve(INNER, "what the collapse leaves", ends, |_| left_nm);
    }
}

fn clonus(drawn: &mut Drawn, s: &ClonusSettings, ends: (f64, f64)) {
    let beat_nm = static_limits::clonus::beat_nm(s);
    drawn.curve(OUTER, "height of a beat", ends, |_| beat_nm);
    drawn.mark(s.hold_deg, "held beyond");
}

fn texture(drawn: &mut Drawn, s: &TextureSettings, ends: (f64, f64)) {
    let (all, there) = s.patches();
    drawn.band(OUTER, "limits at an asperity", ends, |rad| {
        #[expect(clippy::cast_possible_truncation, reason = "an angle of a knee")]
        let number = (rad.to_degrees() / s.pitch_deg).round() as i32;
        Limits::both(if number.rem_euclid(all) < there {
            s.peak_nm
        } else {
            s.base_nm
        })
    });
    drawn.band(INNER, "limits between asperities", ends, |_| {
        Limits::both(s.base_nm)
    });
}
