//! What the machine has, and when it wants us to stop.

use crate::Exit;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Processors that may be used.
pub(crate) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Bytes of memory that can still be had, where the system says so.
pub(crate) fn available_memory() -> Option<u64> {
    kibibytes("/proc/meminfo", "MemAvailable:")
}

/// The most bytes of memory that were in use at any time, where the system says so.
pub(crate) fn peak_memory() -> Option<u64> {
    kibibytes("/proc/self/status", "VmHWM:")
}

/// The number after `key` in one of Linux's tables of `key: 123 kB`, in bytes.
fn kibibytes(file: &str, key: &str) -> Option<u64> {
    let table = std::fs::read_to_string(file).ok()?;
    let value = table.lines().find_map(|line| line.strip_prefix(key))?;
    let number: u64 = value.split_whitespace().next()?.parse().ok()?;
    number.checked_mul(1024)
}

/// Whether a signal asked for an end. A second one ends the program at once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Signal {
    asked: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Signal {
    /// Takes note of SIGINT and SIGTERM from now on.
    pub(crate) fn listen() -> Self {
        let stop = Self::default();
        for (signal, exit) in [(SIGINT, Exit::Interrupt), (SIGTERM, Exit::Terminate)] {
            let shutdown = Arc::clone(&stop.asked);
            // The order matters: actions run as they were registered, so the first signal finds `asked` unset.
            // Where the system refuses a handler, the signal ends the program as usual.
            let _ = flag::register_conditional_shutdown(signal, exit as i32, shutdown)
                .and_then(|_| flag::register(signal, Arc::clone(&stop.asked)))
                .and_then(|_| {
                    flag::register_usize(signal, Arc::clone(&stop.signal), exit as usize)
                });
        }
        stop
    }

    /// Whether there was a signal.
    pub(crate) fn asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// The exit code of the signal that came, if any.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let signal = self.signal.load(Ordering::Relaxed);
        [Exit::Interrupt, Exit::Terminate].into_iter().find(|exit| *exit as usize == signal)
    }
}
