//! Writes the files stored in `tresses-groom`: the mannequin's mesh and distance field, and the draped guides of the
//! built-in styles. Run it after a change of the sculpture, a recipe or the draping:
//!
//! `cargo run -p tresses --example cook`
//!
//! If `bust.bin` has changed, run it twice: guides are traced on the bust that was compiled in.

use std::path::Path;
use tresses::{
    Gpu, drape,
    groom::{
        mannequin,
        scalp::GridScalp,
        styles::{self, Style},
    },
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../groom/cooked");
    let write = |name: &str, bytes: Vec<u8>| {
        println!("{name}: {} bytes", bytes.len());
        std::fs::write(folder.join(name), bytes)
    };
    let bust = mannequin::cook();
    let is_fresh = std::fs::read(folder.join("bust.bin")).is_ok_and(|stored| stored == bust);
    write("bust.bin", bust)?;
    if !is_fresh {
        println!("the bust has changed: run this example again for the guides");
        return Ok(());
    }
    let tresses = pollster::block_on(Gpu::open())?.context;
    let scalp = GridScalp::mannequin(mannequin::FIELD_RESOLUTION);
    let mut all = Vec::new();
    for name in Style::NAMES {
        let recipe = name.parse::<Style>()?.recipe();
        all.push(pollster::block_on(drape::fallen(&tresses, &recipe, &scalp, &()))?);
    }
    write("guides.bin", styles::cook(&all))?;
    Ok(())
}
