//! The motion: for each frame its number, then one line of values per bone.

use super::{AngleUnit, Motion, Skeleton};
use crate::error::{Error, Note};
use crate::number;
use crate::text::{self, Lines, decode, is_blank, quote, words};
use std::collections::HashMap;
use std::ops::Range;

/// Reads an AMC motion of `skeleton`.
///
/// The values are in the order of the skeleton, for any order of the lines. An incomplete last frame is dropped. A
/// bone that a frame omits is missing there (NaN); a bone that all frames omit is in its rest pose (zeros).
///
/// Cost: one pass over the text; memory is eight bytes per value.
///
/// # Errors
/// [`Error`] with line and reason if the text is not AMC, a bone is not in the skeleton, or the number of its values
/// differs from its degrees of freedom.
pub fn parse_amc(bytes: &[u8], skeleton: &Skeleton) -> Result<Motion, Error> {
    let mut notes = Vec::new();
    let text = text::open(bytes, &mut notes)?;
    let mut parser = Parser::new(skeleton, notes);
    let mut lines = Lines::from(text, 0, 1);
    let mut cut = None;
    while let Some((line, text)) = lines.next() {
        let text = text.trim_ascii();
        if text.is_empty() || text.starts_with(b"#") || text == b"\x1a" {
            continue;
        }
        match parser.line(line, text) {
            Err(error) if lines.rest_is_blank() && parser.frames > 1 => cut = Some(error.reason),
            result => result?,
        }
    }
    parser.drop_cut_frame(cut);
    parser.finish()
}

struct Parser<'a> {
    /// The root, then the bones of the skeleton.
    tracks: Vec<Track<'a>>,
    by_name: HashMap<&'a [u8], usize>,
    /// Values in a frame.
    width: usize,
    values: Vec<f64>,
    frames: usize,
    /// Line and number of the current frame.
    current: (usize, u64),
    /// The track of the last line.
    last: usize,
    /// From `:DEGREES` or `:RADIANS`, else from the skeleton.
    angle: AngleUnit,
    has_angle: bool,
    /// First jump in the frame numbers, and the number of jumps.
    leap: Option<(usize, String)>,
    leaps: usize,
    /// First line with a value that is not a number, and the number of such values.
    missing: Option<usize>,
    missing_count: usize,
    notes: Vec<Note>,
}

struct Track<'a> {
    name: &'a str,
    columns: Range<usize>,
    /// Number of frames that contain it.
    count: usize,
    /// The last frame that contains it, counted from 1; 0 for none.
    frame: usize,
    /// The track that followed it in the previous frame: files keep their order.
    next: usize,
}

impl<'a> Parser<'a> {
    fn new(skeleton: &'a Skeleton, notes: Vec<Note>) -> Self {
        let bones = skeleton.bones.iter().map(|bone| (bone.name.as_str(), bone.dof.len()));
        let mut tracks = Vec::with_capacity(skeleton.bones.len() + 1);
        let mut end = 0;
        for (name, freedoms) in std::iter::once(("root", skeleton.root.order.len())).chain(bones) {
            let next = tracks.len() + 1;
            tracks.push(Track { name, columns: end..end + freedoms, count: 0, frame: 0, next });
            end += freedoms;
        }
        Self {
            by_name: tracks.iter().enumerate().map(|(index, track)| (track.name.as_bytes(), index)).collect(),
            tracks,
            width: end,
            values: Vec::new(),
            frames: 0,
            current: (0, 0),
            last: 0,
            angle: skeleton.units.angle,
            has_angle: false,
            leap: None,
            leaps: 0,
            missing: None,
            missing_count: 0,
            notes,
        }
    }

    fn line(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        let length = text.iter().position(|&b| is_blank(b)).unwrap_or(text.len());
        let (word, values) = text.split_at(length);
        if let Some(keyword) = word.strip_prefix(b":") {
            return self.keyword(line, keyword);
        }
        if values.is_empty() && word.iter().all(u8::is_ascii_digit) {
            return self.begin_frame(line, word);
        }
        if self.frames == 0 {
            return Err(Error::at(
                line,
                format!("not AMC: expected the number of a frame, got {}", quote(text)),
            ));
        }
        let track = self
            .find(word)
            .ok_or_else(|| Error::at(line, format!("bone {} is not in the skeleton", quote(word))))?;
        self.fill(line, track, values)
    }

    fn keyword(&mut self, line: usize, keyword: &[u8]) -> Result<(), Error> {
        if self.frames > 0 {
            return Err(Error::at(line, format!("expected a bone or a frame, got `:{}`", decode(keyword))));
        }
        let angle = match decode(keyword).to_ascii_uppercase().as_str() {
            "DEGREES" => AngleUnit::Degrees,
            "RADIANS" => AngleUnit::Radians,
            _ => return Ok(()),
        };
        self.angle = angle;
        self.has_angle = true;
        Ok(())
    }

