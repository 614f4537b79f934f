//! Biovision hierarchy files (`.bvh`): a tree of joints, then one row of channel values per frame.
//!
//! [`parse`] reads the dialects in use; [`write()`] writes files that it reads back unchanged.

mod hierarchy;
mod motion;
mod write;

use crate::error::{Error, Note};
use crate::text;

pub use write::write;

/// The contents of a BVH file.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// The joints in the order of the file, which is depth first: a parent comes before its children.
    pub joints: Vec<Joint>,
    /// Time from one frame to the next.
    pub frame_time: FrameTime,
    /// Channel values, frame after frame; in a frame joint after joint, in the order of its channels. Angles are in
    /// degrees. NaN is a missing sample.
    pub values: Vec<f64>,
    /// Number of frames.
    pub frames: usize,
    /// Repairs and assumptions.
    pub notes: Vec<Note>,
}

/// A joint of the hierarchy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Joint {
    /// Its name, which may contain blanks and colons.
    pub name: String,
    /// Index of its parent; `None` for a root. There may be several roots.
    pub parent: Option<usize>,
    /// Position in its parent's frame.
    pub offset: [f64; 3],
    /// Its channels in the order of their values: rotations apply in this order, each about the axis as rotated by
    /// the previous ones.
    pub channels: Vec<Channel>,
    /// Its end sites: usually none or one.
    pub end_sites: Vec<EndSite>,
}

/// The end of a last bone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EndSite {
    /// Text after the words `End Site`, such as `#5`.
    pub name: Option<String>,
    /// Position in its joint's frame.
    pub offset: [f64; 3],
}

/// Quantity in one column of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Position along x.
    Xposition,
    /// Position along y.
    Yposition,
    /// Position along z.
    Zposition,
    /// Rotation about x, in degrees.
    Xrotation,
    /// Rotation about y, in degrees.
    Yrotation,
    /// Rotation about z, in degrees.
    Zrotation,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 6] = [
        Self::Xposition,
        Self::Yposition,
        Self::Zposition,
        Self::Xrotation,
        Self::Yrotation,
        Self::Zrotation,
    ];

    /// The name in a file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Xposition => "Xposition",
            Self::Yposition => "Yposition",
            Self::Zposition => "Zposition",
            Self::Xrotation => "Xrotation",
            Self::Yrotation => "Yrotation",
            Self::Zrotation => "Zrotation",
        }
    }

    /// The channel of this name, in upper or lower case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|channel| channel.name().eq_ignore_ascii_case(name))
    }
}

/// Time from one frame to the next, with its text, so that files keep all digits.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTime {
    /// Seconds.
    pub seconds: f64,
    /// The number as in the file; written in place of `seconds` if it has that value.
    pub text: String,
}

impl FrameTime {
    /// Frame time of a file without a usable `Frame Time`.
    pub const ASSUMED: f64 = 1.0 / 30.0;

    /// A frame time that is written with as many digits as necessary.
    #[must_use]
    pub fn new(seconds: f64) -> Self {
        Self { seconds, text: format!("{seconds}") }
    }
}

/// Reads a BVH file.
///
/// Cost: one pass over the text, in parallel in a rayon pool; memory is eight bytes per value.
///
/// # Errors
/// [`Error`] with line and reason if the text is not BVH, ends before the first row of values, or a row does not
/// agree with the channels.
pub fn parse(bytes: &[u8]) -> Result<File, Error> {
    let mut notes = Vec::new();
    let text = text::open(bytes, &mut notes)?;
    let (joints, motion) = hierarchy::parse(text, &mut notes)?;
    let channels = joints.iter().map(|joint| joint.channels.len()).sum();
    let motion = motion::parse(text, motion, channels, &mut notes)?;
    Ok(File { joints, frame_time: motion.frame_time, values: motion.values, frames: motion.frames, notes })
}
