//! Bytes to lines and names: line ends of every kind, byte-order marks, UTF-8 or Latin-1.

use crate::error::{Error, Note};

/// Number of bytes inspected to distinguish text from binary files.
const SNIFFED: usize = 8192;
const BOM: &[u8] = b"\xEF\xBB\xBF";

/// Rejects binary files, and skips a byte-order mark.
pub(crate) fn open<'a>(bytes: &'a [u8], notes: &mut Vec<Note>) -> Result<&'a [u8], Error> {
    if bytes.is_empty() {
        return Err(Error::whole("the file is empty"));
    }
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(Error::at(1, "the text is UTF-16: expected ASCII or UTF-8"));
    }
    let text = bytes.strip_prefix(BOM).unwrap_or(bytes);
    if text.len() < bytes.len() {
        notes.push(Note::at(1, "byte-order mark skipped"));
    }
    let sniffed = text.get(..SNIFFED).unwrap_or(text);
    if let Some(at) = sniffed.iter().position(|&b| is_binary(b)) {
        return Err(Error::at(
            line_of(sniffed, at),
            format!("binary data (byte 0x{:02x}): expected text", sniffed[at]),
        ));
    }
    if text.iter().all(u8::is_ascii_whitespace) {
        return Err(Error::whole("the file holds nothing but blanks"));
    }
    Ok(text)
}

/// Control characters that do not occur in text; 0x1a is the end-of-file mark of old DOS editors.
fn is_binary(byte: u8) -> bool {
    byte < 0x20 && !matches!(byte, b'\t' | b'\n' | 0x0b | 0x0c | b'\r' | 0x1a)
}

/// Blanks and line ends.
#[inline]
pub(crate) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | 0x0b | 0x0c | b'\r')
}

/// The line, counted from 1, of the byte at `offset`.
pub(crate) fn line_of(text: &[u8], offset: usize) -> usize {
    let before = text.get(..offset).unwrap_or(text);
    let lone_returns =
        before.iter().enumerate().filter(|&(i, &b)| b == b'\r' && text.get(i + 1) != Some(&b'\n')).count();
    1 + line_feeds(before) + lone_returns
}

/// Number of line feeds; a sum, which the compiler turns into vector code.
pub(crate) fn line_feeds(text: &[u8]) -> usize {
    text.iter().map(|&b| usize::from(b == b'\n')).sum()
}

/// Iterates over the lines of a text: ended by LF, CRLF or CR, in any mixture, without their ends.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    text: &'a [u8],
    start: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    /// Starts at byte `start`, which is on line `number`.
    pub(crate) fn from(text: &'a [u8], start: usize, number: usize) -> Self {
        Self { text, start, number }
    }

    /// Byte at which the next line starts.
    pub(crate) fn start(&self) -> usize {
        self.start
    }

    /// Whether only blanks remain.
    pub(crate) fn rest_is_blank(&self) -> bool {
        self.text.get(self.start..).is_none_or(|rest| rest.iter().all(|&b| is_blank(b)))
    }
}

impl<'a> Iterator for Lines<'a> {
    /// Line number and text.
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.text.get(self.start..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        let number = self.number;
        self.start += length + end;
        self.number += 1;
        Some((number, &rest[..length]))
    }
}

/// The words of a line.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|&b| is_blank(b)).filter(|word| !word.is_empty())
}

/// Text of a name: UTF-8, or else Latin-1, in which every byte is a character.
pub(crate) fn decode(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes)
        .map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect(), ToOwned::to_owned)
}

/// A part of a file for a message: short, and without control characters.
pub(crate) fn quote(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = decode(bytes.trim_ascii());
    let mut shown: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    format!("`{shown}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_every_way() {
        let lines: Vec<_> = Lines::from(b"a\r\nb\n\rc\r\r\nd", 0, 1).collect();
        let expected: Vec<(usize, &[u8])> =
            vec![(1, b"a"), (2, b"b"), (3, b""), (4, b"c"), (5, b""), (6, b"d")];
        assert_eq!(lines, expected);
        assert_eq!(line_of(b"a\r\nb\n\rc\r\r\nd", 10), 6);
    }

    #[test]
    fn what_is_not_text_is_refused() {
        let mut notes = Vec::new();
        assert!(open(b"", &mut notes).unwrap_err().reason.contains("empty"));
        assert!(open(b" \r\n\t", &mut notes).unwrap_err().reason.contains("blanks"));
        assert!(open(b"\xFF\xFEH\0", &mut notes).unwrap_err().reason.contains("UTF-16"));
        let binary = open(b"PK\n\x03\x04", &mut notes).unwrap_err();
        assert_eq!(binary.line, Some(2));
        assert!(notes.is_empty());
        assert_eq!(open(b"\xEF\xBB\xBFx", &mut notes).unwrap(), b"x");
        assert_eq!(notes.len(), 1);
    }

    #[test]
    fn names_that_are_not_utf8_are_latin1() {
        assert_eq!(decode(b"H\xFCfte"), "Hüfte");
        assert_eq!(decode("Hüfte".as_bytes()), "Hüfte");
        assert_eq!(quote(b"  a\x07b \r"), "`a\u{fffd}b`");
    }
}
