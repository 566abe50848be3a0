//! Commands are counted where a frame records them. Needs no GPU.

use crate::common;
use tresses::{
    Body, Picture, Timings, View, ViewOptions,
    groom::TriMesh,
    low_level::{Counts, Drawing, HairSet, StrandBuffers, wall},
    renderer::Renderer,
};

const SIZE: [u32; 2] = [64, 40];

/// Returns the counts of a frame with this many grooms and bodies, by row of the timings.
fn recorded(renderer: Renderer, grooms: usize, bodies: usize) -> Vec<(&'static str, Counts)> {
    let context = &common::noop();
    let options = ViewOptions { renderer, ..Default::default() };
    let view = View::new(context, &options, SIZE, 1).expect("a fair size");
    let strands = StrandBuffers::new(context, 5000, 16).expect("small enough");
    let hair: Vec<_> = (0..grooms).map(|_| HairSet::new(context, &strands).expect("small enough")).collect();
    let body = Body::new(context, &TriMesh::default());
    let mut timings = Timings::by(wall);
    let mut encoder = context.device().create_command_encoder(&Default::default());
    context
        .recorder(&mut encoder)
        .with_timings(Some(&mut timings))
        .draw_strands(
            &hair.iter().collect::<Vec<_>>(),
            &vec![&body; bodies],
            &view,
            Drawing::new(&Picture::default()),
        )
        .expect("every pipeline is made");
    timings.counts().to_vec()
}

fn row(rows: &[(&str, Counts)], name: &str) -> Counts {
    rows.iter().find(|(known, _)| *known == name).map(|(_, counts)| *counts).expect("a row of that name")
}

#[test]
fn frame_records_the_expected_counts() {
    let rows = recorded(Renderer::masks(1), 2, 1);
    let [width, height] = SIZE.map(u64::from);
    // One triangle over the image, 4 bytes per pixel.
    let one = Counts { passes: 1, draws: 1, pipelines: 1, groups: 1, ..Counts::default() };
    assert_eq!(row(&rows, "present"), Counts { bytes: 4 * width * height, ..one });
    // One pass over both grooms. Each groom takes three draws, since indices have 16 bits. One bind group for the view
    // and two per groom. 8 bytes of color and 4 of depth per pixel, both cleared and stored.
    let strips = Counts { draws: 2 * 3, groups: 1 + 2 * 2, bytes: 12 * width * height, ..one };
    assert_eq!(row(&rows, "hair"), strips);
    // Shading samples and vertices of both grooms. Per groom: two kernels with a pipeline and a bind group each, and
    // the group of its fiber. One empty group for all.
    let two = Counts { passes: 1, dispatches: 4, pipelines: 4, groups: 1 + 2 * 3, ..Counts::default() };
    assert_eq!(row(&rows, "shade"), two);
}

#[test]
fn counts_follow_grooms_bodies_and_layers() {
    let [one, two] = [1, 2].map(|grooms| recorded(Renderer::tiles(1), grooms, 1));
    for name in ["shadow", "ambient", "bins", "shade", "hair"] {
        let (one, two) = (row(&one, name), row(&two, name));
        assert!(two.dispatches > one.dispatches && two.groups > one.groups, "{name}: {one:?} {two:?}");
        assert_eq!(two.passes, one.passes, "{name}: no groom has passes of its own");
    }
    // A second body: one draw for its shading points and one into the image.
    let more = row(&recorded(Renderer::tiles(1), 1, 2), "body");
    let less = row(&one, "body");
    assert_eq!((more.draws, more.passes), (less.draws + 2, less.passes));
    // The kernels reset the buffers of the tiles.
    let bins = row(&one, "bins");
    assert_eq!((bins.transfers, bins.transfer_runs), (0, 0));
    // Per round: three kernels of the bins, and six that follow the lists. The first of the first round is direct.
    let see = row(&one, "see");
    let rounds = see.indirect / 6;
    assert_eq!((bins.indirect, see.indirect), (3 * rounds - 1, 6 * rounds));
    assert_eq!((bins.dispatches, see.dispatches), (6 + 3 * rounds, 7 * rounds));
    // Another layer adds two passes and a copy of the depth.
    let [four, five] = [4, 5].map(|layers| row(&recorded(Renderer::peeling(layers), 1, 1), "hair"));
    let [width, height] = SIZE.map(u64::from);
    assert_eq!((five.passes, five.transfers), (four.passes + 2, four.transfers + 1));
    // The depth is copied, loaded and stored. The layer's color is stored. The accumulated color is loaded and stored.
    assert_eq!(five.bytes - four.bytes, width * height * (4 * 2 + 4 * 2 + 8 + 8 * 2));
}
