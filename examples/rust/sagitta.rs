// SPDX-License-Identifier: MIT
//! What main.rs needs of sagitta.h, surfaces.h and system.h, by the names of C.
//!
//! A declaration that differs from C is no error to the compiler, and reads other numbers than were meant.
//! So tests/build/languages.py compares this file with the headers: each struct by its size and the offsets
//! of its members, each function by its type, each constant by its value.  Copy the check with the file.
#![allow(non_camel_case_types, non_upper_case_globals, dead_code)]
use std::os::raw::{c_char, c_int, c_schar, c_ulonglong, c_void};

#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct sgt_vec3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// One array for each number.  A NULL tmin is 0, a NULL tmax infinity.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct sgt_rays {
    pub o: [*const f64; 3],
    pub d: [*const f64; 3],
    pub tmin: *const f64,
    pub tmax: *const f64,
}

/// The table of operations of a surface.  Its members are not declared: the tables of built-in surfaces are
/// only pointed to.
#[repr(C)]
pub struct sgt_surface_ops {
    private: [u8; 0],
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct sgt_surface {
    pub ops: *const sgt_surface_ops,
    pub self_: *const c_void,
}

#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct sgt_conic {
    pub c: f64,
    pub k: f64,
    pub semi_diameter: f64,
}

/// An array that is NULL is not wanted.
#[repr(C)]
pub struct sgt_hits {
    pub status: *mut c_schar,
    pub evals: *mut c_int,
    pub t: *mut f64,
    pub t_err: *mut f64,
    pub t_lo: *mut f64,
    pub p: [*mut f64; 3],
    pub n: [*mut f64; 3],
    pub p_err: *mut f64,
    pub reserved_: [c_ulonglong; 2],
}

#[repr(C)]
pub struct sgt_options {
    pub t_tol: f64,
    pub f_tol: f64,
    pub dt_min: f64,
    pub max_evals: c_int,
    pub pick: c_int,
    pub proof: c_int,
    pub watch: *const c_void,
    pub watch_data: *mut c_void,
    pub reserved_: [c_ulonglong; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct sgt_pose {
    pub origin: sgt_vec3,
    pub ex: sgt_vec3,
    pub ey: sgt_vec3,
    pub ez: sgt_vec3,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct sgt_element {
    pub surface: sgt_surface,
    pub pose: sgt_pose,
    pub index: f64,
    pub semi_diameter: f64,
    pub aperture: *const c_void,
    pub phase: *const c_void,
    pub reserved_: [c_ulonglong; 6],
}

#[repr(C)]
pub struct sgt_traced {
    pub fate: *mut c_schar,
    pub passed: *mut c_int,
    pub o: [*mut f64; 3],
    pub d: [*mut f64; 3],
    pub opl: *mut f64,
    pub reserved_: [c_ulonglong; 2],
}

#[repr(C)]
pub struct sgt_passages {
    pub hits: sgt_hits,
    pub direction: [*mut f64; 3],
    pub opl: *mut f64,
    pub reserved_: [c_ulonglong; 2],
}

pub const SGT_HIT: c_int = 1;
pub const SGT_MISS: c_int = 0;
pub const SGT_INVALID: c_int = -5;
pub const SGT_PROVE_FIRST: c_int = 2;
pub const SGT_PASSED: c_int = 1;

extern "C" {
    pub static sgt_conic_ops: sgt_surface_ops;

    pub fn sgt_version() -> *const c_char;
    pub fn sgt_intersect_batch(
        s: sgt_surface,
        n: usize,
        rays: sgt_rays,
        hits: sgt_hits,
        opt: *const sgt_options,
    ) -> usize;
    pub fn sgt_trace_batch(
        elements: usize,
        e: *const sgt_element,
        index_before: f64,
        n: usize,
        rays: sgt_rays,
        out: sgt_traced,
        passages: *const sgt_passages,
        opt: *const sgt_options,
    ) -> usize;
}
