//! Grooms load from files, and reload when these change.

use crate::common::{after, app, camera, fan, light, middle, settled, wait};
use bevy::prelude::*;
use bevy_tresses::{Hair3d, HairGroom, HairGroomSettings};
use std::{fs, path::Path, time::Duration};
use tresses::groom::{Strands, export::Writer, orient::LengthUnit};

/// Writes the lowest `count` of the 900 strands of a fan, in meters.
fn write(path: &Path, count: usize) {
    let (all, mut strands) = (fan(900), Strands::default());
    all.iter().take(count).for_each(|strand| strands.push(strand));
    let writer = Writer::of(path).expect("it is a groom");
    let encoded = writer.strands(&strands, Some(LengthUnit(1.0))).expect("it can be written");
    fs::write(path, encoded.bytes).expect("there is room");
}

#[test]
fn groom_loads_and_reloads() {
    let folder = std::env::temp_dir().join(format!("bevy_tresses-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("there is room");
    let mut app = app(&folder.to_string_lossy());
    light(&mut app);
    let (_, image) = camera(&mut app);
    let bare = settled(&mut app, &image);
    for name in ["fan.hair", "fan.tfx", "fan.obj", "fan.ply"] {
        write(&folder.join(name), 900);
        let server = app.world().resource::<AssetServer>().clone();
        let groom: Handle<HairGroom> = server.load(name);
        let hair = app.world_mut().spawn(Hair3d(groom.clone())).id();
        // Loading is asynchronous.
        wait(&mut app);
        let full = after(&mut app, 3, &image);
        let strands = |app: &App| {
            let grooms = app.world().resource::<Assets<HairGroom>>();
            grooms.get(&groom).map(|groom| groom.groom.strands.len())
        };
        assert_eq!((name, strands(&app)), (name, Some(900)));
        let seen = full.changed(&bare);
        assert!(seen.len() > 300, "{name}: {} pixels of hair", seen.len());

        write(&folder.join(name), 300);
        server.reload(name);
        for _ in 0..200 {
            app.update();
            std::thread::sleep(Duration::from_millis(5));
            if strands(&app) == Some(300) {
                break;
            }
        }
        assert_eq!((name, strands(&app)), (name, Some(300)));
        wait(&mut app);
        // A third of the strands is left, at the bottom.
        let lower = after(&mut app, 4, &image).changed(&bare);
        let [all, low] = [&seen, &lower].map(|pixels| middle(pixels).y);
        assert!(lower.len() > 100 && low > all + 5.0, "{name}: {} pixels, at {low} after {all}", lower.len());
        app.world_mut().despawn(hair);
        assert!(after(&mut app, 3, &image).is(&bare));
    }
    // A broken file fails to load. Settings choose the number of guides.
    write(&folder.join("few.hair"), 400);
    let server = app.world().resource::<AssetServer>().clone();
    let choose = |settings: &mut HairGroomSettings| settings.guides = Some(40);
    let groom: Handle<HairGroom> = server.load_builder().with_settings(choose).load("few.hair");
    fs::write(folder.join("broken.tfx"), b"nothing").expect("there is room");
    let broken: Handle<HairGroom> = server.load("broken.tfx");
    for _ in 0..200 {
        app.update();
        std::thread::sleep(Duration::from_millis(5));
        if server.is_loaded(&groom) && server.load_state(&broken).is_failed() {
            break;
        }
    }
    let guides =
        app.world().resource::<Assets<HairGroom>>().get(&groom).map(|groom| groom.groom.guides.len());
    assert_eq!(guides, Some(40));
    assert!(server.load_state(&broken).is_failed(), "{:?}", server.load_state(&broken));
    fs::remove_dir_all(&folder).expect("it is ours");
}
