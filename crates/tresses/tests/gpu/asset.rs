//! Hair of one asset: what may change while it moves.

use crate::common;
use tresses::{
    Context, HairHair, HairOptions, Pose, RestOptions, SimulationParams,
    glam::Quat,
    groom::{Groom, bind},
    low_level::{Hair, HairAsset, HairDescriptor, HairFrame, readback::blocking as readback},
};

fn groom() -> Groom {
    bind(&common::hanging(200, 16, 0.15), &Default::default()).unwrap()
}

/// Returns the hair's guides after a swing, whose physics are those of `physics` at each frame.
fn swung(context: &Context, physics: impl Fn(u32) -> SimulationParams) -> Vec<[u32; 4]> {
    let mut hair = common::hair(context, &groom(), &HairOptions::default(), None).unwrap();
    for i in 0..24 {
        let head = Pose { rotation: Quat::from_rotation_z(0.3 * (0.4 * i as f32).sin()), ..Pose::IDENTITY };
        let dt = if i == 0 { 0.0 } else { 1.0 / 60.0 };
        common::simulate(&mut hair, &HairFrame { simulation: &physics(i), ..common::frame(head, dt) });
    }
    readback::buffer(context, &hair.guides.current).unwrap()
}

#[test]
fn physics_can_change_in_any_frame() {
    let Some(context) = common::context() else { return };
    let usual = SimulationParams::default();
    let twisting = SimulationParams { twist: 0.5, ..usual };
    let cohesive = HairHair { cohesion: 900.0, ..usual.hair_hair };
    let cohesive = SimulationParams { hair_hair: cohesive, ..usual };
    let same = swung(context, |_| usual);
    for changed in [twisting, cohesive] {
        // The buffers exist from the first frame on, or come and go during the swing.
        let early = swung(context, |i| if i == 0 || i > 9 { changed } else { usual });
        let late = swung(context, |i| if i > 9 { changed } else { usual });
        assert!(early == late);
        assert!(late != same);
    }
}

#[test]
fn rest_shape_follows_its_options() {
    let Some(context) = common::context() else { return };
    let groom = bind(&common::hanging(200, 16, 0.3), &Default::default()).unwrap();
    let asset = |support| {
        let rest = RestOptions { support, ..Default::default() };
        let what =
            HairDescriptor { options: HairOptions { rest, ..Default::default() }, ..Default::default() };
        HairAsset::new(context, groom.clone(), &what).unwrap()
    };
    let words = |hair: &Hair| -> [Vec<u32>; 2] {
        [&*hair.guides.info, &hair.guides.rest].map(|buffer| readback::buffer(context, buffer).unwrap())
    };
    let [soft, stiff] = [2.0, 20.0].map(|support| Hair::new(&asset(support)).unwrap());
    let [before, expected] = [&soft, &stiff].map(words);
    assert!(before != expected);
    let other = Hair::new(soft.asset()).unwrap();
    let options = RestOptions { support: 20.0, ..Default::default() };
    soft.asset().set_rest(&SimulationParams::default(), &options).unwrap();
    assert!(words(&soft) == expected && words(&other) == expected);
    let absurd = RestOptions { support: f32::NAN, ..options };
    assert!(soft.asset().set_rest(&SimulationParams::default(), &absurd).is_err());
    assert!(words(&soft) == expected);
}
