//! The part of Embree 4's C interface that tracing triangles needs (its public header `rtcore.h`, versions 4.0 to 4.4).

use libloading::Library;
use std::ffi::{c_char, c_int, c_uint, c_void};

/// An Embree object; only ever behind a pointer.
pub(super) type Handle = *mut c_void;

/// `RTC_INVALID_GEOMETRY_ID`.
pub(super) const INVALID: u32 = u32::MAX;
/// `RTC_BUILD_QUALITY_MEDIUM`.
pub(super) const MEDIUM: c_int = 1;
/// `RTC_BUILD_QUALITY_HIGH`: with spatial splits.
pub(super) const HIGH: c_int = 2;
/// `RTC_SCENE_FLAG_ROBUST`.
pub(super) const ROBUST: c_int = 4;
/// `RTC_RAY_QUERY_FLAG_COHERENT`.
pub(super) const COHERENT: c_int = 1 << 16;
/// `RTC_FEATURE_FLAG_TRIANGLE`.
pub(super) const TRIANGLES: c_int = 2;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`.
pub(super) const TRIANGLE_GEOMETRY: c_int = 0;
/// `RTC_BUFFER_TYPE_INDEX`.
pub(super) const INDEX_BUFFER: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`.
pub(super) const VERTEX_BUFFER: c_int = 1;
/// `RTC_FORMAT_UINT3`.
pub(super) const UINT3: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`.
pub(super) const FLOAT3: c_int = 0x9003;

/// `RTCRayN`: N rays, component by component.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Rays<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    pub(super) time: [f32; N],
    pub(super) t_far: [f32; N],
    pub(super) mask: [u32; N],
    pub(super) id: [u32; N],
    pub(super) flags: [u32; N],
}

/// `RTCHitN` with one level of instances.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Hits<const N: usize> {
    pub(super) normal: [[f32; N]; 3],
    pub(super) uv: [[f32; N]; 2],
    pub(super) primitive: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [u32; N],
    pub(super) instance_primitive: [u32; N],
}

/// `RTCRayHitN`, aligned as its widest packets ask.
#[repr(C, align(64))]
pub(super) struct RaysAndHits<const N: usize> {
    pub(super) rays: Rays<N>,
    pub(super) hits: Hits<N>,
}

/// `RTCRayN`, aligned as its widest packets ask.
#[repr(C, align(64))]
pub(super) struct OnlyRays<const N: usize> {
    pub(super) rays: Rays<N>,
}

/// `RTCIntersectArguments` and `RTCOccludedArguments`, which are laid out alike.
#[repr(C)]
pub(super) struct Arguments {
    pub(super) flags: c_int,
    pub(super) features: c_int,
    pub(super) context: *mut c_void,
    pub(super) filter: *mut c_void,
    pub(super) callback: *mut c_void,
}

type Closest<const N: usize> =
    unsafe extern "C" fn(*const c_int, Handle, *mut RaysAndHits<N>, *mut Arguments);
type Any<const N: usize> =
    unsafe extern "C" fn(*const c_int, Handle, *mut OnlyRays<N>, *mut Arguments);

/// Called with every change of the memory in use, bytes; the flag tells whether it has happened already.
pub(super) type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Declares the table of functions and how it is read from the library.
macro_rules! functions {
    ($($(#[$doc:meta])* $field:ident = $name:literal: $signature:ty;)*) => {
        /// Embree's functions, named without their prefix.
        pub(super) struct Functions {
            $($(#[$doc])* pub(super) $field: $signature,)*
            /// Keeps the code loaded.
            _library: Library,
        }

        impl Functions {
            /// Looks all functions up.
            ///
            /// # Safety
            /// The library must be Embree 4.
            pub(super) unsafe fn of(library: Library) -> Result<Self, libloading::Error> {
                Ok(Self {
                    // SAFETY: in Embree 4 the functions of these names have these signatures.
                    $($field: unsafe { *library.get::<$signature>($name)? },)*
                    _library: library,
                })
            }
        }
    };
}

functions! {
    new_device = b"rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Handle;
    release_device = b"rtcReleaseDevice": unsafe extern "C" fn(Handle);
    device_error = b"rtcGetDeviceError": unsafe extern "C" fn(Handle) -> c_int;
    set_memory_monitor = b"rtcSetDeviceMemoryMonitorFunction":
        unsafe extern "C" fn(Handle, MemoryMonitor, *mut c_void);
    new_scene = b"rtcNewScene": unsafe extern "C" fn(Handle) -> Handle;
    release_scene = b"rtcReleaseScene": unsafe extern "C" fn(Handle);
    set_scene_quality = b"rtcSetSceneBuildQuality": unsafe extern "C" fn(Handle, c_int);
    set_scene_flags = b"rtcSetSceneFlags": unsafe extern "C" fn(Handle, c_int);
    commit_scene = b"rtcCommitScene": unsafe extern "C" fn(Handle);
    new_geometry = b"rtcNewGeometry": unsafe extern "C" fn(Handle, c_int) -> Handle;
    release_geometry = b"rtcReleaseGeometry": unsafe extern "C" fn(Handle);
    set_geometry_quality = b"rtcSetGeometryBuildQuality": unsafe extern "C" fn(Handle, c_int);
    /// Geometry, buffer type, slot, format, start, byte offset, byte stride, elements.
    share_buffer = b"rtcSetSharedGeometryBuffer": unsafe extern "C" fn(
        Handle, c_int, c_uint, c_int, *const c_void, usize, usize, usize,
    );
    commit_geometry = b"rtcCommitGeometry": unsafe extern "C" fn(Handle);
    attach_geometry = b"rtcAttachGeometry": unsafe extern "C" fn(Handle, Handle) -> c_uint;
    intersect1 = b"rtcIntersect1":
        unsafe extern "C" fn(Handle, *mut RaysAndHits<1>, *mut Arguments);
    intersect8 = b"rtcIntersect8": Closest<8>;
    intersect16 = b"rtcIntersect16": Closest<16>;
    occluded1 = b"rtcOccluded1": unsafe extern "C" fn(Handle, *mut OnlyRays<1>, *mut Arguments);
    occluded8 = b"rtcOccluded8": Any<8>;
    occluded16 = b"rtcOccluded16": Any<16>;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn packets_are_laid_out_as_embree_has_them() {
        assert_eq!(offset_of!(RaysAndHits<1>, hits), 48);
        assert_eq!(offset_of!(RaysAndHits<16>, hits), 768);
        assert_eq!(offset_of!(Rays<8>, t_far), 8 * 32);
        assert_eq!(offset_of!(Hits<8>, geometry), 6 * 32);
        assert_eq!(size_of::<Hits<1>>(), 36);
    }
}
