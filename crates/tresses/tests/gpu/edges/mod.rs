//! Edges: coverage, depth peeling and shimmer in motion, each compared with a brute-force reference.

mod coverage;
mod groom;
mod judged;
mod motion;
mod oracle;
mod peeling;
mod picture;
mod reference;
mod tiles;

use tresses::renderer::Renderer;

/// A renderer with its supersampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mode {
    name: &'static str,
    renderer: Renderer,
    ssaa: u32,
}

const fn mode(name: &'static str, renderer: Renderer, ssaa: u32) -> Mode {
    Mode { name, renderer, ssaa }
}

impl Mode {
    /// Whether the adapter turns alpha into samples.
    fn is_alpha(self) -> bool {
        self.renderer == Renderer::alpha_to_coverage(self.renderer.samples())
    }
}

const MASK_1: Mode = mode("masks, 1 sample", Renderer::masks(1), 1);
const MASK_4: Mode = mode("masks, 4×MSAA", Renderer::masks(4), 1);
const MASK_2X: Mode = mode("masks, 2× SSAA", Renderer::masks(1), 2);
const MASK_4_2X: Mode = mode("masks, 4×MSAA, 2× SSAA", Renderer::masks(4), 2);
const ALPHA_4: Mode = mode("alpha to coverage, 4×MSAA", Renderer::alpha_to_coverage(4), 1);
const ALPHA_4_2X: Mode = mode("alpha to coverage, 4×MSAA, 2× SSAA", Renderer::alpha_to_coverage(4), 2);
const PEEL: Mode = mode("4 layers, 1 sample", Renderer::peeling(4), 1);
const PEEL_2X: Mode = mode("4 layers, 2× SSAA", Renderer::peeling(4), 2);
const TILES: Mode = mode("tiles, 4×MSAA of bodies", Renderer::tiles(4), 1);
const TILES_1: Mode = mode("tiles, 1 sample", Renderer::tiles(1), 1);
const TILES_2X: Mode = mode("tiles, 2× SSAA", Renderer::tiles(1), 2);
const MASK_8: Mode = mode("masks, 8×MSAA", Renderer::masks(8), 1);
const MASK_16: Mode = mode("masks, 16×MSAA", Renderer::masks(16), 1);
const ALPHA_8: Mode = mode("alpha to coverage, 8×MSAA", Renderer::alpha_to_coverage(8), 1);
const MODES: [Mode; 14] = [
    MASK_4, MASK_1, MASK_2X, MASK_4_2X, ALPHA_4, ALPHA_4_2X, PEEL, PEEL_2X, TILES, TILES_1, TILES_2X, MASK_8,
    MASK_16, ALPHA_8,
];

/// Returns the modes that an adapter with at most `samples` samples per pixel supports. Prints the skipped modes.
fn modes(samples: u32) -> impl Iterator<Item = Mode> {
    MODES.into_iter().filter(move |mode| {
        let can = mode.renderer.samples() <= samples;
        if !can {
            println!("skipped: {}: this adapter has {samples} samples per pixel at most", mode.name);
        }
        can
    })
}

#[test]
fn unsupported_sample_counts_are_skipped() {
    let names = |samples| modes(samples).map(|mode| mode.renderer.samples()).max();
    assert_eq!([names(4), names(8), names(16)], [Some(4), Some(8), Some(16)]);
    assert_eq!((modes(4).count(), modes(16).count()), (11, MODES.len()));
}
