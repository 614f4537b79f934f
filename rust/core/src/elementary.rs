//! Elementary functions that vectorise: branch-free, without libm and without fused multiply-add.
//!
//! A call of libm keeps a loop scalar at every SIMD level. These are polynomials after argument reduction (Cody and
//! Waite), in plain arithmetic and selects, so that a loop over a slice becomes vector code.
//!
//! Largest errors against correctly rounded values, in units in the last place (checked by `tests/accuracy.rs`):
//!
//! | function | domain | float32 | float64 |
//! |---|---|---|---|
//! | `exp` | results above the subnormals | 2 | 2 |
//! | `sin`, `cos` | `|x| ≤ π`, absolute, in ulp of 1 | 1 | 1 |
//! | `atan2` | the upper half plane | 3 | 2 |
//! | quaternion logarithm | all, in ulp of its length | 4 | 3 |
//! | quaternion exponential | angles up to π, in ulp of 1 | 4 | 4 |
//! | rotation angle | all | 3 | 3 |
//! | squared rotation angle of a squared chord | `[0, 2]` | 3 | 3 |
//!
//! Polynomials: Cephes (S. Moshier) for sine, cosine and arc tangent; Taylor of degree 13 and 7 for `exp`; Remez of degree
//! 7 and 18, with the least relative error, for the squared angle.

use crate::Real;

/// `c[0]·xⁿ + … + c[n]`, by Horner's rule.
#[inline(always)]
fn polynomial<T: Real, const N: usize>(x: T, coefficients: [T; N]) -> T {
    let mut sum = coefficients[0];
    for &c in &coefficients[1..] {
        sum = sum * x + c;
    }
    sum
}

/// Sine and cosine from those of the remainder in `[−π/4, π/4]`, after subtracting multiples of 90°: an `odd` number
/// of them, or one whose second bit, `upper`, is set.
#[inline(always)]
fn turn<T: Real>(odd: bool, upper: bool, sin: T, cos: T) -> (T, T) {
    let (s, c) = if odd { (cos, -sin) } else { (sin, cos) };
    if upper { (-s, -c) } else { (s, c) }
}

macro_rules! real_basics {
    ($T:ident) => {
        const ZERO: Self = 0.0;
        const HALF: Self = 0.5;
        const ONE: Self = 1.0;
        const TWO: Self = 2.0;
        const PI: Self = std::$T::consts::PI;
        const HALF_PI: Self = std::$T::consts::FRAC_PI_2;
        const EPSILON: Self = $T::EPSILON;

        #[inline(always)]
        fn sqrt(self) -> Self {
            self.sqrt()
        }
        #[inline(always)]
        fn abs(self) -> Self {
            self.abs()
        }
        #[inline(always)]
        fn copysign(self, sign: Self) -> Self {
            self.copysign(sign)
        }
        #[inline(always)]
        fn is_finite(self) -> bool {
            self.is_finite()
        }
        #[inline(always)]
        fn is_nan(self) -> bool {
            self.is_nan()
        }
        #[inline(always)]
        fn nan() -> Self {
            $T::NAN
        }
        #[inline(always)]
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the cast saturates, which is what is asked for"
        )]
        fn to_count(self) -> usize {
            self as usize
        }
    };
}

/// Natural logarithm of a positive number that is not subnormal, to 2 units in the last place.
///
/// Cephes: a polynomial of the mantissa between `√½` and `√2`.
#[inline(always)]
#[must_use]
#[allow(clippy::cast_possible_wrap, clippy::cast_precision_loss, reason = "an exponent is a small integer")]
pub fn ln(x: f32) -> f32 {
    const LN2_HIGH: f32 = 0.693_359_375;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    const MANTISSA: u32 = 0x007f_ffff;
    let bits = x.to_bits();
    let half = f32::from_bits((bits & MANTISSA) | 0x3f00_0000);
    let exponent = (bits >> 23) as i32 - 126;
    let low = half < std::f32::consts::FRAC_1_SQRT_2;
    let r = if low { half + half } else { half } - 1.0;
    let n = (exponent - i32::from(low)) as f32;
    let z = r * r;
    let tail = polynomial(
        r,
        [
            7.037_683_6e-2,
            -1.151_461_03e-1,
            1.167_699_87e-1,
            -1.242_014_1e-1,
            1.424_932_3e-1,
            -1.666_805_7e-1,
            2.000_071_5e-1,
            -2.499_999_4e-1,
            3.333_333_1e-1,
        ],
    );
    let small = r * z * tail + n * LN2_LOW - 0.5 * z;
    r + small + n * LN2_HIGH
}

