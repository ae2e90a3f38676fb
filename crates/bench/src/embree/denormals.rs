//! Numbers too small for their exponent, which Embree asks its callers to treat as zero.

/// While it lives, this thread takes denormal numbers for zero, as Embree's manual recommends.
pub(super) struct FlushDenormals {
    #[cfg(target_arch = "x86_64")]
    before: u32,
}

#[cfg(target_arch = "x86_64")]
mod control {
    use std::arch::asm;

    /// Flush to zero (results) and denormals are zero (operands).
    pub(super) const FLUSH: u32 = 1 << 15 | 1 << 6;

    /// The control word of this thread's vector unit.
    pub(super) fn read() -> u32 {
        let mut word = 0_u32;
        // SAFETY: stores four bytes to a place that has them.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags)) };
        word
    }

    /// Sets it.
    pub(super) fn write(word: u32) {
        // SAFETY: `word` came from `read`, with defined bits added. Our own code that runs meanwhile moves numbers
        // about and computes none.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, preserves_flags)) };
    }
}

impl FlushDenormals {
    /// Starts it.
    pub(super) fn start() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let before = control::read();
            control::write(before | control::FLUSH);
            Self { before }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self {}
    }
}

impl Drop for FlushDenormals {
    fn drop(&mut self) {
        #[cfg(target_arch = "x86_64")]
        control::write(self.before);
    }
}
