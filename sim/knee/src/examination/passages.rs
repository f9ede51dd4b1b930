//! First passages of a stroke: when it first came to every half degree of its way.
//!
//! ```text
//!  way │             ╭─────   t₄
//!      │      ╭─╮  ╭─╯        t₃    where the leg turns back a little, nothing is passed
//!      │   ╭──╯ ╰──╯          t₂
//!      │───╯                  t₁
//!      └──────────────────> t
//! ```
//!
//! The quarters of a travel are known when it is over. First passages keep them in a fixed memory;
//! where a stroke outgrows its cells, these are joined in pairs.

use core::f64::consts::PI;

/// Cells of a way.
const CELLS: usize = 256;

/// Width of a cell at first, rad: half a degree.
const WIDTH_RAD: f64 = 0.5 * PI / 180.0;

/// Part of a travel whose smoothness is measured: a rest at either end does not count.
const SMOOTH_PART: [f64; 2] = [0.05, 0.95];

/// First passages of a way that begins at an angle and goes in one sense.
#[derive(Clone, Debug)]
pub(super) struct Passages {
    start_rad: f64,
    /// ±1.
    sense: f64,
    begin_s: f64,
    width_rad: f64,
    /// Time at which the end of each cell was first passed, s.
    passed_s: [f64; CELLS],
    /// ∫ jerk² dt within each cell, rad²/s⁵: of those that were passed, and of the next.
    jerk: [f64; CELLS],
    /// Cells that were passed.
    count: usize,
    /// Time and way of the last sample, s and rad.
    last: (f64, f64),
}

/// Shape of a stroke.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Speed of the middle half of the travel, rad/s.
    pub(super) speed_rad_s: f64,
    /// Standard deviation of the speed in it, as a share of its mean.
    pub(super) unsteadiness: f64,
    /// Logarithm of the dimensionless jerk, with a minus; `None` where no jerk was taken.
    pub(super) smoothness: Option<f64>,
}

impl Passages {
    /// A way that has not begun.
    pub(super) const fn new() -> Self {
        Self {
            start_rad: 0.0,
            sense: 1.0,
            begin_s: 0.0,
            width_rad: WIDTH_RAD,
            passed_s: [0.0; CELLS],
            jerk: [0.0; CELLS],
            count: 0,
            last: (0.0, 0.0),
        }
    }

    /// Begins a way here.
    pub(super) fn begin(&mut self, time_s: f64, angle_rad: f64, sense: f64) {
        self.start_rad = angle_rad;
        self.sense = sense;
        self.begin_s = time_s;
        self.width_rad = WIDTH_RAD;
        self.count = 0;
        self.last = (time_s, 0.0);
        self.set_jerk(0, 0.0);
    }

    /// Angle at which it began, rad.
    pub(super) fn start_rad(&self) -> f64 {
        self.start_rad
    }

    /// Way of the last sample, rad; negative behind the beginning.
    pub(super) fn along_rad(&self) -> f64 {
        self.last.1
    }

    /// Takes the next sample. Angles are finite, and no more than some turns.
    pub(super) fn take(&mut self, time_s: f64, angle_rad: f64) {
        let along_rad = self.sense * (angle_rad - self.start_rad);
        while along_rad >= self.width_rad * number(CELLS) {
            self.widen();
        }
        let (last_s, last_rad) = self.last;
        self.last = (time_s, along_rad);
        loop {
            let end_rad = self.width_rad * number(self.count + 1);
            if along_rad < end_rad {
                return;
            }
            let share = (end_rad - last_rad) / (along_rad - last_rad);
            if let Some(passed_s) = self.passed_s.get_mut(self.count) {
                *passed_s = last_s + share * (time_s - last_s);
            }
            self.count += 1;
            self.set_jerk(self.count, 0.0);
        }
    }

    /// Takes the square of a jerk that lasted at an angle, rad²/s⁵.
    pub(super) fn add_jerk(&mut self, angle_rad: f64, squared: f64) {
        let along_rad = self.sense * (angle_rad - self.start_rad);
        let cell = place(along_rad / self.width_rad);
        if along_rad >= 0.0 && cell <= self.count {
            self.set_jerk(cell, self.jerk_of(cell) + squared);
        }
    }

    /// Joins the cells in pairs.
    fn widen(&mut self) {
        let pairs = self.count / 2;
        for pair in 0..=pairs {
            let jerk = self.jerk_of(2 * pair) + self.jerk_of(2 * pair + 1);
            self.set_jerk(pair, jerk);
        }
        for pair in 0..pairs {
            let end_s = self.passed_s.get(2 * pair + 1).copied();
            if let (Some(end_s), Some(joined_s)) = (end_s, self.passed_s.get_mut(pair)) {
                *joined_s = end_s;
            }
        }
        self.count = pairs;
        self.width_rad *= 2.0;
    }

    fn jerk_of(&self, cell: usize) -> f64 {
        let known = self.jerk.get(..=self.count).unwrap_or(&self.jerk);
        known.get(cell).copied().unwrap_or(0.0)
    }

    fn set_jerk(&mut self, cell: usize, jerk: f64) {
        if let Some(place) = self.jerk.get_mut(cell) {
            *place = jerk;
        }
    }

