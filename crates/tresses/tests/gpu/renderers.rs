//! Every renderer with all of its options, except sample and layer counts.

use crate::{common, golden};
use tresses::{
    Body, View, ViewOptions,
    low_level::HairSet,
    renderer::{ClassicCoverage, ClassicOptions, Renderer, ShadingModel, ShadingRate, ShadowMethod},
};

/// Returns all combinations of renderer, coverage, shading model, shading rate and shadow method.
pub fn all() -> Vec<Renderer> {
    let models = [ShadingModel::Fiber, ShadingModel::KajiyaKay];
    let mut all: Vec<_> = [Renderer::tiles(4), Renderer::masks(4)]
        .into_iter()
        .flat_map(|renderer| models.map(|model| renderer.with_shading(model)))
        .collect();
    let coverages =
        [ClassicCoverage::AlphaToCoverage { samples: 4 }, ClassicCoverage::DepthPeeling { layers: 4 }];
    for coverage in coverages {
        for rate in [ShadingRate::PerVertex, ShadingRate::PerPixel] {
            for shadows in [ShadowMethod::Opaque, ShadowMethod::Absorption, ShadowMethod::DeepOpacity] {
                all.push(Renderer::Classic(ClassicOptions { coverage, rate, shadows }));
            }
        }
    }
    all
}

/// Each combination draws hair that covers about as much as with tiles, and no two images are equal.
#[test]
fn every_combination_draws_its_own_image() {
    let Some(context) = common::context() else { return };
    let all = all();
    assert!(all.len() <= 20, "{} combinations", all.len());
    let hair = HairSet::new(context, &golden::strands(context, 0..golden::COUNT)).expect("fits");
    let body = Body::new(context, &golden::ball());
    let mut view: Option<View> = None;
    let mut images: Vec<Vec<u8>> = Vec::new();
    for renderer in &all {
        let options = ViewOptions { renderer: *renderer, shadow_resolution: 256, ..common::coarse() };
        // A view takes every renderer after every other.
        let view = match &mut view {
            Some(view) => {
                view.set_options(&options).expect("fits");
                view
            }
            none => none.insert(View::new(context, &options, golden::SIZE, 1).expect("fits")),
        };
        let bare = common::picture(context, view, &golden::scene(), &[], &[&body]);
        let image = common::picture(context, view, &golden::scene(), &[&hair], &[&body]);
        let (mean, _) = golden::difference(&bare, &image);
        println!("{renderer:?}: hair changes the image by {mean:.2} of 255");
        assert!(mean > 2.0, "{renderer:?} draws no hair: {mean}");
        for (other, earlier) in all.iter().zip(&images) {
            let (mean, _) = golden::difference(earlier, &image);
            assert!(mean > 0.0, "{renderer:?} looks like {other:?}");
            assert!(mean < 40.0, "{renderer:?} and {other:?}: {mean}");
        }
        images.push(image);
    }
}
