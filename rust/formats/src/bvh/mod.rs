//! Biovision hierarchy files (`.bvh`): a tree of joints, then one row of channel values per frame.
//!
//! [`parse`] reads the dialects that are in use, [`write()`] makes files that it reads back as they were.

mod hierarchy;
mod motion;
mod write;

use crate::error::{Error, Note};
use crate::text;

pub use write::write;

/// A BVH file, as it was read.
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
    /// What was repaired or assumed.
    pub notes: Vec<Note>,
}

/// A joint of the hierarchy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Joint {
    /// Its name, which may hold blanks and colons.
    pub name: String,
    /// Index of its parent; `None` for a root, of which there may be several.
    pub parent: Option<usize>,
    /// Where it lies in its parent's frame.
    pub offset: [f64; 3],
    /// Its channels in the order of their values: rotations apply in this order, each about the axis turned by those
    /// before it.
    pub channels: Vec<Channel>,
    /// Its end sites: none, one, seldom more.
    pub end_sites: Vec<EndSite>,
}

/// The end of a last bone.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EndSite {
    /// What follows the words `End Site`, such as `#5`.
    pub name: Option<String>,
    /// Where it lies in its joint's frame.
    pub offset: [f64; 3],
}

/// What one column of the motion moves.
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

/// Time from one frame to the next, with the text that stood for it, so that a file keeps every digit of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTime {
    /// Seconds.
    pub seconds: f64,
    /// The number as the file had it; what stands for `seconds` in a file that is written, where it reads so.
    pub text: String,
}

impl FrameTime {
    /// What a file without a usable `Frame Time` gets.
    pub const ASSUMED: f64 = 1.0 / 30.0;

    /// A frame time that is written with as many digits as it needs.
    #[must_use]
    pub fn new(seconds: f64) -> Self {
        Self { seconds, text: format!("{seconds}") }
    }
}

/// Reads a BVH file.
///
/// Cost: one pass over the text, in parallel in a rayon pool; memory is the values, eight bytes each.
///
/// # Errors
/// [`Error`] with line and reason where the text is not BVH, is cut off before the first row of values, or where a row
/// does not fit the channels.
pub fn parse(bytes: &[u8]) -> Result<File, Error> {
    let mut notes = Vec::new();
    let text = text::open(bytes, &mut notes)?;
    let (joints, motion) = hierarchy::parse(text, &mut notes)?;
    let channels = joints.iter().map(|joint| joint.channels.len()).sum();
    let motion = motion::parse(text, motion, channels, &mut notes)?;
    Ok(File { joints, frame_time: motion.frame_time, values: motion.values, frames: motion.frames, notes })
}
