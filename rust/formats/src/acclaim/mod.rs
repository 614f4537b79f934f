//! Acclaim files: a skeleton (`.asf`) and its motions (`.amc`).
//!
//! [`parse_asf`] reads the bones, [`parse_amc`] the values of their degrees of freedom. Both return the contents of
//! the files in the files' units: [`Units::angle`] for the axes of a skeleton, [`Motion::angle`] for the angles of a
//! motion.

mod amc;
mod asf;

use crate::error::Note;

pub use amc::parse_amc;
pub use asf::parse_asf;

/// A skeleton, as an ASF file describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    /// The `:name` entry; may be empty.
    pub name: String,
    /// Units of lengths and angles.
    pub units: Units,
    /// The root.
    pub root: Root,
    /// The bones in the order of `:bonedata`, except that each comes after its parent.
    pub bones: Vec<Bone>,
    /// Repairs and assumptions.
    pub notes: Vec<Note>,
}

impl Skeleton {
    /// Number of values in a frame of a motion: the degrees of freedom of the root, then of the bones.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.root.order.len() + self.bones.iter().map(|bone| bone.dof.len()).sum::<usize>()
    }
}

/// Units of a skeleton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Factor of masses.
    pub mass: f64,
    /// Factor of lengths: one unit of the file is `1 / length` inches in the files of CMU, where it is 0.45.
    pub length: f64,
    /// Unit of the angles in the skeleton.
    pub angle: AngleUnit,
}

/// Unit of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Degrees,
    /// Radians.
    Radians,
}

/// The root of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct Root {
    /// Its degrees of freedom in the order of their values.
    pub order: Vec<Dof>,
    /// Order of the axes of `orientation`: the first applies first.
    pub axis_order: [Axis; 3],
    /// Position in the rest pose.
    pub position: [f64; 3],
    /// Orientation in the rest pose: angles about the axes of `axis_order`.
    pub orientation: [f64; 3],
}

/// A bone: it begins where its parent ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Bone {
    /// Its name.
    pub name: String,
    /// Index of its parent among the bones, which comes before it; `None` for a bone that begins at the root.
    pub parent: Option<usize>,
    /// Direction in the global frame of the rest pose.
    pub direction: [f64; 3],
    /// Length.
    pub length: f64,
    /// Angles of the rotation from the global frame to that of the bone, in the file's order.
    pub axis: [f64; 3],
    /// The axes of those angles: the first applies first.
    pub axis_order: [Axis; 3],
    /// Its degrees of freedom in the order of their values; all others are 0.
    pub dof: Vec<Dof>,
    /// Lowest and highest value of each degree of freedom, possibly infinite; empty where the file gives none.
    pub limits: Vec<[f64; 2]>,
}

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// The three axes that a word such as `XYZ` lists, each once.
    fn order(word: &str) -> Option<[Self; 3]> {
        let mut axes = word.chars().map(|c| match c.to_ascii_uppercase() {
            'X' => Some(Self::X),
            'Y' => Some(Self::Y),
            'Z' => Some(Self::Z),
            _ => None,
        });
        let order = [axes.next()??, axes.next()??, axes.next()??];
        let distinct = order[0] != order[1] && order[1] != order[2] && order[2] != order[0];
        (axes.next().is_none() && distinct).then_some(order)
    }
}

/// A degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dof {
    /// Translation along x.
    Tx,
    /// Translation along y.
    Ty,
    /// Translation along z.
    Tz,
    /// Rotation about x.
    Rx,
    /// Rotation about y.
    Ry,
    /// Rotation about z.
    Rz,
    /// Stretch along the bone.
    Length,
}

impl Dof {
    /// All degrees of freedom.
    pub const ALL: [Self; 7] = [Self::Tx, Self::Ty, Self::Tz, Self::Rx, Self::Ry, Self::Rz, Self::Length];

    /// The name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tx => "tx",
            Self::Ty => "ty",
            Self::Tz => "tz",
            Self::Rx => "rx",
            Self::Ry => "ry",
            Self::Rz => "rz",
            Self::Length => "l",
        }
    }

    /// The degree of freedom of this name, in upper or lower case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dof| dof.name().eq_ignore_ascii_case(name))
    }
}

/// A motion of a skeleton, as in an AMC file. The file has no frame rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Values, frame after frame; in a frame those of the root, then bone after bone as in [`Skeleton::bones`], each
    /// in the order of its degrees of freedom. NaN is a missing sample.
    pub values: Vec<f64>,
    /// Number of frames.
    pub frames: usize,
    /// Unit of its angles.
    pub angle: AngleUnit,
    /// Repairs and assumptions.
    pub notes: Vec<Note>,
}
