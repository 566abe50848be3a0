//! What a frame records is counted where it is recorded. No GPU needed.

use crate::common;
use tresses::{
    View,
    body::Body,
    draw::Coverage,
    frame::Sight,
    gpu::{Counts, Timings, wall},
    groom::TriMesh,
    light::HairSet,
    strands::StrandBuffers,
    view::{Picture, ViewOptions},
};

const SIZE: [u32; 2] = [64, 40];

/// What a picture of so many grooms and bodies records, by the rows of its times.
fn recorded(coverage: Coverage, grooms: usize, bodies: usize) -> Vec<(&'static str, Counts)> {
    let context = &common::noop();
    let options = ViewOptions { samples: 1, coverage, ..Default::default() };
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
            Sight::new(&view, &Picture::default()),
        )
        .expect("every pipeline is made");
    timings.counts().to_vec()
}

fn row(rows: &[(&str, Counts)], name: &str) -> Counts {
    rows.iter().find(|(known, _)| *known == name).map(|(_, counts)| *counts).expect("a row of that name")
}

#[test]
fn a_known_frame_records_what_is_known() {
    let rows = recorded(Coverage::SampleMask, 2, 1);
    let [width, height] = SIZE.map(u64::from);
    // A triangle over the picture, 4 bytes per pixel.
    let one = Counts { passes: 1, draws: 1, pipelines: 1, groups: 1, ..Counts::default() };
    assert_eq!(row(&rows, "present"), Counts { bytes: 4 * width * height, ..one });
    // One pass over both grooms, three chunks of strips each that 16 bits reach; the view's group and two per groom;
    // colours of 8 and depths of 4 bytes, both cleared and written.
    let strips = Counts { draws: 2 * 3, groups: 1 + 2 * 2, bytes: 12 * width * height, ..one };
    assert_eq!(row(&rows, "hair"), strips);
    // Knots and vertices of both grooms: a pipeline and a group for each, and two shared groups.
    let two = Counts { passes: 1, dispatches: 4, pipelines: 4, groups: 1 + 2 * 3, ..Counts::default() };
    assert_eq!(row(&rows, "shade"), two);
}

#[test]
fn a_change_of_the_frame_changes_its_counts() {
    let [one, two] = [1, 2].map(|grooms| recorded(Coverage::Tiles, grooms, 1));
    for name in ["shadow", "ambient", "bins", "shade", "hair"] {
        let (one, two) = (row(&one, name), row(&two, name));
        assert!(two.dispatches > one.dispatches && two.groups > one.groups, "{name}: {one:?} {two:?}");
        assert_eq!(two.passes, one.passes, "{name}: no groom has passes of its own");
    }
    // A second body: a draw into the grid of soft light and one into the picture.
    let more = row(&recorded(Coverage::Tiles, 1, 2), "body");
    let less = row(&one, "body");
    assert_eq!((more.draws, more.passes), (less.draws + 2, less.passes));
    // Four buffers begin with nothing in them, and what tiles know of their depths is copied into a texture twice.
    assert_eq!(row(&one, "bins").transfers, 4 + 2);
    // A layer more is two passes and a copy of the depth.
    let [four, five] = [4, 5].map(|layers| row(&recorded(Coverage::DepthPeeling { layers }, 1, 1), "hair"));
    let [width, height] = SIZE.map(u64::from);
    assert_eq!((five.passes, five.transfers), (four.passes + 2, four.transfers + 1));
    // Depth copied, read and written, the layer's colours written, both sides of the blend read and the sum written.
    assert_eq!(five.bytes - four.bytes, width * height * (4 * 2 + 4 * 2 + 8 + 8 * 2));
}
