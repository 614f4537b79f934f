//! Tables shared by the trackers of one reconstructor.

use super::lattice::Lattice;
use super::poses::Poses;
use super::trajectories::Trajectories;
use crate::Error;
use std::sync::OnceLock;

/// The candidate poses and their control-point trajectories side by side. The first tracker that needs them computes
/// them for all trackers of the same poses, options and control points.
#[derive(Debug, Default)]
pub struct Tables(OnceLock<(Lattice, Trajectories)>);

/// Parameters of the tables besides the poses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape<'a> {
    /// Number of poses of its clip that an example needs before it.
    pub(super) before: usize,
    pub(super) stride: usize,
    pub(super) window: &'a [usize],
    pub(super) points: usize,
    pub(super) up: usize,
}

impl Tables {
    /// The tables of the poses.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the tables belong to other poses or options.
    pub(super) fn of(&self, poses: &Poses<'_>, shape: Shape<'_>) -> Result<&(Lattice, Trajectories), Error> {
        let made = if let Some(made) = self.0.get() {
            made
        } else {
            let lattice = Lattice::new(poses, shape.before, shape.stride)?;
            let trajectories = Trajectories::new(poses, &lattice, shape.window, shape.points, shape.up);
            // Two trackers that start at the same time compute equal tables.
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