    fn begin_frame(&mut self, line: usize, word: &[u8]) -> Result<(), Error> {
        let number = decode(word)
            .parse::<u64>()
            .map_err(|_| Error::at(line, format!("expected the number of a frame, got {}", quote(word))))?;
        let (before, expected) = (self.current.1, self.current.1.saturating_add(1));
        if self.frames > 0 && number != expected {
            self.leap.get_or_insert_with(|| (line, format!("frame {number} follows frame {before}")));
            self.leaps += 1;
        }
        self.current = (line, number);
        self.frames += 1;
        self.values.resize(self.frames * self.width, f64::NAN);
        Ok(())
    }

    fn find(&mut self, word: &[u8]) -> Option<usize> {
        let expected = self.tracks[self.last].next;
        let found = if self.tracks.get(expected).is_some_and(|track| track.name.as_bytes() == word) {
            expected
        } else {
            let root = word.eq_ignore_ascii_case(b"root").then_some(0);
            self.by_name.get(word).copied().or(root)?
        };
        self.tracks[self.last].next = found;
        self.last = found;
        Some(found)
    }

    fn fill(&mut self, line: usize, track: usize, text: &[u8]) -> Result<(), Error> {
        let track = &mut self.tracks[track];
        let expected = track.columns.len();
        let start = (self.frames - 1) * self.width + track.columns.start;
        let places = &mut self.values[start..start + expected];
        if track.frame == self.frames {
            return Err(Error::at(
                line,
                format!("bone `{}` comes twice in frame {}", track.name, self.current.1),
            ));
        }
        let mut got = 0;
        let mut at_rest = true;
        for word in words(text) {
            let Some(value) = number::parse(word) else {
                return Err(Error::at(
                    line,
                    format!("`{}`: expected a number, got {}", track.name, quote(word)),
                ));
            };
            if !value.is_finite() {
                self.missing.get_or_insert(line);
                self.missing_count += 1;
            }
            if let Some(place) = places.get_mut(got) {
                *place = if value.is_finite() { value } else { f64::NAN };
            }
            at_rest &= value == 0.0;
            got += 1;
        }
        // Some files list bones without degrees of freedom anyway, with zeros.
        if got != expected && !(expected == 0 && at_rest) {
            return Err(Error::at(line, format!("`{}`: expected {expected} values, got {got}", track.name)));
        }
        track.frame = self.frames;
        track.count += 1;
        Ok(())
    }

    /// Drops a last frame whose last line is incomplete, or which lacks bones that other frames have.
    fn drop_cut_frame(&mut self, reason: Option<String>) {
        let lacking = self
            .tracks
            .iter()
            .find(|track| !track.columns.is_empty() && track.count > 0 && track.frame < self.frames);
        let reason = reason.or_else(|| lacking.map(|track| format!("bone `{}` is missing", track.name)));
        if let Some(reason) = reason.filter(|_| self.frames > 1) {
            let (line, number) = self.current;
            self.notes.push(Note::at(line, format!("last frame {number} is cut short ({reason}): dropped")));
            for track in self.tracks.iter_mut().filter(|track| track.frame == self.frames) {
                track.count -= 1;
            }
            self.frames -= 1;
            self.values.truncate(self.frames * self.width);
        }
    }

    fn finish(mut self) -> Result<Motion, Error> {
        if self.tracks.iter().all(|track| track.count == 0) {
            return Err(Error::whole("no frame has values"));
        }
        if !self.has_angle {
            let unit = if self.angle == AngleUnit::Degrees { "degrees" } else { "radians" };
            self.notes.push(Note::whole(format!(
                "neither :DEGREES nor :RADIANS: {unit} assumed, as in the skeleton"
            )));
        }
        if let Some((line, text)) = self.leap {
            let leaps = self.leaps;
            self.notes.push(Note::at(line, format!("{text} ({leaps} such): kept as neighbours in time")));
        }
        if let Some(line) = self.missing {
            let count = self.missing_count;
            self.notes.push(Note::at(
                line,
                format!("values that are no numbers ({count} such): kept as missing samples"),
            ));
        }
        for track in self.tracks.iter().filter(|track| track.count < self.frames && !track.columns.is_empty())
        {
            let name = track.name;
            if track.count == 0 {
                self.notes.push(Note::whole(format!("bone `{name}` is in no frame: kept at rest")));
                for frame in self.values.chunks_exact_mut(self.width) {
                    frame[track.columns.clone()].fill(0.0);
                }
            } else {
                let lacking = self.frames - track.count;
                self.notes.push(Note::whole(format!(
                    "bone `{name}` is missing in {lacking} frames: missing samples"
                )));
            }
        }
        Ok(Motion { values: self.values, frames: self.frames, angle: self.angle, notes: self.notes })
    }
}
