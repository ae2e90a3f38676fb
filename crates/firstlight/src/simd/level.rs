//! Which instructions a kernel may use.

#![allow(unsafe_code)]

use super::{Simd, portable::Portable};
#[cfg(target_arch = "x86_64")]
use super::{avx512::Sixteen, x86::X86};

/// A set of SIMD instructions that this processor has; only detection hands one out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level(Set);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// A loop that is compiled once per level. `run` must be `#[inline(always)]`, as must all it calls with `simd`.
pub(crate) trait Kernel {
    /// What it computes.
    type Output;

    /// Does the work with the instructions of `simd`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

impl Level {
    /// The best level of this processor.
    pub fn detect() -> Self {
        *Self::all().last().unwrap_or(&Self(Set::Portable))
    }

    /// All levels of this processor, the slowest first.
    pub fn all() -> Vec<Self> {
        let mut levels = vec![Self(Set::Portable)];
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            levels.push(Self(Set::Avx2));
        }
        #[cfg(target_arch = "x86_64")]
        if has_avx512() {
            levels.push(Self(Set::Avx512));
        }
        levels
    }

    /// The name people know it by.
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        }
    }

    /// The same, for kernels that have no use for vectors of more than eight: the compiler moves what they hold in larger
    /// pieces than they read, and the processor then has to wait for both.
    pub(crate) fn of_eight(self) -> Self {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => Self(Set::Avx2),
            _ => self,
        }
    }

    /// Runs `kernel` with the instructions of this level.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Portable => kernel.run(Portable),
            // SAFETY: `Set::Avx2` is only made after all its features were detected.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { run_avx2(kernel) },
            // SAFETY: `Set::Avx512` is only made after all its features were detected.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => unsafe { run_avx512(kernel) },
        }
    }
}

/// Every processor with AVX2 has the bit instructions as well.
#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(X86::detected(()))
}

/// What Ice Lake and Zen 4 brought; processors before them slow down where much of AVX-512 is used.
#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512vbmi2")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(
    enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq,avx512bw,avx512vbmi2"
)]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(X86::detected(Sixteen::detected()))
}
