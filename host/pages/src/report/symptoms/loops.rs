//! The work that a symptom takes, from turn to turn: the area of its loop of torque
//! over angle.

/// Angle by which the joint goes back before it has turned, rad: one degree.
const TURNED_RAD: f64 = std::f64::consts::PI / 180.0;

/// Angle at which the joint turned, and the work until then.
#[derive(Clone, Copy, Debug)]
struct Turn {
    angle_rad: f64,
    work_j: f64,
}

/// One movement to and fro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Loop {
    /// Work that the hand did not get back, J.
    pub(crate) area_j: f64,
    /// The angles between which it was, rad.
    pub(crate) from_rad: f64,
    pub(crate) to_rad: f64,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loops {
    last: Option<(f64, f64)>,
    work_j: f64,
    /// Farthest point that the joint has reached since it turned.
    extreme: Option<Turn>,
    is_flexing: Option<bool>,
    /// The last two turns, the latest first.
    turns: [Option<Turn>; 2],
    latest: Option<Loop>,
}

impl Loops {
    /// Rows are missing: what was before is of no loop.
    pub(crate) fn gap(&mut self) {
        *self = Self {
            latest: self.latest,
            ..Self::default()
        };
    }

    pub(crate) fn push(&mut self, angle_rad: f64, nm: f64) {
        if let Some((last_rad, last_nm)) = self.last {
            self.work_j += 0.5 * (nm + last_nm) * (angle_rad - last_rad);
        }
        self.last = Some((angle_rad, nm));
        let here = Turn {
            angle_rad,
            work_j: self.work_j,
        };
        let Some(extreme) = self.extreme else {
            self.extreme = Some(here);
            return;
        };
        let beyond_rad = angle_rad - extreme.angle_rad;
        match self.is_flexing {
            None if beyond_rad.abs() > TURNED_RAD => {
                self.is_flexing = Some(beyond_rad > 0.0);
                self.extreme = Some(here);
            }
            None => {}
            Some(is_flexing) => {
                let further_rad = if is_flexing { beyond_rad } else { -beyond_rad };
                if further_rad >= 0.0 {
                    self.extreme = Some(here);
                } else if further_rad < -TURNED_RAD {
                    self.turned(extreme);
                    self.is_flexing = Some(!is_flexing);
                    self.extreme = Some(here);
                }
            }
        }
    }

    fn turned(&mut self, at: Turn) {
        let [latest, before] = self.turns;
        if let (Some(other), Some(first)) = (latest, before)
            && (first.angle_rad - at.angle_rad).abs() < TURNED_RAD
        {
            self.latest = Some(Loop {
                area_j: at.work_j - first.work_j,
                from_rad: other.angle_rad.min(at.angle_rad),
                to_rad: other.angle_rad.max(at.angle_rad),
            });
        }
        self.turns = [Some(at), latest];
    }

    /// The last complete one.
    pub(crate) fn latest(&self) -> Option<Loop> {
        self.latest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_lead_pipe_is_that_of_its_closed_form() {
        let (torque_nm, presliding_rad) = (1.2, 1.5_f64.to_radians());
        let amplitude_rad = 30_f64.to_radians();
        let (mut loops, mut play_rad) = (Loops::default(), 0.0);
        for i in 0..=30_000_u32 {
            let angle_rad = amplitude_rad * (f64::from(i) * 1e-3).sin();
            play_rad = f64::clamp(
                play_rad,
                angle_rad - presliding_rad,
                angle_rad + presliding_rad,
            );
            loops.push(
                angle_rad,
                torque_nm * (angle_rad - play_rad) / presliding_rad,
            );
        }
        let found = loops.latest().expect("turned often enough");
        let expected_j = 4.0 * torque_nm * (amplitude_rad - presliding_rad);
        assert!((found.area_j - expected_j).abs() < 1e-4, "{found:?}");
        assert!((expected_j - 2.3876).abs() < 1e-4);
        assert!((found.to_rad - amplitude_rad).abs() < 1e-6);
        assert!((found.from_rad + amplitude_rad).abs() < 1e-6);
        loops.gap();
        loops.push(0.0, 1.0);
        assert_eq!(loops.latest(), Some(found));
    }

    #[test]
    fn a_tremble_is_no_loop() {
        let mut loops = Loops::default();
        for i in 0..10_000_u32 {
            loops.push(0.008 * f64::from(i).sin(), 1.0);
        }
        assert_eq!(loops.latest(), None);
    }
}
