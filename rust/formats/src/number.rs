//! Decimal text to float64, correctly rounded, straight from bytes.
//!
//! Almost every number in a motion file has at most 15 digits: its digits are an integer below 2⁵³ and its power of
//! ten is at most 10²². Both are exact in float64, and one multiplication or division rounds once, to the nearest
//! float64 (W. D. Clinger, How to read floating point numbers accurately, PLDI 1990). The few others are parsed by
//! the standard library.

use crate::text::is_blank;

const LARGEST_EXACT: u64 = 1 << 53;
/// A u64 can store every number of 19 digits.
const MOST_DIGITS: usize = 19;
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Reads the number at the start of `bytes`, up to a blank or the end: its value and its length in bytes.
///
/// `nan` in any spelling, also that of Microsoft's C library (`-1.#IND`, `nan(ind)`), is NaN. `None` if the word is
/// not a number.
#[inline]
pub(crate) fn scan(bytes: &[u8]) -> Option<(f64, usize)> {
    let signed = matches!(bytes.first(), Some(b'-' | b'+'));
    let negative = bytes.first() == Some(&b'-');
    let (mut mantissa, whole_end) = digits(bytes, usize::from(signed), 0);
    let mut end = whole_end;
    let mut count = whole_end - usize::from(signed);
    let mut exponent = 0_i64;
    if bytes.get(end) == Some(&b'.') {
        let start = end + 1;
        (mantissa, end) = digits(bytes, start, mantissa);
        count += end - start;
        exponent = -i64::try_from(end - start).ok()?;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let (written, after) = power(bytes, end + 1);
        exponent += written;
        end = after;
    }
    let complete = bytes.get(end).is_none_or(|&b| is_blank(b));
    if !complete || count == 0 || count > MOST_DIGITS || mantissa > LARGEST_EXACT {
        return scan_slowly(bytes);
    }
    let magnitude = mantissa as f64;
    let scale = |power: u64| usize::try_from(power).ok().and_then(|power| POWERS_OF_TEN.get(power));
    let value = match scale(exponent.unsigned_abs()) {
        Some(power) if exponent < 0 => magnitude / power,
        Some(power) => magnitude * power,
        None => return scan_slowly(bytes),
    };
    Some((if negative { -value } else { value }, end))
}

/// The value of a word that is entirely a number.
pub(crate) fn parse(word: &[u8]) -> Option<f64> {
    scan(word).filter(|&(_, length)| length == word.len()).map(|(value, _)| value)
}

/// Appends the digits from `start` on to `mantissa`, which wraps; the caller counts the digits.
#[inline]
fn digits(bytes: &[u8], start: usize, mut mantissa: u64) -> (u64, usize) {
    let mut end = start;
    while let Some(&byte) = bytes.get(end) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        end += 1;
    }
    (mantissa, end)
}

/// The exponent after an `e`, limited to `BEYOND`, which is past every table; `BEYOND` if there are no digits.
#[inline]
fn power(bytes: &[u8], start: usize) -> (i64, usize) {
    const BEYOND: i64 = 100_000;
    let signed = matches!(bytes.get(start), Some(b'-' | b'+'));
    let first = start + usize::from(signed);
    let mut value = 0_i64;
    let mut end = first;
    while let Some(&byte) = bytes.get(end) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = (value * 10 + i64::from(digit)).min(BEYOND);
        end += 1;
    }
    if end == first {
        return (BEYOND, end);
    }
    (if bytes.get(start) == Some(&b'-') { -value } else { value }, end)
}

#[cold]
fn scan_slowly(bytes: &[u8]) -> Option<(f64, usize)> {
    let length = bytes.iter().position(|&b| is_blank(b)).unwrap_or(bytes.len());
    let word = std::str::from_utf8(&bytes[..length]).ok()?;
    let value = word.parse::<f64>().ok().or_else(|| is_nan(word).then_some(f64::NAN))?;
    Some((value, length))
}

/// `nan(ind)`, `-nan(snan)`, `1.#QNAN`, `-1.#IND00`.
fn is_nan(word: &str) -> bool {
    let word = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
    (word.starts_with("nan(") && word.ends_with(')'))
        || ["1.#qnan", "1.#snan", "1.#ind", "1.#nan"].iter().any(|&form| word.starts_with(form))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_as_files_write_them() {
        for word in [
            "0",
            "-0.0",
            "-0",
            "+3.5",
            "7.",
            ".0083333",
            "-.5",
            "-1.51632e-14",
            "2.29907e-014",
            "9.3e+007",
            "1e22",
            "1e23",
            "0.30000000000000004",
            "123456789012345678901234567890",
            "9007199254740993",
            "5e-324",
            "1.7976931348623157e308",
            "0e999",
            "0.000000",
            "2.2250738585072011e-308",
        ] {
            let expected: f64 = word.parse().unwrap();
            let value = parse(word.as_bytes()).unwrap();
            assert_eq!(value.to_bits(), expected.to_bits(), "{word}");
        }
    }

    #[test]
    fn words_that_are_no_numbers() {
        for word in
            ["", "-", ".", "e5", "1e", "1e-", "1.2.3", "0x10", "12a", "1,5", "--1", "1-2", "nano", "\u{fc}"]
        {
            assert_eq!(parse(word.as_bytes()), None, "{word}");
        }
    }

    #[test]
    fn every_spelling_of_nan() {
        for word in ["nan", "NaN", "-nan", "nan(ind)", "-nan(snan)", "1.#QNAN", "-1.#IND00"] {
            assert!(parse(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
    }

    #[test]
    fn a_number_ends_at_a_blank() {
        assert_eq!(scan(b"1.5 2"), Some((1.5, 3)));
        assert_eq!(scan(b"-2\n"), Some((-2.0, 2)));
        assert_eq!(scan(b"nan\r\n").map(|(value, length)| (value.is_nan(), length)), Some((true, 3)));
    }

    proptest! {
        #[test]
        fn agrees_with_the_standard_library(value in any::<f64>().prop_filter("finite", |v| v.is_finite()), digits in 0_usize..20) {
            for word in [format!("{value}"), format!("{value:e}"), format!("{value:.digits$e}"), format!("{:.digits$}", value % 1e4)] {
                let expected: f64 = word.parse().unwrap();
                prop_assert_eq!(parse(word.as_bytes()).map(f64::to_bits), Some(expected.to_bits()), "{}", word);
            }
        }

        #[test]
        fn accepts_what_the_standard_library_accepts(word in "[-+]?[0-9]{0,22}[.]?[0-9]{0,22}([eE][-+]?[0-9]{0,4})?") {
            prop_assert_eq!(parse(word.as_bytes()).map(f64::to_bits), word.parse::<f64>().ok().map(f64::to_bits), "{}", word);
        }
    }
}
