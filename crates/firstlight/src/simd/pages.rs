//! Memory for what rays walk through: on huge pages where the system has them.
//!
//! A tree is read all over, and each page that is not known to the processor costs a look into the system's tables, in
//! virtual machines several. Pages of 2 MiB instead of 4 KiB save nearly all of these.

#![allow(unsafe_code)]

use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};
use std::fmt::{Debug, Formatter};
use std::ops::Deref;
use std::ptr::NonNull;

/// A slice that does not change, aligned to huge pages if it fills some.
pub(crate) struct Pages<T> {
    start: NonNull<T>,
    len: usize,
}

// SAFETY: a `Pages` owns its numbers and gives them out by shared reference only, like a boxed slice.
unsafe impl<T: Send> Send for Pages<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Pages<T> {}

/// Size of a huge page, bytes.
const HUGE: usize = 2 << 20;

impl<T: Copy> Pages<T> {
    /// Copies `items`.
    pub(crate) fn new(items: &[T]) -> Self {
        let layout = Self::layout(items.len());
        if layout.size() == 0 {
            return Self { start: NonNull::dangling(), len: 0 };
        }
        // SAFETY: the layout's size is not zero.
        let start = NonNull::new(unsafe { alloc(layout) });
        let Some(start) = start.map(NonNull::cast::<T>) else { handle_alloc_error(layout) };
        advise(start.cast(), layout);
        // SAFETY: both are valid for `len` items, the new memory is aligned for them and belongs to nobody else.
        unsafe { start.copy_from_nonoverlapping(NonNull::from(items).cast(), items.len()) };
        Self { start, len: items.len() }
    }
}

impl<T> Pages<T> {
    /// The memory of `len` items, in whole huge pages if it fills one.
    fn layout(len: usize) -> Layout {
        let items =
            Layout::array::<T>(len).unwrap_or_else(|_| unreachable!("they fit into memory"));
        let huge = if items.size() >= HUGE { HUGE } else { 1 };
        let layout = items.align_to(huge).map(|layout| layout.pad_to_align());
        layout.unwrap_or_else(|_| unreachable!("the alignment is a power of two"))
    }
}

/// Asks the system for huge pages. It may have none: then they are ordinary ones.
fn advise(start: NonNull<u8>, layout: Layout) {
    #[cfg(target_os = "linux")]
    if layout.align() == HUGE {
        // SAFETY: the range is this allocation, and the advice does not change what is in it.
        unsafe { libc::madvise(start.as_ptr().cast(), layout.size(), libc::MADV_HUGEPAGE) };
    }
    #[cfg(not(target_os = "linux"))]
    let _ = (start, layout);
}

impl<T> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: `start` is aligned and valid for `len` items, which were copied there and do not change.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T: Debug> Debug for Pages<T> {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

impl<T> Drop for Pages<T> {
    fn drop(&mut self) {
        let layout = Self::layout(self.len);
        if layout.size() > 0 {
            // SAFETY: it was allocated with this layout, and `T: Copy` has nothing to drop.
            unsafe { dealloc(self.start.as_ptr().cast(), layout) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_hold_what_they_were_given() {
        for len in [0, 1, 1000, HUGE / 8, HUGE / 8 + 1, 3 * HUGE / 8 + 5] {
            let items: Vec<u64> = (0..len as u64).collect();
            let pages = Pages::new(&items);
            assert_eq!(*pages, *items);
            let align = if len >= HUGE / 8 { HUGE } else { align_of::<u64>() };
            assert_eq!(pages.as_ptr() as usize % align, 0);
        }
    }
}
