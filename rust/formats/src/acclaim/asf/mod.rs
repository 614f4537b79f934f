//! The skeleton: sections that begin with a colon.

mod draft;

use super::{AngleUnit, Skeleton, Units};
use crate::error::{Error, Note};
use crate::text::{self, Lines, decode, quote, words};
use draft::{Draft, finite};
use std::collections::HashMap;

/// Reads an ASF skeleton (also under the extension `.asx`).
///
/// Sections and bone entries that do not affect the motion are skipped (`:documentation`, `:skin`, `:namespace`, …).
///
/// # Errors
/// [`Error`] with line and reason if the text is not ASF, a bone is invalid, or the hierarchy is not a tree.
pub fn parse_asf(bytes: &[u8]) -> Result<Skeleton, Error> {
    let mut notes = Vec::new();
    let text = text::open(bytes, &mut notes)?;
    let mut parser = Parser { notes, ..Parser::default() };
    let mut last = 1;
    for (line, text) in Lines::from(text, 0, 1) {
        last = line;
        let text = text.trim_ascii();
        if text.is_empty() || text.starts_with(b"#") {
            continue;
        }
        parser.line(line, text)?;
    }
    parser.finish(last)
}

#[derive(Clone, Copy, PartialEq, Eq, Default)]
enum Section {
    #[default]
    Start,
    Units,
    Root,
    Bones,
    Hierarchy,
    Skipped,
}

#[derive(Default)]
struct Parser {
    section: Section,
    name: String,
    units: Option<Units>,
    root: Option<Draft>,
    bones: Vec<Draft>,
    /// The bone between `begin` and `end`.
    open: Option<Draft>,
    /// Parent of each bone in `:hierarchy`, `None` for the root.
    parents: HashMap<usize, Option<usize>>,
    has_hierarchy: bool,
    notes: Vec<Note>,
}

impl Parser {
    fn line(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        if let Some(keyword) = text.strip_prefix(b":") {
            return self.section(line, keyword);
        }
        match self.section {
            Section::Start => {
                Err(Error::at(line, format!("not ASF: expected `:version`, got {}", quote(text))))
            }
            Section::Units => self.unit(line, text),
            Section::Root => match &mut self.root {
                Some(root) => root.entry(line, text, &mut self.notes),
                None => Ok(()),
            },
            Section::Bones => self.bone(line, text),
            Section::Hierarchy => self.family(line, text),
            Section::Skipped => Ok(()),
        }
    }

    fn section(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        if let Some(bone) = &self.open {
            return Err(Error::at(line, format!("{} has no `end`", bone.describe())));
        }
        let mut words = words(text);
        let keyword = decode(words.next().unwrap_or_default()).to_ascii_lowercase();
        self.section = match keyword.as_str() {
            "name" => {
                self.name = decode(text.get(keyword.len()..).unwrap_or_default().trim_ascii());
                Section::Skipped
            }
            "units" => {
                self.units = Some(NO_UNITS);
                Section::Units
            }
            "root" => {
                self.root = Some(Draft::new(line));
                Section::Root
            }
            "bonedata" => Section::Bones,
            "hierarchy" => {
                self.has_hierarchy = true;
                Section::Hierarchy
            }
            _ => Section::Skipped,
        };
        Ok(())
    }

