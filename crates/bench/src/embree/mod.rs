//! Embree 4, loaded while the program runs: the ray kernels to beat.

#![allow(unsafe_code, reason = "calls a C library")]

mod abi;
mod denormals;
mod find;
mod trace;

pub(crate) use trace::{Mode, Width};

use abi::{Functions, Handle};
use denormals::FlushDenormals;
use firstlight::scene::description::Mesh;
use glam::Vec3;
use std::error::Error;
use std::ffi::{CString, c_int, c_void};
use std::path::Path;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// The loaded library.
pub(crate) struct Embree {
    functions: Functions,
}

/// How Embree builds a scene and what it may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Setup {
    /// Build quality.
    pub(crate) quality: Quality,
    /// Whether its watertight flag is on.
    pub(crate) robust: bool,
    /// Whether it is told to use 256-bit vectors (eight-wide trees), which it does not by itself on many processors.
    pub(crate) simd256: bool,
}

/// Embree's build qualities that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Binned SAH.
    Medium,
    /// Binned SAH with spatial splits.
    High,
}

impl Embree {
    /// Loads the library from a file.
    fn open(path: &Path) -> Result<Self, String> {
        let wrong = |error: libloading::Error| {
            let reason = error.source().map_or(error.to_string(), ToString::to_string);
            format!("{} cannot be used as Embree: {reason}", path.display())
        };
        // SAFETY: Embree's initialisers ask nothing of who loads it, and the functions are those of its version 4.
        let functions = unsafe { libloading::Library::new(path).and_then(|l| Functions::of(l)) };
        Ok(Self { functions: functions.map_err(wrong)? })
    }
}

/// A mesh that Embree has built its tree over.
pub(crate) struct Scene<'a> {
    embree: &'a Embree,
    device: Handle,
    scene: Handle,
    setup: Setup,
    build_time: Duration,
    memory: Box<Memory>,
    /// Shared with Embree for as long as the scene lives: corners, with one more, since Embree reads 16 bytes each.
    _corners: Vec<Vec3>,
    _mesh: &'a Mesh,
}

// SAFETY: Embree's committed scenes may be traced from any number of threads; nothing else is done between threads.
unsafe impl Sync for Scene<'_> {}

/// Bytes in use by a device.
#[derive(Default)]
struct Memory {
    now: AtomicIsize,
    peak: AtomicIsize,
}

impl Setup {
    fn config(self, threads: usize) -> CString {
        let width = if self.simd256 { ",frequency_level=simd256" } else { "" };
        CString::new(format!("threads={threads},set_affinity=0{width}")).unwrap_or_default()
    }
}

impl<'a> Scene<'a> {
    /// Has Embree build its tree over `mesh`, on a device of its own with so many threads.
    ///
    /// # Errors
    /// What Embree refused, in words to be printed.
    pub(crate) fn build(
        embree: &'a Embree,
        mesh: &'a Mesh,
        setup: Setup,
        threads: usize,
    ) -> Result<Self, String> {
        let functions = &embree.functions;
        // SAFETY: the configuration is a C string; the result is looked at before it is used.
        let device = unsafe { (functions.new_device)(setup.config(threads).as_ptr()) };
        let device = NonNull::new(device).ok_or("Embree makes no device")?.as_ptr();
        let corners = mesh.positions.iter().copied().chain([Vec3::ZERO]).collect();
        let memory = Box::<Memory>::default();
        // SAFETY: the device is alive, and the box of the monitor outlives it.
        let scene = unsafe {
            let watched: *const Memory = &raw const *memory;
            (functions.set_memory_monitor)(device, note_memory, watched.cast_mut().cast());
            (functions.new_scene)(device)
        };
        let (build_time, _corners, _mesh) = (Duration::ZERO, corners, mesh);
        let mut built = Self { embree, device, scene, setup, build_time, memory, _corners, _mesh };
        built.commit();
        // SAFETY: the device is alive.
        match unsafe { (functions.device_error)(device) } {
            0 => Ok(built),
            code => Err(format!("Embree fails with error {code}")),
        }
    }

    /// Attaches the mesh and builds, on the clock.
    fn commit(&mut self) {
        let _flush = FlushDenormals::start();
        let f = &self.embree.functions;
        let quality = if self.setup.quality == Quality::High { abi::HIGH } else { abi::MEDIUM };
        // SAFETY: device, scene and geometry are alive; the buffers live as long as `self` and have the sizes told,
        // the corners one element more.
        unsafe {
            (f.set_scene_quality)(self.scene, quality);
            (f.set_scene_flags)(self.scene, if self.setup.robust { abi::ROBUST } else { 0 });
            let geometry = (f.new_geometry)(self.device, abi::TRIANGLE_GEOMETRY);
            let share = |buffer: c_int, format: c_int, start: *const c_void, count: usize| {
                (f.share_buffer)(geometry, buffer, 0, format, start, 0, 12, count);
            };
            let (corners, triangles) = (&self._corners, &self._mesh.triangles);
            share(abi::VERTEX_BUFFER, abi::FLOAT3, corners.as_ptr().cast(), corners.len() - 1);
            share(abi::INDEX_BUFFER, abi::UINT3, triangles.as_ptr().cast(), triangles.len());
            (f.set_geometry_quality)(geometry, quality);
            let start = Instant::now();
            (f.commit_geometry)(geometry);
            (f.attach_geometry)(self.scene, geometry);
            (f.release_geometry)(geometry);
            (f.commit_scene)(self.scene);
            self.build_time = start.elapsed();
        }
    }

    /// How it was built.
    pub(crate) fn setup(&self) -> Setup {
        self.setup
    }

    /// How long the building took.
    pub(crate) fn build_time(&self) -> Duration {
        self.build_time
    }

    /// Bytes in use now, without the mesh itself, and at the peak of building.
    pub(crate) fn memory(&self) -> [usize; 2] {
        [&self.memory.now, &self.memory.peak].map(|bytes| bytes.load(Relaxed).max(0) as usize)
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: both are alive and not used afterwards; the monitor's box is dropped after this.
        unsafe {
            (self.embree.functions.release_scene)(self.scene);
            (self.embree.functions.release_device)(self.device);
        }
    }
}

/// Embree's memory monitor: counts, and always agrees.
///
/// # Safety
/// `memory` must point to a [`Memory`].
unsafe extern "C" fn note_memory(memory: *mut c_void, bytes: isize, _: bool) -> bool {
    // SAFETY: promised by the caller; it is only changed through atomics.
    let memory = unsafe { &*memory.cast::<Memory>() };
    let now = memory.now.fetch_add(bytes, Relaxed) + bytes;
    memory.peak.fetch_max(now, Relaxed);
    true
}
