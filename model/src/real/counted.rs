//! f64 that counts what is done with it: what a tick costs, where no processor is at hand to
//! time it. For tests of promises such as "no root is needed to see it".

use super::{Real, State, There};
use core::cell::Cell;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A counted number.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct Counted(f64);

/// Tally of the operations on counted numbers. Signs and comparisons are free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    /// Sums, differences and products.
    pub(crate) quick: u32,
    /// Quotients, roots and elementary functions: fourteen cycles each, or more.
    pub(crate) slow: u32,
}

impl Operations {
    const NONE: Self = Self { quick: 0, slow: 0 };

    /// All of them.
    pub(crate) fn all(self) -> u32 {
        self.quick + self.slow
    }
}

std::thread_local! {
    static DONE: Cell<Operations> = const { Cell::new(Operations::NONE) };
}

/// Runs `work`; returns its result and what it has cost.
pub(crate) fn operations<T>(work: impl FnOnce() -> T) -> (T, Operations) {
    DONE.set(Operations::NONE);
    let result = work();
    (result, DONE.get())
}

fn quick(x: f64) -> Counted {
    let done = DONE.get();
    DONE.set(Operations {
        quick: done.quick + 1,
        ..done
    });
    Counted(x)
}

fn slow(x: f64) -> Counted {
    let done = DONE.get();
    DONE.set(Operations {
        slow: done.slow + 1,
        ..done
    });
    Counted(x)
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        quick(self.0 + other.0)
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        quick(self.0 - other.0)
    }
}

impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        quick(self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        slow(self.0 / other.0)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Counted {
    type InDouble<T: State> = There<T>;
    const ZERO: Self = Self(0.0);
    const HALF: Self = Self(0.5);
    const ONE: Self = Self(1.0);
    const TWO: Self = Self(2.0);
    const EPSILON: Self = Self(<f64 as Real>::EPSILON);
    const LIMIT_SLACK: Self = Self(<f64 as Real>::LIMIT_SLACK);
    const TOUCH_SLACK: Self = Self(<f64 as Real>::TOUCH_SLACK);
    const AT_REST: Self = Self(<f64 as Real>::AT_REST);
    const IS_SINGLE: bool = false;
    const NAME: &'static str = "counted";

    fn from_f64(x: f64) -> Self {
        Self(x)
    }

    fn to_f64(self) -> f64 {
        self.0
    }

    fn whole(self) -> u64 {
        Real::whole(self.0)
    }

    fn from_whole(n: u64) -> Self {
        Self(<f64 as Real>::from_whole(n))
    }

    fn from_count(n: i32) -> Self {
        Self(f64::from(n))
    }

    fn abs(self) -> Self {
        Self(Real::abs(self.0))
    }

    fn sqrt(self) -> Self {
        slow(Real::sqrt(self.0))
    }

    fn exp(self) -> Self {
        slow(Real::exp(self.0))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.0);
        (slow(sin), Self(cos))
    }

    fn atan2(self, x: Self) -> Self {
        slow(Real::atan2(self.0, x.0))
    }

    fn is_finite(self) -> bool {
        Real::is_finite(self.0)
    }
}

#[test]
fn an_operation_counts_once_and_only_while_it_is_watched() {
    let (two, three) = (Counted(2.0), Counted(3.0));
    let (sum, done) = operations(|| -(two + three) * three - two);
    assert_eq!(sum, Counted(-17.0));
    assert_eq!((done.quick, done.slow, done.all()), (3, 0, 3));
    let (root, done) = operations(|| (three / two).sqrt());
    assert_eq!(root.to_f64(), Real::sqrt(1.5_f64));
    assert_eq!((done.quick, done.slow, done.all()), (0, 2, 2));
    assert_eq!(operations(|| two < three), (true, Operations::NONE));
}
