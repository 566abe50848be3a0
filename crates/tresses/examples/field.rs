//! Measures the build time of a mesh's distance field on the GPU and on the CPU, and the difference of the results. The
//! mesh comes from a file; the default is the built-in head.
//!
//! `cargo run --release --example field -- head.obj`

use std::time::Instant;
use tresses::{
    Gpu,
    groom::{
        import, mannequin,
        mesh::sdf::{self, SdfOptions},
    },
    low_level::FieldBuilder,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (name, mesh) = match std::env::args().nth(1) {
        Some(path) => (path.clone(), import::read_head(&[path], &Default::default())?.0),
        None => ("the built-in head".into(), mannequin::mesh(mannequin::RESOLUTION)),
    };
    let Gpu { context, info, .. } = pollster::block_on(Gpu::open())?;
    let builder = FieldBuilder::new(&context);
    println!("{name}: {} triangles, on {}", mesh.triangles.len(), info.name);
    for resolution in [64, 128] {
        let options = SdfOptions { resolution, fills_cavities: false, ..Default::default() };
        // The first call compiles the kernels.
        let coarse = SdfOptions { resolution: 8, ..options.clone() };
        pollster::block_on(builder.grid(&mesh, &coarse))?;
        let start = Instant::now();
        let grid = pollster::block_on(builder.grid(&mesh, &options))?;
        let gpu = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let reference = sdf::build(&mesh, &options)?;
        let cpu = start.elapsed().as_secs_f64() * 1e3;
        let pairs = grid.distances.iter().zip(&reference.distances);
        let near = pairs.filter(|(a, b)| a.min(**b).abs() < 4.0 * grid.cell);
        let mut off: Vec<f32> = near.map(|(a, b)| (a - b).abs()).collect();
        off.sort_by(f32::total_cmp);
        println!(
            "{resolution}: GPU {gpu:.0} ms, CPU {cpu:.0} ms; near the surface they differ by {:.3} mm (median), {:.3} mm (99 %)",
            1e3 * off[off.len() / 2],
            1e3 * off[off.len() * 99 / 100]
        );
    }
    Ok(())
}
