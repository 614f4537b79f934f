//! What trackers of one reconstructor share.

use super::lattice::Lattice;
use super::poses::Poses;
use super::trajectories::Trajectories;
use crate::Error;
use std::sync::OnceLock;

/// Which poses may be examples, and where they have their control points, side by side: made by the first tracker that needs it, and
/// the same for all trackers of the same poses, options and control points.
#[derive(Debug, Default)]
pub struct Tables(OnceLock<(Lattice, Trajectories)>);

/// What tables depend on beside the poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape<'a> {
    /// How many poses of its clip an example has before it.
    pub(super) before: usize,
    pub(super) stride: usize,
    pub(super) window: &'a [usize],
    pub(super) points: usize,
    pub(super) up: usize,
}

impl Tables {
    /// Those of the poses.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the poses have no clip that is long enough, or the tables are of others.
    pub(super) fn of(&self, poses: &Poses<'_>, shape: Shape<'_>) -> Result<&(Lattice, Trajectories), Error> {
        let made = if let Some(made) = self.0.get() {
            made
        } else {
            let lattice = Lattice::new(poses, shape.before, shape.stride)?;
            let trajectories = Trajectories::new(poses, &lattice, shape.window, shape.points, shape.up);
            // Two trackers that begin at once make the same.
            self.0.get_or_init(|| (lattice, trajectories))
        };
        let (lattice, trajectories) = made;
        if lattice.words() == poses.count().div_ceil(64)
            && lattice.stride() == shape.stride
            && trajectories.are_of(shape.window, shape.points, shape.up)
        {
            Ok(made)
        } else {
            Err(Error::Parameter { name: "tables", expected: "those of the same poses and options" })
        }
    }
}