impl Real for f64 {
    real_basics!(f64);
    const TINY_SQUARE: Self = 1e-200;
    const LEAST_SQUARED: Self = 1.491_668_146_240_041_3e-154; // 2⁻⁵¹¹
    const SIN_COS_LIMIT: Self = 5e5;
    const EXP_LIMIT: Self = 709.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn exp(self) -> Self {
        const LN2_HIGH: f64 = 6.931_471_803_691_238_164_90e-1;
        const LN2_LOW: f64 = 1.908_214_929_270_587_700_02e-10;
        /// Adding this rounds to an integer, which is then in the low bits.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        const SUBNORMAL: f64 = -708.0;
        let x = if self > SUBNORMAL { self } else { SUBNORMAL };
        let shifted = x * std::f64::consts::LOG2_E + ROUND;
        let n = shifted - ROUND;
        let r = (x - n * LN2_HIGH) - n * LN2_LOW;
        let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
        let tail = polynomial(
            r,
            [
                1.605_904_383_682_161_3e-10,
                2.087_675_698_786_81e-9,
                2.505_210_838_544_171_9e-8,
                2.755_731_922_398_589_3e-7,
                2.755_731_922_398_589e-6,
                2.480_158_730_158_730_2e-5,
                1.984_126_984_126_984_1e-4,
                1.388_888_888_888_889e-3,
                8.333_333_333_333_333e-3,
                4.166_666_666_666_666_4e-2,
                1.666_666_666_666_666_6e-1,
                0.5,
            ],
        );
        let value = (1.0 + (r + r * r * tail)) * power;
        if self > SUBNORMAL { value } else { 0.0 }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        const PIO2_1: f64 = 1.570_796_326_734_125_614_17;
        const PIO2_2: f64 = 6.077_100_506_303_965_976_60e-11;
        const PIO2_3: f64 = 2.022_266_248_795_950_631_54e-21;
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let shifted = self * std::f64::consts::FRAC_2_PI + ROUND;
        let n = shifted - ROUND;
        let bits = shifted.to_bits();
        let rest = ((self - n * PIO2_1) - n * PIO2_2) - n * PIO2_3;
        let z = rest * rest;
        let sin = rest
            + rest
                * z
                * polynomial(
                    z,
                    [
                        1.589_623_015_765_465_680_60e-10,
                        -2.505_074_776_285_780_728_66e-8,
                        2.755_731_362_138_572_452_13e-6,
                        -1.984_126_982_958_953_859_96e-4,
                        8.333_333_333_322_118_588_78e-3,
                        -1.666_666_666_666_663_072_95e-1,
                    ],
                );
        let cos = 1.0 - 0.5 * z
            + z * z
                * polynomial(
                    z,
                    [
                        -1.135_853_652_138_768_173_00e-11,
                        2.087_570_084_197_473_167_78e-9,
                        -2.755_731_417_929_673_881_12e-7,
                        2.480_158_728_885_170_453_48e-5,
                        -1.388_888_888_887_305_641_16e-3,
                        4.166_666_666_666_659_292_18e-2,
                    ],
                );
        turn(bits & 1 != 0, bits & 2 != 0, sin, cos)
    }

    #[inline(always)]
    fn atan2_nonnegative(self, x: Self) -> Self {
        /// Part of `π/4` and `π/2` beyond their last digit.
        const MORE_BITS: f64 = 6.123_233_995_736_765_886_130e-17;
        let (low, high) = if self < x.abs() { (self, x.abs()) } else { (x.abs(), self) };
        let high = if high > 0.0 { high } else { 1.0 };
        // One select as a factor: with several selects the compiler computes both quotients and both polynomials.
        let far = if low > 0.66 * high { 1.0 } else { 0.0 };
        let a = (low - far * high) / (high + far * low);
        let z = a * a;
        let p = polynomial(
            z,
            [
                -8.750_608_600_031_904_122_785e-1,
                -1.615_753_718_733_365_076_637e1,
                -7.500_855_792_314_704_667_340e1,
                -1.228_866_684_490_136_173_410e2,
                -6.485_021_904_942_025_371_773e1,
            ],
        );
        let q = polynomial(
            z,
            [
                1.0,
                2.485_846_490_142_306_297_962e1,
                1.650_270_098_316_988_542_046e2,
                4.328_810_604_912_902_668_951e2,
                4.853_903_996_359_136_964_868e2,
                1.945_506_571_482_613_964_425e2,
            ],
        );
        let tail = a * z * (p / q);
        let octant = far * std::f64::consts::FRAC_PI_4 + (a + (tail + far * (0.5 * MORE_BITS)));
        let quadrant = if self > x.abs() { Self::HALF_PI - (octant - MORE_BITS) } else { octant };
        if x < 0.0 { Self::PI - (quadrant - 2.0 * MORE_BITS) } else { quadrant }
    }