    fn unit(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        let mut words = words(text);
        let keyword = decode(words.next().unwrap_or_default()).to_ascii_lowercase();
        let value = words.next().unwrap_or_default();
        let units = self.units.get_or_insert(NO_UNITS);
        match keyword.as_str() {
            "mass" => units.mass = positive(line, "mass", value)?,
            "length" => units.length = positive(line, "length", value)?,
            "angle" => {
                units.angle = match decode(value).to_ascii_lowercase().as_str() {
                    "deg" | "degree" | "degrees" => AngleUnit::Degrees,
                    "rad" | "radian" | "radians" => AngleUnit::Radians,
                    _ => {
                        return Err(Error::at(
                            line,
                            format!("angle: expected deg or rad, got {}", quote(value)),
                        ));
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn bone(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        let begins = text.eq_ignore_ascii_case(b"begin");
        let ends = text.eq_ignore_ascii_case(b"end");
        match self.open.as_mut() {
            None if begins => self.open = Some(Draft::new(line)),
            None => return Err(Error::at(line, format!("expected `begin`, got {}", quote(text)))),
            Some(bone) if begins => return Err(Error::at(line, format!("{} has no `end`", bone.describe()))),
            Some(bone) if !ends => return bone.entry(line, text, &mut self.notes),
            Some(_) => self.bones.extend(self.open.take()),
        }
        Ok(())
    }

    /// A line of the hierarchy: a parent and its children.
    fn family(&mut self, line: usize, text: &[u8]) -> Result<(), Error> {
        if text.eq_ignore_ascii_case(b"begin") || text.eq_ignore_ascii_case(b"end") {
            return Ok(());
        }
        let mut names = words(text);
        let parent = match names.next().unwrap_or_default() {
            word if word.eq_ignore_ascii_case(b"root") => None,
            word => Some(self.find(line, word)?),
        };
        for word in names {
            let child = self.find(line, word)?;
            if self.parents.insert(child, parent).is_some() {
                return Err(Error::at(line, format!("bone {} has two parents", quote(word))));
            }
        }
        Ok(())
    }

    fn find(&self, line: usize, word: &[u8]) -> Result<usize, Error> {
        let name = decode(word);
        self.bones
            .iter()
            .position(|bone| bone.name.as_ref() == Some(&name))
            .ok_or_else(|| Error::at(line, format!("bone {} is not in :bonedata", quote(word))))
    }

    fn finish(mut self, last: usize) -> Result<Skeleton, Error> {
        if let Some(bone) = &self.open {
            return Err(Error::at(last, format!("the file ends inside {}", bone.describe())));
        }
        let Some(root) = self.root else { return Err(Error::at(last, "no :root section")) };
        if self.bones.is_empty() {
            return Err(Error::at(last, "no bones: :bonedata is missing or empty"));
        }
        if !self.has_hierarchy {
            return Err(Error::at(last, "no :hierarchy section: which bone hangs on which is unknown"));
        }
        let units = self.units.unwrap_or_else(|| {
            self.notes.push(Note::whole("no :units section: degrees and a length unit of 1 assumed"));
            NO_UNITS
        });
        let root = root.root(&mut self.notes);
        let parents: Vec<Option<usize>> = (0..self.bones.len())
            .map(|bone| {
                self.parents.get(&bone).copied().unwrap_or_else(|| {
                    let draft = &self.bones[bone];
                    self.notes.push(Note::at(
                        draft.line,
                        format!("{} is missing from :hierarchy: attached to the root", draft.describe()),
                    ));
                    None
                })
            })
            .collect();
        let order = parents_first(&parents, &self.bones)?;
        let mut place = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        let mut bones = Vec::with_capacity(order.len());
        let mut drafts: Vec<Option<Draft>> = self.bones.into_iter().map(Some).collect();
        let mut lines = HashMap::new();
        for &old in &order {
            let Some(draft) = drafts[old].take() else { continue };
            let line = draft.line;
            let bone = draft.bone(parents[old].map(|parent| place[parent]), &mut self.notes)?;
            if let Some(other) = lines.insert(bone.name.clone(), line) {
                return Err(Error::at(
                    line,
                    format!("bone `{}` has the name of that of line {other}", bone.name),
                ));
            }
            if bone.name.eq_ignore_ascii_case("root") {
                return Err(Error::at(line, "a bone with the name of the root"));
            }
            bones.push(bone);
        }
        Ok(Skeleton { name: self.name, units, root, bones, notes: self.notes })
    }
}

const NO_UNITS: Units = Units { mass: 1.0, length: 1.0, angle: AngleUnit::Degrees };

/// The bones in order, each after its parent.
fn parents_first(parents: &[Option<usize>], bones: &[Draft]) -> Result<Vec<usize>, Error> {
    let mut order = Vec::with_capacity(parents.len());
    let mut placed = vec![false; parents.len()];
    for bone in 0..parents.len() {
        let mut chain = Vec::new();
        let mut next = Some(bone);
        while let Some(current) = next.filter(|&current| !placed[current]) {
            if chain.len() == parents.len() {
                let bone = &bones[current];
                return Err(Error::at(
                    bone.line,
                    format!("{} hangs on itself in :hierarchy", bone.describe()),
                ));
            }
            chain.push(current);
            next = parents[current];
        }
        for &current in chain.iter().rev() {
            placed[current] = true;
            order.push(current);
        }
    }
    Ok(order)
}

fn positive(line: usize, what: &str, word: &[u8]) -> Result<f64, Error> {
    let value = finite(line, what, word)?;
    if value > 0.0 {
        Ok(value)
    } else {
        Err(Error::at(line, format!("{what}: expected a positive number, got {value}")))
    }
}
