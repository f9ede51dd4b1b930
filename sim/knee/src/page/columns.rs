//! Samples of a page, a column each: in its memory they lie one behind the other.

/// The most ticks of one [`Page::advance`](super::Page::advance): 102 ms.
pub const MOST_TICKS: u32 = 2048;

/// Numbers of a column.
pub const ROOM: usize = MOST_TICKS as usize;

/// Samples of the last [`Page::advance`](super::Page::advance), a column each.
#[derive(Debug)]
pub struct Columns {
    /// Torque of the device, N·m; positive opposes growing angle.
    pub torque_nm: [f32; ROOM],
    /// Angle of the knee, rad.
    pub angle_rad: [f32; ROOM],
    /// Velocity of the knee, rad/s.
    pub speed_rad_s: [f32; ROOM],
    /// Angle at which the hand wants the leg, rad; that of the leg, if nobody holds it.
    pub hand_rad: [f32; ROOM],
    /// Angle of the imaginary object, rad; 0 without one.
    pub object_rad: [f32; ROOM],
    /// Torque of its spring, N·m.
    pub spring_nm: [f32; ROOM],
    /// [States](crepitus_model::render::effects::STATES) of the symptoms, a bit each.
    pub states: [u32; ROOM],
    /// Phase of the imaginary object: 1 stick, 2 slip, 0 without one.
    pub phase: [u32; ROOM],
}

/// One row of [`Columns`].
pub(super) struct Sample {
    pub(super) torque_nm: f32,
    pub(super) angle_rad: f32,
    pub(super) speed_rad_s: f32,
    pub(super) hand_rad: f32,
    pub(super) object_rad: f32,
    pub(super) spring_nm: f32,
    pub(super) states: u32,
    pub(super) phase: u32,
}

impl Columns {
    /// Columns of zeros.
    pub(super) const EMPTY: Self = Self {
        torque_nm: [0.0; ROOM],
        angle_rad: [0.0; ROOM],
        speed_rad_s: [0.0; ROOM],
        hand_rad: [0.0; ROOM],
        object_rad: [0.0; ROOM],
        spring_nm: [0.0; ROOM],
        states: [0; ROOM],
        phase: [0; ROOM],
    };

    /// Puts a sample into a row; one without a row is left out.
    pub(super) fn put(&mut self, at: usize, sample: &Sample) {
        put(&mut self.torque_nm, at, sample.torque_nm);
        put(&mut self.angle_rad, at, sample.angle_rad);
        put(&mut self.speed_rad_s, at, sample.speed_rad_s);
        put(&mut self.hand_rad, at, sample.hand_rad);
        put(&mut self.object_rad, at, sample.object_rad);
        put(&mut self.spring_nm, at, sample.spring_nm);
        put(&mut self.states, at, sample.states);
        put(&mut self.phase, at, sample.phase);
    }
}

fn put<T>(column: &mut [T; ROOM], at: usize, value: T) {
    if let Some(place) = column.get_mut(at) {
        *place = value;
    }
}
