//! The error type of the core, for memory safety and cancellation. Arguments of users are validated in Python.

use std::fmt;

/// Why a kernel rejected its arguments or stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// The length of a slice does not agree with the shapes.
    Length {
        /// The argument.
        name: &'static str,
        /// Number of elements according to the shapes.
        expected: usize,
        /// Number of elements received.
        got: usize,
    },
    /// A parameter is outside the range of the kernel.
    Parameter {
        /// The argument.
        name: &'static str,
        /// The expected value.
        expected: &'static str,
    },
    /// The interrupt flag was set.
    Interrupted,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { name, expected, got } => {
                write!(f, "{name}: expected {expected} elements, got {got}")
            }
            Self::Parameter { name, expected } => write!(f, "{name}: expected {expected}"),
            Self::Interrupted => write!(f, "interrupted"),
        }
    }
}

impl std::error::Error for Error {}

/// Checks the length of a slice.
///
/// # Errors
/// [`Error::Length`] if `got` differs from `expected`.
pub(crate) fn check_length(name: &'static str, expected: usize, got: usize) -> Result<(), Error> {
    if expected == got { Ok(()) } else { Err(Error::Length { name, expected, got }) }
}
