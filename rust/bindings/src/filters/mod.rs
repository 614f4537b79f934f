//! Filters.

pub(crate) mod gaps;
