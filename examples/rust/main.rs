// SPDX-License-Identifier: MIT
//! Nine rays on a conic, and through a lens, by sagitta from Rust:
//!
//!     rustc -O main.rs $(pkg-config --libs sagitta) -o main && ./main
//!
//! The numbers are printed so that they are read back to the last bit.
mod sagitta;

use sagitta::*;
use std::ptr::{null, null_mut};

const RAYS: usize = 9;

type Columns = [[f64; RAYS]; 3];

fn arrays(c: &Columns) -> [*const f64; 3] {
    [c[0].as_ptr(), c[1].as_ptr(), c[2].as_ptr()]
}

fn arrays_mut(c: &mut Columns) -> [*mut f64; 3] {
    let [x, y, z] = c;
    [x.as_mut_ptr(), y.as_mut_ptr(), z.as_mut_ptr()]
}

/// A surface borrows its parameters: `shape` has to live, and stay, as long as the element is used.
fn element(shape: &sgt_conic, z: f64, index: f64, semi_diameter: f64) -> sgt_element {
    let none = sgt_vec3::default();
    sgt_element {
        surface: surface(shape),
        pose: sgt_pose { origin: sgt_vec3 { z, ..none }, ..Default::default() },
        index,
        semi_diameter,
        aperture: null(),
        phase: null(),
        reserved_: [0; 6],
    }
}

#[allow(unused_unsafe)] // later compilers know that an address alone is safe
fn surface(shape: &sgt_conic) -> sgt_surface {
    let ops = unsafe { std::ptr::addr_of!(sgt_conic_ops) }; // nothing of the table is read
    sgt_surface { ops, self_: (shape as *const sgt_conic).cast() }
}

fn main() {
    let (mut o, mut d): (Columns, Columns) = Default::default();
    for i in 0..RAYS {
        let step = i as f64;
        o[0][i] = (step - 4.0) / 2.0;
        o[1][i] = step / 8.0;
        o[2][i] = -10.0;
        d[0][i] = step / 256.0;
        d[1][i] = -step / 128.0;
        d[2][i] = 1.0;
    }
    let rays = sgt_rays { o: arrays(&o), d: arrays(&d), tmin: null(), tmax: null() };

    let conic = sgt_conic { c: 1.0 / 51.68, k: -0.5, semi_diameter: 8.0 };
    let mut status = [0i8; RAYS];
    let (mut t, mut t_err) = ([0.0; RAYS], [0.0; RAYS]);
    let mut p = Columns::default();
    // Outputs are as long as the rays, and apart from them.
    let met = unsafe {
        sgt_intersect_batch(
            surface(&conic),
            RAYS,
            rays,
            sgt_hits {
                status: status.as_mut_ptr(),
                evals: null_mut(),
                t: t.as_mut_ptr(),
                t_err: t_err.as_mut_ptr(),
                t_lo: null_mut(),
                p: arrays_mut(&mut p),
                n: [null_mut(); 3],
                p_err: null_mut(),
                reserved_: [0; 2],
            },
            null(),
        )
    };
    println!("conic {}", met);
    for i in 0..RAYS {
        println!("{} {:e} {:e} {:e} {:e} {:e}", status[i], t[i], t_err[i], p[0][i], p[1][i], p[2][i]);
    }

    let shapes = [
        sgt_conic { c: 1.0 / 51.68, k: 0.0, semi_diameter: 0.0 },
        sgt_conic { c: 1.0 / -700.0, k: -0.5, semi_diameter: 0.0 },
        sgt_conic::default(),
    ];
    let lens = [
        element(&shapes[0], 0.0, 1.5168, 8.0),
        element(&shapes[1], 4.0, 1.0, 8.0),
        element(&shapes[2], 97.5, 0.0, 12.0),
    ];
    let mut fate = [0i8; RAYS];
    let mut opl = [0.0; RAYS];
    let (mut end, mut direction) = (Columns::default(), Columns::default());
    let passed = unsafe {
        sgt_trace_batch(
            lens.len(),
            lens.as_ptr(),
            1.0,
            RAYS,
            rays,
            sgt_traced {
                fate: fate.as_mut_ptr(),
                passed: null_mut(),
                o: arrays_mut(&mut end),
                d: arrays_mut(&mut direction),
                opl: opl.as_mut_ptr(),
                reserved_: [0; 2],
            },
            null(),
            null(),
        )
    };
    println!("lens {}", passed);
    for i in 0..RAYS {
        println!(
            "{} {:e} {:e} {:e} {:e} {:e} {:e} {:e}",
            fate[i],
            end[0][i],
            end[1][i],
            end[2][i],
            direction[0][i],
            direction[1][i],
            direction[2][i],
            opl[i]
        );
    }
}
