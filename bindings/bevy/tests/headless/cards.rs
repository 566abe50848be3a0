//! Hair as cards, by distance, and adapters that cannot draw hair.

use crate::common::{after, app, app_within, camera, groom, light, settled, wait};
use bevy::{camera::visibility::VisibilityRange, prelude::*, render::settings::WgpuLimits};
use bevy_tresses::{Hair3d, HairGroom, HairSupport};

/// Frames after which all changes are visible.
const ALL: usize = 4;

#[test]
fn cards_take_over_from_strands_at_a_distance() {
    let mut app = app("assets");
    assert_eq!(app.world().get_resource::<HairSupport>(), Some(&HairSupport(true)));
    light(&mut app);
    let (camera, picture) = camera(&mut app);
    let bare = settled(&mut app, &picture);
    let strands = groom();
    let cards = strands.clone().with_cards(40).expect("strands are sound");
    assert!(cards.groom.strands.len() < strands.groom.strands.len() / 8);
    let mut wear = |groom: HairGroom, range: VisibilityRange| {
        let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom);
        app.world_mut().spawn((Hair3d(groom), range)).id()
    };
    let near = wear(strands, VisibilityRange::abrupt(0.0, 0.6));
    let far = wear(cards, VisibilityRange::abrupt(0.6, 100.0));
    wait(&mut app);
    let looks = |app: &mut App, distance: f32, hidden: Option<Entity>| {
        for hair in [near, far] {
            let shown = if Some(hair) == hidden { Visibility::Hidden } else { Visibility::Inherited };
            app.world_mut().entity_mut(hair).insert(shown);
        }
        let place = Transform::from_xyz(0.0, 0.0, distance).looking_at(Vec3::ZERO, Vec3::Y);
        app.world_mut().entity_mut(camera).insert(place);
        after(app, ALL, &picture)
    };
    for (distance, shown, other) in [(0.5, near, far), (0.7, far, near)] {
        let both = looks(&mut app, distance, None);
        let hair = both.changed(&bare).len();
        assert!(hair > 200, "{hair} pixels of hair at {distance} m");
        assert!(looks(&mut app, distance, Some(other)).is(&both), "the other hair is hidden at {distance} m");
        assert!(looks(&mut app, distance, Some(shown)).changed(&bare).is_empty());
    }
}

#[test]
fn adapters_without_compute_shaders_show_no_hair_and_say_so() {
    let mut app = app_within("assets", 0.0, Some(WgpuLimits::downlevel_webgl2_defaults()));
    assert_eq!(app.world().get_resource::<HairSupport>(), Some(&HairSupport(false)));
    light(&mut app);
    let (_, picture) = camera(&mut app);
    let bare = settled(&mut app, &picture);
    let groom = app.world_mut().resource_mut::<Assets<HairGroom>>().add(groom());
    app.world_mut().spawn(Hair3d(groom));
    assert!(after(&mut app, ALL, &picture).is(&bare));
}
