//! The part of Open Image Denoise's C interface that one picture needs (its public header `oidn.h`, from version 2.0 on).

use libloading::Library;
use std::error::Error;
use std::ffi::{c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;

/// A device or a filter; only ever behind a pointer.
pub(super) type Handle = *mut c_void;

/// `OIDN_DEVICE_TYPE_CPU`.
pub(super) const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
pub(super) const FLOAT3: c_int = 3;

/// Declares the table of functions and how it is read from the library.
macro_rules! functions {
    ($($(#[$doc:meta])* $field:ident = $name:literal: $signature:ty;)*) => {
        /// Its functions, named without their prefix.
        pub(super) struct Functions {
            $($(#[$doc])* pub(super) $field: $signature,)*
        }

        impl Functions {
            /// Looks all functions up.
            ///
            /// # Safety
            /// The library must be Open Image Denoise, and must never be unloaded.
            unsafe fn of(library: &Library) -> Result<Self, libloading::Error> {
                Ok(Self {
                    // SAFETY: from version 2.0 on the functions of these names have these signatures, and before there was
                    // none called `oidnGetDeviceInt`.
                    $($field: unsafe { *library.get::<$signature>($name)? },)*
                })
            }
        }
    };
}

impl Functions {
    /// Loads the library. It stays loaded, for it has threads of its own.
    pub(super) fn load(path: &Path) -> Result<Self, String> {
        // SAFETY: the library's initialisers ask nothing of who loads it.
        let library = unsafe { Library::new(path) }
            .map_err(|error| error.source().map_or(error.to_string(), ToString::to_string))?;
        let library = ManuallyDrop::new(library);
        // SAFETY: it has the name of Open Image Denoise, and is never dropped.
        unsafe { Self::of(&library) }.map_err(|_| format!("{} is not version 2", path.display()))
    }
}

functions! {
    /// Read-only numbers of a device, such as `version`.
    get_int = b"oidnGetDeviceInt": unsafe extern "C" fn(Handle, *const c_char) -> c_int;
    new_device = b"oidnNewDevice": unsafe extern "C" fn(c_int) -> Handle;
    set_int = b"oidnSetDeviceInt": unsafe extern "C" fn(Handle, *const c_char, c_int);
    set_bool = b"oidnSetDeviceBool": unsafe extern "C" fn(Handle, *const c_char, bool);
    commit_device = b"oidnCommitDevice": unsafe extern "C" fn(Handle);
    release_device = b"oidnReleaseDevice": unsafe extern "C" fn(Handle);
    /// What first went wrong since it was last asked; it forgets. Without a device: why there is none.
    error = b"oidnGetDeviceError": unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int;
    new_filter = b"oidnNewFilter": unsafe extern "C" fn(Handle, *const c_char) -> Handle;
    /// Filter, name, pixels, format, width, height, byte offset, bytes from pixel to pixel, from row to row (0: as it fits).
    share_image = b"oidnSetSharedFilterImage": unsafe extern "C" fn(
        Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize,
    );
    set_filter_bool = b"oidnSetFilterBool": unsafe extern "C" fn(Handle, *const c_char, bool);
    commit_filter = b"oidnCommitFilter": unsafe extern "C" fn(Handle);
    /// Runs it to the end.
    execute = b"oidnExecuteFilter": unsafe extern "C" fn(Handle);
    release_filter = b"oidnReleaseFilter": unsafe extern "C" fn(Handle);
}
