//! The tree of joints, up to the word `MOTION`.

use super::{Channel, EndSite, Joint};
use crate::error::{Error, Note};
use crate::text::{decode, is_blank, quote};
use crate::{number, text};
use std::collections::HashMap;

/// Start of the motion: after the word `MOTION`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) offset: usize,
    pub(super) line: usize,
}

pub(super) fn parse(text: &[u8], notes: &mut Vec<Note>) -> Result<(Vec<Joint>, Start), Error> {
    let mut cursor = Cursor { text, offset: 0, line: 1 };
    let mut tree = Tree::default();
    match cursor.peek() {
        word if word.eq_ignore_ascii_case(b"HIERARCHY") => _ = cursor.word(),
        word if word.eq_ignore_ascii_case(b"ROOT") => {
            notes.push(Note::at(cursor.line, "HIERARCHY missing: the file starts with a root"));
        }
        word if word.eq_ignore_ascii_case(b"MOTION") => {
            return Err(Error::at(
                cursor.line,
                "MOTION without a HIERARCHY before it: the file has no skeleton",
            ));
        }
        word => {
            return Err(Error::at(cursor.line, format!("not BVH: expected HIERARCHY, got {}", quote(word))));
        }
    }
    loop {
        let word = cursor.word();
        let line = cursor.line;
        if word.is_empty() {
            return Err(tree.cut_off(line));
        } else if word.eq_ignore_ascii_case(b"ROOT") {
            if let Some(open) = tree.open.last() {
                return Err(Error::at(
                    line,
                    format!("ROOT inside {}: a `}}` is missing", tree.describe(*open)),
                ));
            }
            tree.add_joint(&mut cursor, None)?;
        } else if word.eq_ignore_ascii_case(b"JOINT") {
            let parent = tree.innermost(line, "JOINT")?;
            tree.add_joint(&mut cursor, Some(parent))?;
        } else if word.eq_ignore_ascii_case(b"End") {
            let joint = tree.innermost(line, "End Site")?;
            let site = end_site(&mut cursor, notes)?;
            tree.joints[joint].end_sites.push(site);
        } else if word.eq_ignore_ascii_case(b"OFFSET") {
            let joint = tree.innermost(line, "OFFSET")?;
            if std::mem::replace(&mut tree.placed[joint], true) {
                return Err(Error::at(line, format!("second OFFSET in {}", tree.describe(joint))));
            }
            tree.joints[joint].offset = offset(&mut cursor)?;
        } else if word.eq_ignore_ascii_case(b"CHANNELS") {
            let joint = tree.innermost(line, "CHANNELS")?;
            if !tree.joints[joint].channels.is_empty() {
                return Err(Error::at(line, format!("second CHANNELS in {}", tree.describe(joint))));
            }
            tree.joints[joint].channels = channels(&mut cursor)?;
        } else if word == b"}" {
            let joint = tree.innermost(line, "`}`")?;
            if !tree.placed[joint] {
                notes.push(Note::at(
                    line,
                    format!("OFFSET missing in {}: 0 0 0 assumed", tree.describe(joint)),
                ));
            }
            tree.open.pop();
        } else if word.eq_ignore_ascii_case(b"MOTION") {
            if let Some(open) = tree.open.last() {
                return Err(Error::at(
                    line,
                    format!("MOTION inside {}: a `}}` is missing", tree.describe(*open)),
                ));
            }
            if tree.joints.is_empty() {
                return Err(Error::at(line, "MOTION without a ROOT before it: the file has no skeleton"));
            }
            tree.note_equal_names(notes);
            return Ok((tree.joints, Start { offset: cursor.offset, line }));
        } else {
            return Err(Error::at(
                line,
                format!("expected JOINT, End Site, OFFSET, CHANNELS, `}}` or MOTION, got {}", quote(word)),
            ));
        }
    }
}

/// Joints read so far.
#[derive(Default)]
struct Tree {
    joints: Vec<Joint>,
    /// Line on which each joint begins.
    lines: Vec<usize>,
    /// Whether its OFFSET has been read.
    placed: Vec<bool>,
    /// Joints whose brace is open, the innermost last.
    open: Vec<usize>,
}

impl Tree {
    fn add_joint(&mut self, cursor: &mut Cursor<'_>, parent: Option<usize>) -> Result<(), Error> {
        let line = cursor.line;
        let name = cursor.name();
        if name.is_empty() {
            return Err(Error::at(line, "a joint without a name"));
        }
        cursor.brace(&name)?;
        self.open.push(self.joints.len());
        self.joints.push(Joint { name, parent, ..Joint::default() });
        self.lines.push(line);
        self.placed.push(false);
        Ok(())
    }

    fn innermost(&self, line: usize, what: &str) -> Result<usize, Error> {
        self.open.last().copied().ok_or_else(|| Error::at(line, format!("{what} outside of a ROOT")))
    }