    /// Shape of a stroke of this travel, which is at least twenty cells long.
    pub(super) fn shape(&self, travel_rad: f64) -> Option<Shape> {
        let part = |share: f64| share * travel_rad;
        let middle_s = self.reached_s(part(0.75))? - self.reached_s(part(0.25))?;
        let speed_rad_s = part(0.5) / middle_s;
        // Means over time: ∫v dt is the way, and ∫v² dt the sum of way times speed.
        let (mut seconds, mut way_rad, mut squares) = (0.0, 0.0, 0.0);
        for speed in self.speeds(part(0.25), part(0.75)) {
            seconds += self.width_rad / speed;
            way_rad += self.width_rad;
            squares += self.width_rad * speed;
        }
        let mean = way_rad / seconds;
        let deviation = libm::sqrt((squares / seconds - mean * mean).max(0.0));
        speed_rad_s.is_finite().then(|| Shape {
            speed_rad_s,
            unsteadiness: deviation / mean,
            smoothness: self.smoothness(SMOOTH_PART.map(part)),
        })
    }

    /// −ln(T³·∫j²dt / v²) between two places of the way.
    fn smoothness(&self, [from_rad, to_rad]: [f64; 2]) -> Option<f64> {
        let time_s = self.reached_s(to_rad)? - self.reached_s(from_rad)?;
        let fastest = self.speeds(from_rad, to_rad).fold(0.0, f64::max);
        let cells = place(from_rad / self.width_rad)..=place(to_rad / self.width_rad);
        let jerk: f64 = cells
            .map(|cell| {
                let [start_rad, end_rad] =
                    [number(cell), number(cell + 1)].map(|cells| cells * self.width_rad);
                let part_rad = end_rad.min(to_rad) - start_rad.max(from_rad);
                self.jerk_of(cell) * (part_rad / self.width_rad).clamp(0.0, 1.0)
            })
            .sum();
        let dimensionless = time_s * time_s * time_s * jerk / (fastest * fastest);
        (dimensionless > 0.0 && dimensionless.is_finite()).then(|| -libm::log(dimensionless))
    }

    /// Time at which the way first came so far, s.
    fn reached_s(&self, along_rad: f64) -> Option<f64> {
        let cells = along_rad / self.width_rad;
        let cell = place(cells);
        let passed = self.passed_s.get(..self.count)?;
        let end_s = passed.get(cell)?;
        let start_s = match cell.checked_sub(1) {
            Some(before) => *passed.get(before)?,
            None => self.begin_s,
        };
        Some(start_s + (end_s - start_s) * (cells - number(cell)))
    }

    /// Speed in each cell between two places of the way, rad/s.
    fn speeds(&self, from_rad: f64, to_rad: f64) -> impl Iterator<Item = f64> {
        let width_rad = self.width_rad;
        let ends = place(from_rad / width_rad)..place(to_rad / width_rad).min(self.count);
        let within = self.passed_s.get(ends).unwrap_or_default();
        within.windows(2).filter_map(move |pair| match pair {
            [start_s, end_s] if end_s > start_s => Some(width_rad / (end_s - start_s)),
            _ => None,
        })
    }
}

/// The cell of a place in cells.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast from float saturates"
)]
pub(super) fn place(cells: f64) -> usize {
    cells as usize
}

#[expect(clippy::cast_precision_loss, reason = "some hundred cells")]
fn number(cells: usize) -> f64 {
    cells as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A way at a constant speed, rad/s, with a jerk in every millisecond.
    fn steady(speed: f64, to_rad: f64) -> Passages {
        let mut way = Passages::new();
        way.begin(0.0, 0.3, 1.0);
        for tick in 0_u32.. {
            let time_s = f64::from(tick) * 1e-3;
            let along_rad = speed * time_s;
            way.take(time_s, 0.3 + along_rad);
            way.add_jerk(0.3 + along_rad, 1e-3);
            if along_rad > to_rad {
                break;
            }
        }
        way
    }

    #[test]
    fn a_place_is_first_passed_when_the_way_comes_to_it() {
        for to_rad in [0.5, 2.0, 3.0, 9.0] {
            let way = steady(0.7, to_rad);
            for share in [0.1, 0.25, 0.5, 0.9] {
                let reached_s = way.reached_s(share * to_rad).unwrap();
                assert!((reached_s - share * to_rad / 0.7).abs() < 1e-9, "{to_rad}");
            }
            assert_eq!(way.reached_s(1.1 * to_rad), None);
            let shape = way.shape(to_rad).unwrap();
            assert!((shape.speed_rad_s / 0.7 - 1.0).abs() < 1e-9);
            assert!(shape.unsteadiness < 1e-6, "{}", shape.unsteadiness);
        }
    }

    /// A jerk of 1 rad/s³ all the time: T³·T/v².
    #[test]
    fn jerk_is_kept_where_cells_are_joined() {
        for to_rad in [0.5, 3.0, 9.0] {
            let way = steady(0.7, to_rad);
            let time_s = 0.9 * to_rad / 0.7;
            let expected = -libm::log(libm::pow(time_s, 4.0) / (0.7 * 0.7));
            let found = way.shape(to_rad).unwrap().smoothness.unwrap();
            let off = found - expected;
            assert!(off.abs() < 0.02, "{to_rad}: {found}, {expected}");
        }
    }

    #[test]
    fn a_way_that_turns_back_passes_nothing_twice() {
        let mut way = Passages::new();
        way.begin(0.0, 0.0, -1.0);
        for (time_s, angle_rad) in [(1.0, -0.1), (2.0, -0.05), (3.0, -0.1), (4.0, -0.2)] {
            way.take(time_s, angle_rad);
        }
        assert!((way.reached_s(0.05).unwrap() - 0.5).abs() < 1e-9);
        assert!((way.reached_s(0.15).unwrap() - 3.5).abs() < 1e-9);
        assert!((way.along_rad() - 0.2).abs() < 1e-12);
    }
}
