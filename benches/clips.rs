//! Synthetic clips shared by the benchmarks.
