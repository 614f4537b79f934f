//! The root or a bone: one entry a line.

use super::super::{Axis, Bone, Dof, Root};
use crate::error::{Error, Note};
use crate::number;
use crate::text::{decode, quote, words};

const XYZ: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// The root or a bone while its lines are read.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) line: usize,
    pub(super) name: Option<String>,
    direction: Option<[f64; 3]>,
    length: Option<f64>,
    /// Angles of `axis` or `orientation`.
    angles: Option<[f64; 3]>,
    axis_order: Option<[Axis; 3]>,
    position: Option<[f64; 3]>,
    dof: Option<Vec<Dof>>,
    limits: Vec<[f64; 2]>,
    in_limits: bool,
}

impl Draft {
    /// Begins on `line`.
    pub(super) fn new(line: usize) -> Self {
        Self { line, ..Self::default() }
    }

    pub(super) fn describe(&self) -> String {
        match &self.name {
            Some(name) => format!("bone `{name}` (line {})", self.line),
            None => format!("the bone of line {}", self.line),
        }
    }

    /// One line of the root or of a bone.
    pub(super) fn entry(&mut self, line: usize, text: &[u8], notes: &mut Vec<Note>) -> Result<(), Error> {
        let length = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (keyword, rest) = text.split_at(length);
        let rest = rest.trim_ascii();
        if text.starts_with(b"(") {
            if self.in_limits {
                self.limit(line, text, notes);
            }
            return Ok(());
        }
        self.in_limits = false;
        match decode(keyword).to_ascii_lowercase().as_str() {
            "name" => self.name = Some(decode(rest)),
            "direction" => self.direction = Some(three(line, "direction", &mut words(rest))?),
            "length" => {
                let word = words(rest).next().unwrap_or_default();
                self.length = Some(finite(line, "length", word)?);
            }
            "axis" => self.axis(line, rest, notes)?,
            "orientation" => self.angles = Some(three(line, "orientation", &mut words(rest))?),
            "position" => self.position = Some(three(line, "position", &mut words(rest))?),
            "dof" | "order" => self.dof = Some(freedoms(line, rest)?),
            "limits" => {
                self.in_limits = true;
                self.limit(line, rest, notes);
            }
            _ => {}
        }
        Ok(())
    }

    /// `axis 0 0 20 XYZ` of a bone, `axis XYZ` of the root.
    fn axis(&mut self, line: usize, rest: &[u8], notes: &mut Vec<Note>) -> Result<(), Error> {
        let mut words = words(rest).peekable();
        if words.peek().is_some_and(|word| number::parse(word).is_some()) {
            self.angles = Some(three(line, "axis", &mut words)?);
        }
        if let Some(word) = words.next() {
            self.axis_order = Some(Axis::order(&decode(word)).ok_or_else(|| {
                Error::at(line, format!("axis: expected an order such as XYZ, got {}", quote(word)))
            })?);
        } else {
            notes.push(Note::at(line, "axis: no order of the axes: XYZ assumed"));
        }
        Ok(())
    }

    /// Pairs such as `(-160.0 20.0)(-inf inf)`. Limits do not affect the motion: unreadable ones are left out.
    fn limit(&mut self, line: usize, text: &[u8], notes: &mut Vec<Note>) {
        for pair in text.split(|&b| b == b'(').map(<[u8]>::trim_ascii).filter(|pair| !pair.is_empty()) {
            let inside = pair.strip_suffix(b")").unwrap_or(pair);
            let values: Option<Vec<f64>> = words(inside).map(number::parse).collect();
            match values.as_deref() {
                Some(&[low, high]) => self.limits.push([low, high]),
                _ => notes
                    .push(Note::at(line, format!("limits: {} is no pair of numbers: left out", quote(pair)))),
            }
        }
    }

    pub(super) fn root(self, notes: &mut Vec<Note>) -> Root {
        let order = self.dof.unwrap_or_else(|| {
            notes.push(Note::at(self.line, "root: no `order`: TX TY TZ RX RY RZ assumed"));
            vec![Dof::Tx, Dof::Ty, Dof::Tz, Dof::Rx, Dof::Ry, Dof::Rz]
        });
        Root {
            order,
            axis_order: self.axis_order.unwrap_or(XYZ),
            position: self.position.unwrap_or_default(),
            orientation: self.angles.unwrap_or_default(),
        }
    }

    pub(super) fn bone(self, parent: Option<usize>, notes: &mut Vec<Note>) -> Result<Bone, Error> {
        let missing = |what: &str| Error::at(self.line, format!("{} has no `{what}`", self.describe()));
        let name = self.name.clone().filter(|name| !name.is_empty()).ok_or_else(|| missing("name"))?;
        let direction = self.direction.ok_or_else(|| missing("direction"))?;
        let length = self.length.ok_or_else(|| missing("length"))?;
        if self.angles.is_none() {
            notes.push(Note::at(self.line, format!("bone `{name}` has no `axis`: 0 0 0 XYZ assumed")));
        }
        Ok(Bone {
            name,
            parent,
            direction,
            length,
            axis: self.angles.unwrap_or_default(),
            axis_order: self.axis_order.unwrap_or(XYZ),
            dof: self.dof.unwrap_or_default(),
            limits: self.limits,
        })
    }
}

/// The degrees of freedom of a line `dof` or `order`, which may be empty.
fn freedoms(line: usize, rest: &[u8]) -> Result<Vec<Dof>, Error> {
    let mut dof = Vec::new();
    for word in words(rest) {
        let freedom = Dof::from_name(&decode(word)).ok_or_else(|| {
            Error::at(line, format!("expected tx ty tz rx ry rz or l, got {}", quote(word)))
        })?;
        if dof.contains(&freedom) {
            return Err(Error::at(line, format!("degree of freedom {} comes twice", quote(word))));
        }
        dof.push(freedom);
    }
    Ok(dof)
}

fn three<'a>(line: usize, what: &str, words: &mut impl Iterator<Item = &'a [u8]>) -> Result<[f64; 3], Error> {
    let mut values = [0.0; 3];
    for value in &mut values {
        *value = finite(line, what, words.next().unwrap_or_default())?;
    }
    Ok(values)
}

pub(super) fn finite(line: usize, what: &str, word: &[u8]) -> Result<f64, Error> {
    number::parse(word)
        .filter(|value| value.is_finite())
        .ok_or_else(|| Error::at(line, format!("{what}: expected a finite number, got {}", quote(word))))
}