    fn describe(&self, joint: usize) -> String {
        format!("joint `{}` (line {})", self.joints[joint].name, self.lines[joint])
    }

    fn cut_off(&self, line: usize) -> Error {
        match self.open.last() {
            Some(&open) => Error::at(line, format!("the file ends inside {}", self.describe(open))),
            None => Error::at(line, "the file ends before MOTION"),
        }
    }

    fn note_equal_names(&self, notes: &mut Vec<Note>) {
        let mut first = HashMap::new();
        for (joint, &line) in self.joints.iter().zip(&self.lines) {
            if let Some(other) = first.insert(&joint.name, line) {
                notes.push(Note::at(
                    line,
                    format!("joint `{}` has the name of that of line {other}", joint.name),
                ));
            }
        }
    }
}

fn end_site(cursor: &mut Cursor<'_>, notes: &mut Vec<Note>) -> Result<EndSite, Error> {
    let line = cursor.line;
    let word = cursor.word();
    if !word.eq_ignore_ascii_case(b"Site") {
        return Err(Error::at(line, format!("expected End Site, got End {}", quote(word))));
    }
    let name = Some(cursor.name()).filter(|name| !name.is_empty());
    cursor.brace("End Site")?;
    let mut site = EndSite { name, offset: [0.0; 3] };
    if cursor.peek().eq_ignore_ascii_case(b"OFFSET") {
        cursor.word();
        site.offset = offset(cursor)?;
    } else {
        notes.push(Note::at(line, "OFFSET missing in End Site: 0 0 0 assumed"));
    }
    match cursor.word() {
        b"}" => Ok(site),
        b"" => Err(Error::at(cursor.line, format!("the file ends inside the End Site of line {line}"))),
        word => Err(Error::at(cursor.line, format!("expected `}}` after End Site, got {}", quote(word)))),
    }
}

fn offset(cursor: &mut Cursor<'_>) -> Result<[f64; 3], Error> {
    let mut offset = [0.0; 3];
    for value in &mut offset {
        let word = cursor.word();
        *value = number::parse(word).filter(|value| value.is_finite()).ok_or_else(|| {
            Error::at(cursor.line, format!("OFFSET: expected three finite numbers, got {}", quote(word)))
        })?;
    }
    Ok(offset)
}

fn channels(cursor: &mut Cursor<'_>) -> Result<Vec<Channel>, Error> {
    let word = cursor.word();
    let count: usize = decode(word).parse().map_err(|_| {
        Error::at(cursor.line, format!("CHANNELS: expected their number, got {}", quote(word)))
    })?;
    if count > Channel::ALL.len() {
        return Err(Error::at(cursor.line, format!("CHANNELS: expected at most 6, got {count}")));
    }
    let mut channels = Vec::with_capacity(count);
    for _ in 0..count {
        let word = cursor.word();
        let channel = Channel::from_name(&decode(word)).ok_or_else(|| {
            let got = quote(word);
            Error::at(
                cursor.line,
                format!("CHANNELS: expected {count} like Xposition or Zrotation, got {got}"),
            )
        })?;
        if channels.contains(&channel) {
            return Err(Error::at(cursor.line, format!("CHANNELS: {} comes twice", channel.name())));
        }
        channels.push(channel);
    }
    Ok(channels)
}

/// Iterates over words; braces are always separate words.
struct Cursor<'a> {
    text: &'a [u8],
    offset: usize,
    line: usize,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        self.text.get(self.offset..).unwrap_or_default()
    }

    /// Skips blanks and line ends.
    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.text.get(self.offset) {
            if !is_blank(byte) {
                break;
            }
            self.offset += 1;
            let ends_line = byte == b'\n' || (byte == b'\r' && self.text.get(self.offset) != Some(&b'\n'));
            self.line += usize::from(ends_line);
        }
    }

    /// The next word, without advancing; empty at the end of the file.
    fn peek(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let rest = self.rest();
        let length = match rest.first() {
            Some(b'{' | b'}') => 1,
            _ => rest.iter().position(|&b| is_blank(b) || b == b'{' || b == b'}').unwrap_or(rest.len()),
        };
        &rest[..length]
    }

    /// The next word.
    fn word(&mut self) -> &'a [u8] {
        let word = self.peek();
        self.offset += word.len();
        word
    }

    /// The rest of the line up to a brace: names may contain blanks.
    fn name(&mut self) -> String {
        let rest = self.rest();
        let length = rest.iter().position(|&b| matches!(b, b'\n' | b'\r' | b'{')).unwrap_or(rest.len());
        self.offset += length;
        text::decode(rest[..length].trim_ascii())
    }

    fn brace(&mut self, after: &str) -> Result<(), Error> {
        match self.word() {
            b"{" => Ok(()),
            b"" => Err(Error::at(self.line, format!("the file ends after `{after}`"))),
            word => Err(Error::at(self.line, format!("expected `{{` after `{after}`, got {}", quote(word)))),
        }
    }
}
