//! Notes that an examiner would make on a symptom: where it was met, how fast, how strong,
//! how often.

use crate::report::symptoms::loops::Loops;
use crate::report::symptoms::movement::Movement;
use crepitus_scene::trace::{SymptomEvent, Word};

/// A catch, a reflex, a collapse, or the end of the range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub(crate) event: SymptomEvent,
    /// The largest torque since, as a magnitude, N·m: of a catch until it releases.
    pub(crate) most_nm: f64,
    /// Distance that the joint went on from there until it had that torque, rad.
    pub(crate) within_rad: f64,
    /// Distance that it went on in all, rad.
    pub(crate) beyond_rad: f64,
    /// Time from a collapse until it had left a fifth of the torque before it, s.
    pub(crate) fifth_s: Option<f64>,
    /// The torque at `within_rad`, N·m.
    within_nm: f64,
    is_open: bool,
}

/// Clonus from one stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bout {
    pub(crate) start: SymptomEvent,
    pub(crate) beats: u32,
    /// Beats of which at least half the height was there.
    pub(crate) felt: u32,
    /// Time at which the last of those began, s.
    pub(crate) last_s: f64,
    /// Event that ended it, and its time, s.
    pub(crate) end: Option<(Word, f64)>,
}

/// A beat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beat {
    pub(crate) time_s: f64,
    /// Number of the beat in its bout; the first is 0.
    pub(crate) number: u32,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct Occurrences {
    pub(crate) met: Vec<Met>,
    pub(crate) bouts: Vec<Bout>,
    /// Whether a beat shows: not in the torque of several effects together.
    pub(crate) beats_are_counted: bool,
    pub(crate) beats: Vec<Beat>,
    /// The least torque of a beat that is felt, N·m.
    felt_nm: f64,
    /// Time at which the last beat began, while it has less than that, s.
    faint_s: Option<f64>,
    pub(crate) movement: Movement,
    pub(crate) loops: Loops,
    /// The largest torque in either sense, N·m, and the angle there, rad.
    pub(crate) most: (f64, f64),
    /// Events that are counted but not kept.
    pub(crate) left_out: u64,
}

/// Torques that are one for an examiner, N·m.
const SAME_NM: f64 = 0.005;

/// A catch has released when so much of its torque is left.
const RELEASED: f64 = 0.9;

impl Occurrences {
    /// Begins with nothing found; a beat of this height counts as felt.
    pub(crate) fn new(beats_are_counted: bool, felt_nm: f64) -> Self {
        Self {
            beats_are_counted,
            felt_nm,
            ..Self::default()
        }
    }

    /// Most of each kind that is kept.
    pub(crate) const MOST: usize = 1000;

    /// Rows are missing before the next one.
    pub(crate) fn gap(&mut self) {
        self.loops.gap();
        self.movement.gap();
        if let Some(met) = self.met.last_mut() {
            met.is_open = false;
        }
    }

    pub(crate) fn row(&mut self, time_s: f64, angle_rad: f64, nm: f64) {
        self.loops.push(angle_rad, nm);
        self.movement.row(time_s, angle_rad);
        if nm.abs() > self.most.0.abs() {
            self.most = (nm, angle_rad);
        }
        if let Some(met) = self.met.last_mut() {
            met.row(time_s, angle_rad, nm);
        }
        if nm.abs() >= self.felt_nm
            && nm != 0.0
            && let Some(began_s) = self.faint_s.take()
            && let Some(bout) = self.bouts.last_mut()
        {
            bout.felt += 1;
            bout.last_s = began_s;
        }
    }

    pub(crate) fn event(&mut self, event: &SymptomEvent) {
        match (event.effect, event.word) {
            (_, Word::Contact | Word::Onset | Word::Release) | ("spasticity", Word::Catch) => {
                self.meet(event);
            }
            (_, Word::Leave | Word::Rearm | Word::Offset | Word::Back) => {
                if let Some(met) = self.met.last_mut() {
                    met.is_open = false;
                }
            }
            (_, Word::Start) => self.start(event),
            (_, Word::Beat) => self.beat(event),
            (_, word @ (Word::Stop | Word::Done)) => {
                if let Some(bout) = self.bouts.last_mut() {
                    bout.end = bout.end.or(Some((word, event.time_s)));
                }
            }
            (_, word @ (Word::Snap | Word::Give)) => self.movement.count(word),
            (_, Word::Cap) => {
                if let Some(met) = self.met.last_mut() {
                    met.row(event.time_s, event.angle_rad, event.torque_after_nm);
                }
            }
            _ => {}
        }
    }

    fn meet(&mut self, event: &SymptomEvent) {
        // A collapse takes the place of the onset before it.
        if event.word == Word::Release
            && let Some(Word::Onset) = self.met.last().map(|met| met.event.word)
        {
            self.met.pop();
        }
        if self.met.len() == Self::MOST {
            self.left_out += 1;
            return;
        }
        let nm = event.torque_before_nm.abs();
        self.met.push(Met {
            event: *event,
            most_nm: nm,
            within_rad: 0.0,
            beyond_rad: 0.0,
            fifth_s: None,
            within_nm: nm,
            is_open: true,
        });
    }

    fn start(&mut self, event: &SymptomEvent) {
        if self.bouts.len() == Self::MOST {
            self.left_out += 1;
            return;
        }
        self.bouts.push(Bout {
            start: *event,
            beats: 0,
            felt: 0,
            last_s: event.time_s,
            end: None,
        });
    }

    fn beat(&mut self, event: &SymptomEvent) {
        let Some(bout) = self.bouts.last_mut() else {
            return;
        };
        if self.beats.len() < Self::MOST {
            self.beats.push(Beat {
                time_s: event.time_s,
                number: bout.beats,
            });
        } else {
            self.left_out += 1;
        }
        bout.beats += 1;
        self.faint_s = Some(event.time_s);
    }

    /// Catches and onsets of a reflex.
    pub(crate) fn caught(&self) -> impl Iterator<Item = &Met> {
        let is_catch = |met: &&Met| matches!(met.event.word, Word::Catch | Word::Onset);
        self.met.iter().filter(is_catch)
    }
}

impl Met {
    fn row(&mut self, time_s: f64, angle_rad: f64, nm: f64) {
        if !self.is_open {
            return;
        }
        let event = self.event;
        let nm = nm.abs();
        let beyond_rad = (angle_rad - event.angle_rad).abs();
        match event.word {
            Word::Release => {
                if self.fifth_s.is_none() && nm <= 0.2 * event.torque_before_nm.abs() {
                    self.fifth_s = Some(time_s - event.time_s);
                }
            }
            Word::Catch if self.most_nm > 0.0 && nm < RELEASED * self.most_nm => {
                self.is_open = false;
            }
            _ => {
                self.most_nm = self.most_nm.max(nm);
                if nm > self.within_nm + SAME_NM {
                    (self.within_nm, self.within_rad) = (nm, beyond_rad);
                }
            }
        }
        self.beyond_rad = self.beyond_rad.max(beyond_rad);
    }
}
