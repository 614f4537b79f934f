//! The rows of values.
//!
//! In most files every line is a row of the right length: these rows are parsed in parallel. All other files are
//! parsed again line by line, for repairs and precise messages.

use super::FrameTime;
use super::hierarchy::Start;
use crate::error::{Error, Note};
use crate::number;
use crate::text::{Lines, decode, is_blank, line_feeds, quote, words};
use rayon::prelude::*;

/// Bytes that a thread parses at a time: large compared with the cost of a task, small compared with a file.
const CHUNK: usize = 1 << 20;

pub(super) struct Motion {
    pub(super) frame_time: FrameTime,
    pub(super) values: Vec<f64>,
    pub(super) frames: usize,
}

pub(super) fn parse(
    text: &[u8],
    start: Start,
    channels: usize,
    notes: &mut Vec<Note>,
) -> Result<Motion, Error> {
    if channels == 0 {
        return Err(Error::at(start.line, "no joint has CHANNELS: there is nothing that moves"));
    }
    let header = header(text, start, notes)?;
    let rows = Rows { text, start: header.rows, channels };
    let notes_before = notes.len();
    let mut values = match rows.in_parallel() {
        Some(values) => values,
        None => rows.line_by_line(header.declared, notes)?,
    };
    let repaired = notes.len() > notes_before;
    let mut frames = values.len() / channels;
    if let Some(declared) = header.declared {
        if frames < declared && frames > 0 && !repaired && !text.last().is_some_and(|&b| is_blank(b)) {
            frames -= 1;
            values.truncate(frames * channels);
            notes.push(Note::whole(format!(
                "the file ends inside row {}, whose last number may have lost digits: dropped",
                frames + 1
            )));
        }
        if frames == 0 && declared > 0 {
            return Err(Error::at(
                header.rows.line,
                format!("no complete row of {channels} values: expected {declared}"),
            ));
        }
        if frames != declared {
            notes.push(Note::whole(format!(
                "`Frames:` says {declared}, the file has {frames}: these are kept"
            )));
        }
    } else if frames == 0 {
        return Err(Error::at(header.rows.line, format!("no complete row of {channels} values")));
    } else {
        notes.push(Note::at(start.line, format!("no number of `Frames:`: the file has {frames}")));
    }
    note_missing(&mut values, &rows, notes);
    Ok(Motion { frame_time: header.frame_time, values, frames })
}

struct Header {
    declared: Option<usize>,
    frame_time: FrameTime,
    rows: Start,
}

fn header(text: &[u8], start: Start, notes: &mut Vec<Note>) -> Result<Header, Error> {
    let mut lines = Lines::from(text, start.offset, start.line);
    let mut declared = None;
    let mut frame_time = None;
    let mut rows = Start { offset: start.offset, line: start.line };
    while let Some((number, line)) = lines.next() {
        let line = line.trim_ascii();
        if let Some(text) = after_keyword(line, b"frames") {
            declared = count(text);
        } else if let Some(text) =
            after_keyword(line, b"frame time").or_else(|| after_keyword(line, b"frametime"))
        {
            frame_time = Some((number, words(text).next().unwrap_or_default()));
        } else if line
            .first()
            .is_some_and(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'n' | b'N' | b'i' | b'I'))
        {
            break;
        } else if !line.is_empty() && line != b"\x1a" {
            return Err(Error::at(
                number,
                format!("expected `Frames:`, `Frame Time:` or a row of values, got {}", quote(line)),
            ));
        }
        rows = Start { offset: lines.start(), line: number + 1 };
    }
    let frame_time = read_frame_time(frame_time, start.line, notes);
    Ok(Header { declared, frame_time, rows })
}

/// The frame time of `line`; 1/30 s if there is none or it is not a duration.
fn read_frame_time(found: Option<(usize, &[u8])>, start: usize, notes: &mut Vec<Note>) -> FrameTime {
    let Some((line, text)) = found else {
        notes.push(Note::at(start, "`Frame Time:` missing: 1/30 s assumed"));
        return FrameTime::new(FrameTime::ASSUMED);
    };
    if let Some(seconds) = number::parse(text).filter(|seconds| seconds.is_finite() && *seconds > 0.0) {
        return FrameTime { seconds, text: decode(text) };
    }
    notes.push(Note::at(line, format!("`Frame Time:` {} is no duration: 1/30 s assumed", quote(text))));
    FrameTime::new(FrameTime::ASSUMED)
}

/// The text after a keyword, with or without its colon, in upper or lower case.
fn after_keyword<'a>(line: &'a [u8], keyword: &[u8]) -> Option<&'a [u8]> {
    let (word, rest) = line.split_at_checked(keyword.len())?;
    let ends = rest.first().is_none_or(|&b| b == b':' || is_blank(b));
    (ends && word.eq_ignore_ascii_case(keyword)).then(|| {
        let rest = rest.trim_ascii_start();
        rest.strip_prefix(b":").unwrap_or(rest).trim_ascii()
    })
}

/// A number of frames, also written as `75.0`.
fn count(text: &[u8]) -> Option<usize> {
    let text = decode(text);
    let (whole, zeros) = text.split_once('.').unwrap_or((&text, ""));
    if zeros.bytes().all(|b| b == b'0') { whole.parse().ok() } else { None }
}

/// The text from the first row on.
struct Rows<'a> {
    text: &'a [u8],
    start: Start,
    channels: usize,
}

