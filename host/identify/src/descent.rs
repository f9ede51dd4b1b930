//! Levenberg–Marquardt: the descent of all fits.
//!
//! D. W. Marquardt, J. SIAM 11 (1963), 431–441: the step x of (A + λ·diag A)·x = g, with A the
//! normal equations and g the gradient; λ falls tenfold after a step that lowers the cost, and
//! grows tenfold after one that does not.

use nalgebra::allocator::Allocator;
use nalgebra::{DefaultAllocator, Dim, OMatrix, OVector};

/// λ of the first step.
const FIRST_CAUTION: f64 = 1e-3;

/// Normal equations at a point: JᵀJ and Jᵀr.
pub(crate) struct Equations<D: Dim>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    pub(crate) normal: OMatrix<f64, D, D>,
    pub(crate) right: OVector<f64, D>,
}

/// A sum of squares over points with so many coordinates.
pub(crate) trait LeastSquares<D: Dim>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    /// A point.
    type Point;

    /// The normal equations at a point.
    fn equations(&self, point: &Self::Point) -> Equations<D>;

    /// The cost at a point: |r|².
    fn cost(&self, point: &Self::Point) -> f64;

    /// The point that a step leads to.
    fn stepped(&self, point: &Self::Point, step: &OVector<f64, D>) -> Self::Point;
}

/// When a descent ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending {
    /// Most steps.
    pub(crate) steps: u32,
    /// Relative decrease of the cost below which it has converged.
    pub(crate) gain: f64,
    /// Least λ, and the λ beyond which no step helps.
    pub(crate) caution: (f64, f64),
}

/// Descends from a point; `None` if the equations have no solution.
pub(crate) fn descend<D: Dim, P: LeastSquares<D>>(
    problem: &P,
    mut point: P::Point,
    ending: Ending,
) -> Option<P::Point>
where
    DefaultAllocator: Allocator<D> + Allocator<D, D>,
{
    let (mut at, mut cost) = (problem.equations(&point), problem.cost(&point));
    let mut caution = FIRST_CAUTION;
    for _ in 0..ending.steps {
        let mut cautious = at.normal.clone();
        for i in 0..cautious.nrows() {
            cautious[(i, i)] += caution * at.normal[(i, i)];
        }
        let step = cautious.cholesky()?.solve(&at.right);
        let next = problem.stepped(&point, &step);
        let cost_there = problem.cost(&next);
        if cost_there < cost {
            let gain = (cost - cost_there) / cost;
            (point, cost) = (next, cost_there);
            if gain < ending.gain {
                break;
            }
            at = problem.equations(&point);
            caution = (caution / 10.0).max(ending.caution.0);
        } else {
            caution *= 10.0;
            if caution > ending.caution.1 {
                break;
            }
        }
    }
    Some(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, U2, Vector2};

    /// Rosenbrock's valley: residuals 1 − x and −10·(y − x²).
    struct Valley;

    fn residual(point: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(1.0 - point.x, -10.0 * (point.y - point.x * point.x))
    }

    impl LeastSquares<U2> for Valley {
        type Point = Vector2<f64>;

        fn equations(&self, point: &Vector2<f64>) -> Equations<U2> {
            // Derivatives of what is subtracted.
            let slopes = Matrix2::new(1.0, 0.0, -20.0 * point.x, 10.0);
            Equations {
                normal: slopes.transpose() * slopes,
                right: slopes.transpose() * residual(point),
            }
        }

        fn cost(&self, point: &Vector2<f64>) -> f64 {
            residual(point).norm_squared()
        }

        fn stepped(&self, point: &Vector2<f64>, step: &Vector2<f64>) -> Vector2<f64> {
            point + step
        }
    }

    #[test]
    fn the_bottom_of_a_bent_valley_is_reached() {
        let ending = Ending {
            steps: 100,
            gain: 1e-12,
            caution: (1e-12, 1e12),
        };
        let end = descend(&Valley, Vector2::new(-1.2, 1.0), ending).unwrap();
        assert!((end - Vector2::new(1.0, 1.0)).norm() < 1e-9, "{end}");
        let few = Ending { steps: 3, ..ending };
        let end = descend(&Valley, Vector2::new(-1.2, 1.0), few).unwrap();
        assert!((end - Vector2::new(1.0, 1.0)).norm() > 0.1, "{end}");
    }
}
