//! What the limb itself does: columns of a linear model.

use super::motion::Motion;
use super::symptom::play;

/// Travel over which the dry friction of limb and apparatus turns round, deg.
const DRY_DEG: f64 = 2.0;

/// Smallest length of a column besides those before it, as a share: a shorter one is none of its own.
const DEPENDENT: f64 = 1e-5;

/// Returns the columns of the limb: offset, drift, gravity, elasticity, the steep ends of the range (growths of the
/// order of Riener & Edrich, J. Biomech. 32 (1999), 539–544), viscous damping, inertia, and dry friction if wanted.
pub(crate) fn columns(motion: &Motion, with_friction: bool) -> Vec<Vec<f64>> {
    let of = |f: &dyn Fn(f64) -> f64| {
        motion
            .angle_rad
            .iter()
            .map(|angle| f(*angle))
            .collect::<Vec<f64>>()
    };
    let lasts = motion.time_s.last().copied().unwrap_or(1.0)
        - motion.time_s.first().copied().unwrap_or(0.0);
    let mut columns = vec![
        vec![1.0; motion.len()],
        motion.time_s.iter().map(|t| t / lasts.max(1e-9)).collect(),
        of(&f64::sin),
        of(&f64::cos),
        of(&|angle| angle),
        of(&|angle| (-angle.to_degrees() / 5.0).exp()),
        of(&|angle| (-angle.to_degrees() / 9.0).exp()),
        of(&|angle| (-angle.to_degrees() / 25.0).exp()),
        of(&|angle| ((angle.to_degrees() - 120.0) / 20.0).exp()),
        motion.omega_rad_s.clone(),
    ];
    if !motion.is_released {
        columns.push(motion.alpha_rad_s2.clone());
    }
    if with_friction {
        columns.push(play(motion, DRY_DEG));
    }
    columns
}

/// Orthonormal columns that span the same (Gram–Schmidt, twice).
pub(crate) fn orthonormal(columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        let mut rest = column.clone();
        let before = dot(&rest, &rest).sqrt();
        for _ in 0..2 {
            project_out(&basis, &mut rest);
        }
        let length = dot(&rest, &rest).sqrt();
        if length > DEPENDENT * before {
            for x in &mut rest {
                *x /= length;
            }
            basis.push(rest);
        }
    }
    basis
}

pub(crate) fn project_out(basis: &[Vec<f64>], from: &mut [f64]) {
    for column in basis {
        let share = dot(column, from);
        from.iter_mut()
            .zip(column)
            .for_each(|(x, q)| *x -= share * q);
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
