//! Run-time SIMD dispatch: one macro that compiles a body once per level, and the one place with `unsafe`.
//!
//! A body is plain Rust that the compiler vectorises: elementwise loops over slices of planes. It is compiled for the
//! baseline, for AVX2 and for AVX-512, and the features of the processor are detected once per process. On other
//! architectures the baseline is vector code already (NEON on aarch64). Since nothing contracts `a * b + c`, the
//! results have the same bits at every level.
//!
//! `QUATFILT_SIMD=baseline|avx2|avx512` lowers the level (never raises it): for tests and for instruction counts.

use std::sync::atomic::{AtomicU8, Ordering};

/// A set of instructions that kernels are compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// Features of every processor of the architecture: SSE2 on `x86_64`, NEON on aarch64.
    Baseline = 0,
    /// AVX2, 256 bits.
    Avx2 = 1,
    /// AVX-512 F, BW, DQ and VL, 512 bits.
    Avx512 = 2,
}

/// No level was chosen yet.
const UNKNOWN: u8 = u8::MAX;

static CURRENT: AtomicU8 = AtomicU8::new(UNKNOWN);

impl Level {
    /// All levels, lowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// The name, as in `QUATFILT_SIMD`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The highest level that this processor can run.
    #[must_use]
    pub fn detected() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    /// The level that kernels run at in this process.
    #[inline]
    #[must_use]
    pub fn current() -> Self {
        match CURRENT.load(Ordering::Relaxed) {
            0 => Self::Baseline,
            1 => Self::Avx2,
            2 => Self::Avx512,
            _ => Self::probe(),
        }
    }

    /// Lowers the level for this process, for tests; a level that the processor lacks becomes the highest that it
    /// has.
    #[allow(clippy::return_self_not_must_use, reason = "a setter, called for its effect")]
    pub fn set(self) -> Self {
        let level = self.min(Self::detected());
        CURRENT.store(level as u8, Ordering::Relaxed);
        level
    }

    #[cold]
    fn probe() -> Self {
        let asked = std::env::var("QUATFILT_SIMD").ok();
        let limit = Self::ALL.into_iter().find(|level| asked.as_deref() == Some(level.name()));
        limit.unwrap_or(Self::Avx512).set()
    }
}

/// Compiles the body of a function once per [`Level`] and dispatches at run time.
///
/// Everything that the body calls must be `#[inline(always)]`, or it is compiled without the level's features.
macro_rules! multiversion {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name($($arg: $ty),*) $(-> $ret)? {
            #[inline(always)]
            fn body($($arg: $ty),*) $(-> $ret)? $body
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($arg: $ty),*) $(-> $ret)? {
                body($($arg),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
            fn avx512($($arg: $ty),*) $(-> $ret)? {
                body($($arg),*)
            }
            match $crate::simd::Level::current() {
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the processor was asked")]
                // SAFETY: `Level::current` never exceeds what the processor reports.
                $crate::simd::Level::Avx512 => unsafe { avx512($($arg),*) },
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the processor was asked")]
                // SAFETY: `Level::current` never exceeds what the processor reports.
                $crate::simd::Level::Avx2 => unsafe { avx2($($arg),*) },
                _ => body($($arg),*),
            }
        }
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident<$T:ident: $bound:path $(, const $N:ident: $K:ty)*>($($arg:ident: $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block) => {
        $(#[$meta])*
        $vis fn $name<$T: $bound $(, const $N: $K)*>($($arg: $ty),*) $(-> $ret)? {
            #[inline(always)]
            #[allow(clippy::too_many_arguments, reason = "the kernel's own arguments")]
            fn body<$T: $bound $(, const $N: $K)*>($($arg: $ty),*) $(-> $ret)? $body
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            #[allow(clippy::too_many_arguments, reason = "the kernel's own arguments")]
            fn avx2<$T: $bound $(, const $N: $K)*>($($arg: $ty),*) $(-> $ret)? {
                body::<$T $(, $N)*>($($arg),*)
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
            #[allow(clippy::too_many_arguments, reason = "the kernel's own arguments")]
            fn avx512<$T: $bound $(, const $N: $K)*>($($arg: $ty),*) $(-> $ret)? {
                body::<$T $(, $N)*>($($arg),*)
            }
            match $crate::simd::Level::current() {
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the processor was asked")]
                // SAFETY: `Level::current` never exceeds what the processor reports.
                $crate::simd::Level::Avx512 => unsafe { avx512::<$T $(, $N)*>($($arg),*) },
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code, reason = "the processor was asked")]
                // SAFETY: `Level::current` never exceeds what the processor reports.
                $crate::simd::Level::Avx2 => unsafe { avx2::<$T $(, $N)*>($($arg),*) },
                _ => body::<$T $(, $N)*>($($arg),*),
            }
        }
    };
}
pub(crate) use multiversion;
