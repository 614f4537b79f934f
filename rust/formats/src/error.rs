//! Errors and notes about a file.

use std::fmt;

/// Why a file was rejected. The caller adds the path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// Line of the file, counted from 1; `None` for the whole file.
    pub line: Option<usize>,
    /// The reason, one line of text.
    pub reason: String,
}

impl Error {
    pub(crate) fn at(line: usize, reason: impl Into<String>) -> Self {
        Self { line: Some(line), reason: reason.into() }
    }

    pub(crate) fn whole(reason: impl Into<String>) -> Self {
        Self { line: None, reason: reason.into() }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        located(f, self.line, &self.reason)
    }
}

impl std::error::Error for Error {}

/// A repair or an assumption of a reader. A file without notes was read literally.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Line of the file, counted from 1; `None` for the whole file.
    pub line: Option<usize>,
    /// The problem and its repair, one line of text.
    pub text: String,
}

impl Note {
    pub(crate) fn at(line: usize, text: impl Into<String>) -> Self {
        Self { line: Some(line), text: text.into() }
    }

    pub(crate) fn whole(text: impl Into<String>) -> Self {
        Self { line: None, text: text.into() }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        located(f, self.line, &self.text)
    }
}

fn located(f: &mut fmt::Formatter<'_>, line: Option<usize>, text: &str) -> fmt::Result {
    match line {
        Some(line) => write!(f, "line {line}: {text}"),
        None => f.write_str(text),
    }
}
