//! What the benchmarks share: synthetic [`clips`], filters as they are reported ([`settings`]), and the [`timer`] that
//! goes through levels and threads.

pub mod clips;
pub mod settings;
pub mod timer;
