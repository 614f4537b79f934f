//! Which joints move alike.

use super::super::about::Noisy;
use super::super::products::padded;
use super::super::steps;
use super::COMPANIONS;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};

/// Differences of similarity below which two joints are equally alike.
const SAME: f64 = 1e-9;

/// Joints whose products with each other are there at a time: memory does not grow with the square of all joints.
const TILE: usize = 64;

/// For each joint itself and the others that move most like it, as places in `joints`.
///
/// With the steps `v` of the pilot from frame to frame and `M_ij = Σ_t v_i v_jᵀ`, the similarity of two joints is
/// `‖M_ij‖ / √(‖M_ii‖ ‖M_jj‖)`, Frobenius norms. Among equals the first joint is taken.
pub(super) fn groups<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    interrupt: &Interrupt,
) -> Result<Vec<Vec<usize>>, Error> {
    let tiles: Vec<&[usize]> = joints.chunks(TILE).collect();
    let within = tiles.iter().map(|tile| {
        let width = padded(3 * tile.len());
        Ok(norms(&steps::of_all(noisy, tile, interrupt)?, width, [tile.len(); 2], true))
    });
    let within = within.collect::<Result<Vec<_>, Error>>()?;
    let own: Vec<f64> = within
        .iter()
        .zip(&tiles)
        .flat_map(|(norms, tile)| (0..tile.len()).map(|i| norms[i * tile.len() + i]))
        .collect();
    let similarity = |i: usize, j: usize, shared: f64| {
        let scale = (own[i] * own[j]).sqrt();
        if scale > 0.0 { shared / scale } else { 0.0 }
    };
    let mut alike = vec![Alike::default(); joints.len()];
    for (a, tile) in tiles.iter().enumerate() {
        let first = a * TILE;
        for i in 0..tile.len() {
            for j in (0..tile.len()).filter(|&j| j != i) {
                let shared = within[a][i * tile.len() + j];
                alike[first + i].offer(first + j, similarity(first + i, first + j, shared));
            }
        }
        for (b, (other, shared)) in tiles.iter().zip(beside(noisy, &tiles, a, interrupt)?).enumerate() {
            for (at, shared) in shared.into_iter().enumerate() {
                let (i, j) = (first + at / other.len(), b * TILE + at % other.len());
                let similar = similarity(i, j, shared);
                alike[i].offer(j, similar);
                alike[j].offer(i, similar);
            }
        }
    }
    let group = |(joint, alike): (usize, &Alike)| {
        let mut members = vec![joint];
        members.extend(alike.first());
        members.truncate(COMPANIONS);
        members
    };
    Ok(alike.iter().enumerate().map(group).collect())
}

/// Those that one joint may be most alike.
#[derive(Debug, Clone, Default)]
struct Alike(Vec<(usize, f64)>);

impl Alike {
    /// Takes note of a joint, after all that come before it.
    fn offer(&mut self, joint: usize, similarity: f64) {
        // One that comes later and is no more alike is never the first among equals.
        if self.0.last().is_none_or(|&(_, most)| similarity > most) {
            self.0.retain(|&(_, other)| other >= similarity - SAME);
            self.0.push((joint, similarity));
        }
    }

    fn first(&self) -> Option<usize> {
        self.0.first().map(|&(joint, _)| joint)
    }
}

/// Of the joints of one tile with those of each tile: the norms of their products; none but with the tiles after it.
fn beside<T: Real>(
    noisy: &Noisy<'_, T>,
    tiles: &[&[usize]],
    a: usize,
    interrupt: &Interrupt,
) -> Result<Vec<Vec<f64>>, Error> {
    let parts = steps::parts(noisy.clip.frames());
    let tasks = (a + 1..tiles.len()).flat_map(|b| parts.iter().map(move |part| (b, part.clone())));
    let work = noisy.clip.frames() * (tiles.len() - a) * TILE * TILE;
    let mut sums = parallel::map(tasks.collect(), work, |_, (b, part)| {
        steps::between(noisy, tiles[a], tiles[b], part, interrupt)
    })?
    .into_iter();
    let shared = |b: usize| {
        if b <= a {
            return Vec::new();
        }
        let products = steps::total(sums.by_ref().take(parts.len()).collect());
        norms(&products, padded(3 * tiles[b].len()), [tiles[a].len(), tiles[b].len()], false)
    };
    Ok((0..tiles.len()).map(shared).collect())
}

/// Frobenius norms of the blocks of three rows and three columns of a matrix; of a symmetric one only blocks from the diagonal on
/// are there.
fn norms(products: &[f64], width: usize, [rows, columns]: [usize; 2], symmetric: bool) -> Vec<f64> {
    let norm = |at: usize| {
        let (i, j) = (at / columns, at % columns);
        let mut square = 0.0;
        for a in i * 3..i * 3 + 3 {
            for b in j * 3..j * 3 + 3 {
                let (a, b) = if symmetric { (a.min(b), a.max(b)) } else { (a, b) };
                square += products[a * width + b] * products[a * width + b];
            }
        }
        square.sqrt()
    };
    (0..rows * columns).map(norm).collect()
}