impl Rows<'_> {
    fn body(&self) -> &[u8] {
        self.text.get(self.start.offset..).unwrap_or_default()
    }

    /// All values if every line is a row of the right length; `None` otherwise.
    fn in_parallel(&self) -> Option<Vec<f64>> {
        let body = self.body().trim_ascii_end();
        if body.is_empty() {
            return None;
        }
        let chunks = chunks(body);
        let count_rows = |chunk: &[u8]| line_feeds(chunk) + usize::from(chunk.last() != Some(&b'\n'));
        let parallel = rayon::current_thread_index().is_some();
        let counts: Vec<usize> = if parallel {
            chunks.par_iter().map(|chunk| count_rows(chunk)).collect()
        } else {
            chunks.iter().map(|chunk| count_rows(chunk)).collect()
        };
        let total = counts.iter().sum::<usize>().checked_mul(self.channels)?;
        // A value takes at least two bytes: lines that are not rows must not cause a larger allocation.
        if total > body.len() / 2 + 1 {
            return None;
        }
        let mut values = vec![0.0; total];
        let mut rest = values.as_mut_slice();
        let mut tasks = Vec::with_capacity(chunks.len());
        for (chunk, count) in chunks.into_iter().zip(counts) {
            let (places, others) = rest.split_at_mut(count * self.channels);
            tasks.push((chunk, places));
            rest = others;
        }
        let fill = |(chunk, places): (&[u8], &mut [f64])| fill_rows(chunk, places, self.channels);
        let regular = if parallel { tasks.into_par_iter().all(fill) } else { tasks.into_iter().all(fill) };
        regular.then_some(values)
    }

    /// All values, without an incomplete last row; an error for anything else.
    fn line_by_line(&self, declared: Option<usize>, notes: &mut Vec<Note>) -> Result<Vec<f64>, Error> {
        let mut values = Vec::with_capacity(self.body().len() / 16);
        let mut lines = Lines::from(self.text, self.start.offset, self.start.line);
        while let Some((number, line)) = lines.next() {
            if line.trim_ascii() == b"\x1a" && lines.rest_is_blank() {
                break;
            }
            let before = values.len();
            let unreadable = words(line).find(|word| match number::parse(word) {
                Some(value) => {
                    values.push(value);
                    false
                }
                None => true,
            });
            let count = values.len() - before;
            if unreadable.is_none() && (count == 0 || count == self.channels) {
                continue;
            }
            let problem = match unreadable {
                Some(word) => format!("expected a number, got {}", quote(word)),
                None => format!("expected {} values in a row, got {count}", self.channels),
            };
            if lines.rest_is_blank() && count < self.channels && before > 0 {
                values.truncate(before);
                notes.push(Note::at(number, format!("last row cut short ({problem}): dropped")));
                break;
            }
            if unreadable.is_none()
                && let Some(values) = self.wrapped(declared)
            {
                notes.push(Note::at(
                    number,
                    format!("lines are not rows ({problem}): values are taken one after the other, they fit `Frames:`"),
                ));
                return Ok(values);
            }
            return Err(Error::at(number, problem));
        }
        Ok(values)
    }

    /// All values if their number agrees with `Frames:`, for any line breaks.
    fn wrapped(&self, declared: Option<usize>) -> Option<Vec<f64>> {
        let expected = declared?.checked_mul(self.channels)?;
        if expected > self.body().len() / 2 + 1 {
            return None;
        }
        let values: Vec<f64> = words(self.body()).map_while(number::parse).take(expected + 1).collect();
        let count = words(self.body()).take(expected + 1).count();
        (values.len() == expected && count == expected).then_some(values)
    }
}

/// Splits at line ends into pieces of about [`CHUNK`] bytes.
fn chunks(mut body: &[u8]) -> Vec<&[u8]> {
    let mut chunks = Vec::with_capacity(body.len() / CHUNK + 1);
    while !body.is_empty() {
        let line_feed = body.get(CHUNK..).and_then(|rest| rest.iter().position(|&b| b == b'\n'));
        let length = line_feed.map_or(body.len(), |at| CHUNK + at + 1);
        let (chunk, rest) = body.split_at(length);
        chunks.push(chunk);
        body = rest;
    }
    chunks
}

/// Parses lines into `places`; returns whether each of them was a row of `channels` values.
fn fill_rows(chunk: &[u8], places: &mut [f64], channels: usize) -> bool {
    let mut rest = chunk;
    for row in places.chunks_exact_mut(channels) {
        for place in row {
            rest = skip_blanks(rest);
            let Some((value, length)) = number::scan(rest) else { return false };
            *place = value;
            rest = &rest[length..];
        }
        rest = skip_blanks(rest);
        match rest.split_first() {
            Some((b'\n', next)) => rest = next,
            Some(_) => return false,
            None => {}
        }
    }
    rest.is_empty()
}

/// Skips blanks inside a line.
#[inline]
fn skip_blanks(mut rest: &[u8]) -> &[u8] {
    while let [b' ' | b'\t' | b'\r' | 0x0b | 0x0c, next @ ..] = rest {
        rest = next;
    }
    rest
}

/// Replaces infinities by NaN, and notes the number of missing samples.
fn note_missing(values: &mut [f64], rows: &Rows<'_>, notes: &mut Vec<Note>) {
    let mut missing = 0;
    for value in values.iter_mut().filter(|value| !value.is_finite()) {
        *value = f64::NAN;
        missing += 1;
    }
    if missing > 0 {
        let is_missing = |word| number::parse(word).is_some_and(|value| !value.is_finite());
        let line = Lines::from(rows.text, rows.start.offset, rows.start.line)
            .find_map(|(number, line)| words(line).any(is_missing).then_some(number));
        let values = if missing == 1 { "1 value is" } else { &format!("{missing} values are") };
        notes.push(Note { line, text: format!("{values} not a number: kept as missing samples") });
    }
}
