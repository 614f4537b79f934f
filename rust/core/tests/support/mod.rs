//! Twice the digits of float64, as unevaluated sums of two: the truth that accuracy is measured against.
//!
//! Sums and products after Dekker and Knuth, good to about 1e-31 of the largest operand.

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Debug, Clone, Copy)]
pub(crate) struct Wide {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

impl Wide {
    pub(crate) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(crate) const ONE: Self = Self { high: 1.0, low: 0.0 };
    pub(crate) const PI: Self = Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    pub(crate) const LN_2: Self = Self { high: std::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };

    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }

    fn product(a: f64, b: f64) -> Self {
        let split = |x: f64| {
            let t = 134_217_729.0 * x;
            let upper = t - (t - x);
            (upper, x - upper)
        };
        let high = a * b;
        let ((a1, a2), (b1, b2)) = (split(a), split(b));
        Self { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    /// `self / divisor`, by one correction of the float64 quotient.
    pub(crate) fn over(self, divisor: Self) -> Self {
        let first = self.high / divisor.high;
        let rest = self - divisor * Self::from(first);
        let second = rest.high / divisor.high;
        let rest = rest - divisor * Self::from(second);
        Self::from(first) + Self::from(second) + Self::from(rest.high / divisor.high)
    }

    /// The square root, by two steps of Newton's method from the float64 one.
    pub(crate) fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return Self::ZERO;
        }
        let mut root = Self::from(self.high.sqrt());
        for _ in 0..2 {
            root = (root + self.over(root)) * Self::from(0.5);
        }
        root
    }

    /// `(m, n)` with `exp = m·2ⁿ` and m near 1: Taylor after taking away multiples of ln 2, and halving the rest.
    pub(crate) fn exp(self) -> (Self, i32) {
        let n = (self.high / std::f64::consts::LN_2).round();
        let rest = (self - Self::LN_2 * Self::from(n)) * Self::from(1.0 / 256.0);
        // exp(r) − 1 is doubled, not exp(r): its digits would drown in the 1.
        let mut less_one = Self::ZERO;
        for k in (1..=14).rev() {
            less_one = (less_one + Self::ONE) * rest.over(Self::from(f64::from(k)));
        }
        for _ in 0..8 {
            less_one = less_one * (less_one + Self::from(2.0));
        }
        #[expect(clippy::cast_possible_truncation, reason = "a small whole number")]
        let power = n as i32;
        (less_one + Self::ONE, power)
    }

    /// Sine and cosine for `|x| ≤ 4`: Taylor after taking away quarter turns.
    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let n = (self.high / std::f64::consts::FRAC_PI_2).round();
        let rest = self - Self::PI * Self::from(n * 0.5);
        let square = -(rest * rest);
        let (mut sine, mut cosine) = (Self::ZERO, Self::ZERO);
        for k in (1..=15).rev() {
            let k = f64::from(k);
            sine = (sine + Self::ONE) * square.over(Self::from((2.0 * k) * (2.0 * k + 1.0)));
            cosine = (cosine + Self::ONE) * square.over(Self::from((2.0 * k - 1.0) * (2.0 * k)));
        }
        let (sine, cosine) = ((sine + Self::ONE) * rest, cosine + Self::ONE);
        match n.rem_euclid(4.0) {
            1.0 => (cosine, -sine),
            2.0 => (-sine, -cosine),
            3.0 => (-cosine, sine),
            _ => (sine, cosine),
        }
    }

    /// The angle of the point `(x, y)`: the float64 one, turned back, leaves an angle small enough for two terms.
    #[expect(clippy::disallowed_methods, reason = "the first guess, outside of hot loops")]
    pub(crate) fn atan2(y: Self, x: Self) -> Self {
        let guess = Self::from(y.high.atan2(x.high));
        let (sine, cosine) = guess.sin_cos();
        let across = y * cosine - x * sine;
        let along = x * cosine + y * sine;
        let small = across.over(along);
        guess + small - small * small * small * Self::ONE.over(Self::from(3.0))
    }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let first = Self::sum(high.high, high.low + low.high);
        Self::sum(first.high, first.low + low.low)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}
