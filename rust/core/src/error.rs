//! The one error type of the core: what memory safety and cancellation need. What a user meant is checked above.

use std::fmt;

/// Why a kernel refused its arguments or stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// A slice has another length than the shapes say.
    Length {
        /// The argument.
        name: &'static str,
        /// How many elements the shapes ask for.
        expected: usize,
        /// How many came.
        got: usize,
    },
    /// A parameter lies outside what the kernel can compute with.
    Parameter {
        /// The argument.
        name: &'static str,
        /// What was expected.
        expected: &'static str,
    },
    /// The caller asked the kernel to stop.
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

/// Refuses a slice of another length than the shapes say.
///
/// # Errors
/// [`Error::Length`] if `got` differs from `expected`.
pub(crate) fn check_length(name: &'static str, expected: usize, got: usize) -> Result<(), Error> {
    if expected == got { Ok(()) } else { Err(Error::Length { name, expected, got }) }
}
