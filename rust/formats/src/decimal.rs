//! Float64 to decimal text.

use std::io::Write as _;

/// Number of digits of written numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// The fewest digits that read back as the same float64.
    #[default]
    Shortest,
    /// This many digits after the point.
    Decimals(u8),
}

/// Integers below this have at most 15 digits, and every decimal of 15 digits reads back unchanged.
const FIFTEEN_DIGITS: f64 = 1e15;
/// Most numbers in motion files have at most six decimals, and almost all others at most ten.
const TRIED: [(f64, usize); 2] = [(1e6, 6), (1e10, 10)];
const POWERS: [f64; 13] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12];

/// Appends `value` to `out`; a value that is not finite is written as `nan`, a missing sample.
pub(crate) fn push(out: &mut Vec<u8>, value: f64, precision: Precision) {
    if !value.is_finite() {
        out.extend_from_slice(b"nan");
        return;
    }
    match precision {
        Precision::Shortest => push_shortest(out, value),
        Precision::Decimals(decimals) => push_fixed(out, value, usize::from(decimals)),
    }
}

fn push_shortest(out: &mut Vec<u8>, value: f64) {
    for (scale, decimals) in TRIED {
        let scaled = (value.abs() * scale).round();
        // The quotient of two exact numbers is the value of the decimal; below 15 digits the only shorter form omits
        // its final zeros.
        if scaled < FIFTEEN_DIGITS && (scaled / scale).to_bits() == value.abs().to_bits() {
            return push_scaled(out, value.is_sign_negative(), scaled, decimals, true);
        }
    }
    let magnitude = value.abs();
    let _never_fails =
        if (1e-5..1e16).contains(&magnitude) { write!(out, "{value}") } else { write!(out, "{value:e}") };
}

fn push_fixed(out: &mut Vec<u8>, value: f64, decimals: usize) {
    if let Some(scale) = POWERS.get(decimals) {
        let scaled = (value.abs() * scale).round();
        if scaled < FIFTEEN_DIGITS {
            return push_scaled(out, value.is_sign_negative(), scaled, decimals, false);
        }
    }
    let _never_fails = write!(out, "{value:.decimals$}");
}

/// Appends `scaled / 10^decimals`, where `scaled` is an integer from 0 to 10¹⁵.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the callers pass integers between 0 and 1e15, and digits fit a byte"
)]
fn push_scaled(out: &mut Vec<u8>, negative: bool, scaled: f64, decimals: usize, trim: bool) {
    let mut left = scaled as u64;
    let mut buffer = [b'0'; 24];
    let mut start = buffer.len();
    let point = buffer.len() - decimals;
    let mut end = buffer.len();
    while left > 0 || start >= point {
        start -= 1;
        buffer[start] = b'0' + (left % 10) as u8;
        left /= 10;
    }
    if trim {
        while end > point && buffer[end - 1] == b'0' {
            end -= 1;
        }
    }
    if negative {
        out.push(b'-');
    }
    out.extend_from_slice(&buffer[start..point]);
    if end > point {
        out.push(b'.');
        out.extend_from_slice(&buffer[point..end]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, precision: Precision) -> String {
        let mut out = Vec::new();
        push(&mut out, value, precision);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn shortest() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (-12.5, "-12.5"),
            (0.000_001, "0.000001"),
            (-0.002_651_38, "-0.00265138"),
            (1e-14, "1e-14"),
            (0.1 + 0.2, "0.30000000000000004"),
            (123_456_789.25, "123456789.25"),
            (1e300, "1e300"),
            (f64::NAN, "nan"),
            (f64::INFINITY, "nan"),
        ] {
            assert_eq!(text(value, Precision::Shortest), expected);
        }
    }

    #[test]
    fn fixed() {
        for (value, decimals, expected) in [
            (1.0, 0, "1"),
            (0.5, 3, "0.500"),
            (-12.345_678_9, 4, "-12.3457"),
            (99.999_96, 4, "100.0000"),
            (0.0, 6, "0.000000"),
            (1e17, 2, "100000000000000000.00"),
            (0.25, 20, "0.25000000000000000000"),
        ] {
            assert_eq!(text(value, Precision::Decimals(decimals)), expected);
        }
    }

    proptest! {
        #[test]
        fn shortest_is_what_the_standard_library_writes(whole in -2_000_000_000_000_i64..2_000_000_000_000, decimals in 0_i32..12) {
            let value = whole as f64 / 10_f64.powi(decimals);
            let written = text(value, Precision::Shortest);
            prop_assert_eq!(written.parse::<f64>().unwrap().to_bits(), value.to_bits());
            if value == 0.0 || value.abs() >= 1e-5 {
                prop_assert_eq!(written, format!("{value}"));
            }
        }

        #[test]
        fn shortest_reads_back(value in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
            prop_assert_eq!(text(value, Precision::Shortest).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }

        #[test]
        fn fixed_is_near(value in -1e6..1e6_f64, decimals in 0_u8..10) {
            let half = 0.5 * 10_f64.powi(-i32::from(decimals));
            let read: f64 = text(value, Precision::Decimals(decimals)).parse().unwrap();
            prop_assert!((read - value).abs() <= half * (1.0 + 1e-9) + 1e-9 * half + value.abs() * f64::EPSILON * 2.0);
        }
    }
}