    #[inline(always)]
    fn square_of_angle(self) -> Self {
        self * polynomial(
            self,
            [
                1.634_207_584_233_487_094e-10,
                -2.428_667_857_255_754_8e-9,
                1.718_017_590_149_359_297e-8,
                -7.489_597_056_637_154_333e-8,
                2.248_961_428_445_748_711e-7,
                -4.866_350_522_236_849_275e-7,
                7.936_448_817_405_813_969e-7,
                -9.461_696_276_512_179_397e-7,
                9.958_863_745_637_460_471e-7,
                -2.075_331_736_369_140_281e-7,
                2.374_582_631_960_588_623e-6,
                9.575_853_508_751_344_025e-6,
                4.761_094_088_146_377_744e-5,
                2.404_922_692_763_814_253e-4,
                1.269_842_336_346_576_644e-3,
                7.142_857_056_010_945_4e-3,
                4.444_444_444_817_375_925e-2,
                3.333_333_333_332_698_983e-1,
                4.0,
            ],
        )
    }
}

impl Real for f32 {
    real_basics!(f32);
    const TINY_SQUARE: Self = 1e-24;
    const LEAST_SQUARED: Self = 1.084_202_172_485_504_4e-19; // 2⁻⁶³
    const SIN_COS_LIMIT: Self = 8000.0;
    const EXP_LIMIT: Self = 88.0;

    #[inline(always)]
    #[allow(clippy::cast_possible_truncation, reason = "rounding is what is asked for")]
    fn from_f64(x: f64) -> Self {
        x as Self
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        const LN2_HIGH: f32 = 0.693_359_375;
        const LN2_LOW: f32 = -2.121_944_4e-4;
        const ROUND: f32 = 12_582_912.0;
        const SUBNORMAL: f32 = -87.0;
        let x = if self > SUBNORMAL { self } else { SUBNORMAL };
        let shifted = x * std::f32::consts::LOG2_E + ROUND;
        let n = shifted - ROUND;
        let r = (x - n * LN2_HIGH) - n * LN2_LOW;
        let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(127 << 23));
        let tail = polynomial(
            r,
            [1.984_127_e-4, 1.388_888_9e-3, 8.333_333_3e-3, 4.166_666_7e-2, 1.666_666_7e-1, 0.5],
        );
        let value = (1.0 + (r + r * r * tail)) * power;
        if self > SUBNORMAL { value } else { 0.0 }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        const PIO2_1: f32 = 1.570_312_5;
        const PIO2_2: f32 = 4.837_513e-4;
        const PIO2_3: f32 = 7.549_79e-8;
        const ROUND: f32 = 12_582_912.0;
        let shifted = self * std::f32::consts::FRAC_2_PI + ROUND;
        let n = shifted - ROUND;
        let bits = shifted.to_bits();
        let rest = ((self - n * PIO2_1) - n * PIO2_2) - n * PIO2_3;
        let z = rest * rest;
        let sin = rest + rest * z * polynomial(z, [-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1]);
        let cos = 1.0 - 0.5 * z + z * z * polynomial(z, [2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]);
        turn(bits & 1 != 0, bits & 2 != 0, sin, cos)
    }

    #[inline(always)]
    fn atan2_nonnegative(self, x: Self) -> Self {
        const TAN_PI_8: f32 = 0.414_213_56;
        let (low, high) = if self < x.abs() { (self, x.abs()) } else { (x.abs(), self) };
        let high = if high > 0.0 { high } else { 1.0 };
        let far = if low > TAN_PI_8 * high { 1.0 } else { 0.0 };
        let a = (low - far * high) / (high + far * low);
        let z = a * a;
        let tail = a * z * polynomial(z, [8.053_744_5e-2, -1.387_768_6e-1, 1.997_771_1e-1, -3.333_295e-1]);
        let octant = far * std::f32::consts::FRAC_PI_4 + (a + tail);
        let quadrant = if self > x.abs() { Self::HALF_PI - octant } else { octant };
        if x < 0.0 { Self::PI - quadrant } else { quadrant }
    }

    #[inline(always)]
    fn square_of_angle(self) -> Self {
        self * polynomial(
            self,
            [
                8.014_513e-5,
                -2.744_948_5e-4,
                8.895_132_5e-4,
                5.901_734e-4,
                7.517_154_8e-3,
                4.434_507e-2,
                3.333_432_7e-1,
                3.999_999_8,
            ],
        )
    }
}
