//! Joints and values to text.

use super::{EndSite, FrameTime, Joint};
use crate::Precision;
use crate::decimal;
use crate::error::Error;
use crate::number;
use rayon::prelude::*;
use std::ops::Range;

/// Values that a thread writes at a time.
const CHUNK: usize = 1 << 16;
/// Chunks written before they are concatenated: limits the memory held twice.
const BATCH: usize = 64;

/// Writes a BVH file of `joints` and `values`, one row of channel values per frame as in
/// [`File::values`](super::File).
///
/// [`parse`](super::parse) reads the same joints, frame time and values back (values to the digits of `precision`,
/// offsets exactly). Joints that are not in depth-first order are written in that order, with their columns.
///
/// Cost: one pass over the values, in parallel in a rayon pool; memory is the text.
///
/// # Errors
/// [`Error`] without a line if a name, a parent, an offset, the frame time or the number of values cannot be written.
pub fn write(
    joints: &[Joint],
    frame_time: &FrameTime,
    values: &[f64],
    precision: Precision,
) -> Result<Vec<u8>, Error> {
    let tree = Tree::new(joints)?;
    let channels = tree.columns.last().map_or(0, |columns| columns.end);
    if channels == 0 || !values.len().is_multiple_of(channels) {
        return Err(Error::whole(format!("{} values: expected rows of {channels}", values.len())));
    }
    let mut out = b"HIERARCHY\n".to_vec();
    tree.push_hierarchy(&mut out);
    out.extend_from_slice(format!("MOTION\nFrames: {}\n", values.len() / channels).as_bytes());
    out.extend_from_slice(format!("Frame Time: {}\n", frame_time_text(frame_time)?).as_bytes());

    let rows_per_chunk = (CHUNK / channels).max(1);
    let write_rows = |rows: &[f64]| {
        let mut text = Vec::with_capacity(rows.len() * 12);
        for row in rows.chunks_exact(channels) {
            tree.push_row(&mut text, row, precision);
        }
        text
    };
    for batch in values.chunks(rows_per_chunk * channels * BATCH) {
        if rayon::current_thread_index().is_some() {
            let parts: Vec<Vec<u8>> = batch.par_chunks(rows_per_chunk * channels).map(write_rows).collect();
            out.reserve(parts.iter().map(Vec::len).sum());
            for part in parts {
                out.extend_from_slice(&part);
            }
        } else {
            for chunk in batch.chunks(rows_per_chunk * channels) {
                out.extend_from_slice(&write_rows(chunk));
            }
        }
    }
    Ok(out)
}

/// The original text of the frame time, unless the time was changed.
fn frame_time_text(frame_time: &FrameTime) -> Result<String, Error> {
    let FrameTime { seconds, text } = frame_time;
    if !(seconds.is_finite() && *seconds > 0.0) {
        return Err(Error::whole(format!(
            "frame time: expected a positive number of seconds, got {seconds}"
        )));
    }
    let keeps = number::parse(text.as_bytes()).is_some_and(|read| read.to_bits() == seconds.to_bits());
    Ok(if keeps { text.clone() } else { format!("{seconds}") })
}

/// The joints, in the order of the file.
struct Tree<'a> {
    joints: &'a [Joint],
    /// Columns of each joint's channels, in the order of `joints`.
    columns: Vec<Range<usize>>,
    /// Joints depth first, each with its depth.
    order: Vec<(usize, usize)>,
    in_order: bool,
}

impl<'a> Tree<'a> {
    fn new(joints: &'a [Joint]) -> Result<Self, Error> {
        let mut children = vec![Vec::new(); joints.len()];
        let mut roots = Vec::new();
        let mut columns = Vec::with_capacity(joints.len());
        let mut column = 0;
        for (index, joint) in joints.iter().enumerate() {
            check(joint)?;
            match joint.parent {
                None => roots.push(index),
                Some(parent) if parent < index => children[parent].push(index),
                Some(parent) => {
                    let name = &joint.name;
                    return Err(Error::whole(format!(
                        "joint `{name}` ({index}): expected a parent before it, got {parent}"
                    )));
                }
            }
            columns.push(column..column + joint.channels.len());
            column += joint.channels.len();
        }
        let mut order = Vec::with_capacity(joints.len());
        let mut waiting: Vec<_> = roots.into_iter().rev().map(|root| (root, 0)).collect();
        while let Some((joint, depth)) = waiting.pop() {
            order.push((joint, depth));
            waiting.extend(children[joint].iter().rev().map(|&child| (child, depth + 1)));
        }
        let in_order = order.iter().enumerate().all(|(place, &(joint, _))| place == joint);
        Ok(Self { joints, columns, order, in_order })
    }

    fn push_hierarchy(&self, out: &mut Vec<u8>) {
        for (place, &(index, depth)) in self.order.iter().enumerate() {
            let joint = &self.joints[index];
            let kind = if depth == 0 { "ROOT" } else { "JOINT" };
            push_line(out, depth, &format!("{kind} {}", joint.name));
            push_line(out, depth, "{");
            push_offset(out, depth + 1, joint.offset);
            if !joint.channels.is_empty() {
                let names: Vec<_> = joint.channels.iter().map(|channel| channel.name()).collect();
                push_line(out, depth + 1, &format!("CHANNELS {} {}", names.len(), names.join(" ")));
            }
            for EndSite { name, offset } in &joint.end_sites {
                let name = name.as_ref().map_or_else(String::new, |name| format!(" {name}"));
                push_line(out, depth + 1, &format!("End Site{name}"));
                push_line(out, depth + 1, "{");
                push_offset(out, depth + 2, *offset);
                push_line(out, depth + 1, "}");
            }
            let next = self.order.get(place + 1).map_or(0, |&(_, depth)| depth);
            for closed in (next..=depth).rev() {
                push_line(out, closed, "}");
            }
        }
    }

    fn push_row(&self, out: &mut Vec<u8>, row: &[f64], precision: Precision) {
        let mut push = |values: &[f64]| {
            for &value in values {
                decimal::push(out, value, precision);
                out.push(b' ');
            }
        };
        if self.in_order {
            push(row);
        } else {
            for &(joint, _) in &self.order {
                push(&row[self.columns[joint].clone()]);
            }
        }
        out.pop();
        out.push(b'\n');
    }
}

/// Rejects values that a file cannot contain.
fn check(joint: &Joint) -> Result<(), Error> {
    let Joint { name, offset, channels, end_sites, .. } = joint;
    let writable =
        |name: &str| !name.is_empty() && name.trim_ascii() == name && !name.contains(['\n', '\r', '{']);
    if !writable(name) {
        return Err(Error::whole(format!(
            "joint name {name:?}: expected text of one line without `{{` and without outer blanks"
        )));
    }
    if let Some(site) = end_sites.iter().filter_map(|site| site.name.as_ref()).find(|site| !writable(site)) {
        return Err(Error::whole(format!("joint `{name}`: end site name {site:?} cannot be written")));
    }
    if (1..channels.len()).any(|i| channels[..i].contains(&channels[i])) {
        return Err(Error::whole(format!("joint `{name}`: a channel comes twice")));
    }
    let offsets = end_sites.iter().map(|site| &site.offset).chain([offset]);
    if offsets.flatten().any(|value| !value.is_finite()) {
        return Err(Error::whole(format!("joint `{name}`: expected finite offsets")));
    }
    Ok(())
}

fn push_line(out: &mut Vec<u8>, depth: usize, text: &str) {
    out.resize(out.len() + depth, b'\t');
    out.extend_from_slice(text.as_bytes());
    out.push(b'\n');
}

fn push_offset(out: &mut Vec<u8>, depth: usize, offset: [f64; 3]) {
    out.resize(out.len() + depth, b'\t');
    out.extend_from_slice(b"OFFSET");
    for value in offset {
        out.push(b' ');
        decimal::push(out, value, Precision::Shortest);
    }
    out.push(b'\n');
}
