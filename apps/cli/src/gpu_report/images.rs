//! Images of scenes, drawn twice, beside stored images of the software driver.

use super::{
    device,
    difference::{ImageDifference, difference},
    scenes::{COMMON, SCENES, SceneCase},
    section::{Draft, cells},
};
use crate::{
    files,
    photographer::Photographer,
    picture::{self, Image},
    render::{self, FrameTimes, RenderArgs},
    say,
};
use anyhow::{Context, Result, ensure};
use clap::Parser;
use std::{
    path::Path,
    time::{Duration, Instant},
};
use tresses::Gpu;
use tresses_scene::{Motion, Shot, Viewpoint};

/// Largest usual mean difference of two drivers, levels of 8 bits.
const MAX_MEAN: f64 = 2.0;
/// Largest usual 99th percentile of the difference, levels.
const MAX_P99: f64 = 40.0;
/// Columns of the table.
const COLUMNS: &[&str] =
    &["scene", "drawn", "s", "mean difference", "99th percentile", "drawn twice", "options"];

/// Options of a scene.
#[derive(Parser)]
#[command(name = "scene")]
struct SceneArgs {
    #[command(flatten)]
    render: RenderArgs,
}

/// Draws all scenes on the default adapter and compares them.
pub fn measure(draft: &mut Draft, quick: bool) -> Result<()> {
    draft.note(
        "Differences are in levels from 0 to 255. The images show the differences multiplied by 8. Scenes are drawn \
         twice from the start: equal means equal in every byte.",
    );
    let mut gpu = device::open()?;
    let seconds = match (gpu.context.tier().software, quick) {
        (true, true) => 0,
        (true, false) => 30,
        (false, _) => 300,
    };
    let limit = Duration::from_secs(seconds);
    let (start, mut unusual) = (Instant::now(), Vec::new());
    for case in SCENES {
        let began = Instant::now();
        match draw(&gpu, case) {
            Ok(image) => {
                let again = (start.elapsed() < limit).then(|| draw(&gpu, case)).transpose();
                let (again, differs) = match again {
                    Ok(None) => ("not drawn".to_owned(), false),
                    Ok(Some(again)) if again == image => ("equal".to_owned(), false),
                    Ok(Some(_)) => ("different".to_owned(), true),
                    Err(error) => (format!("{error:#}"), true),
                };
                if differs {
                    draft.find(format!("{}, drawn twice: {again}", case.name));
                }
                match compare(draft, case, &image, (&again, began.elapsed())) {
                    Ok(found) => unusual.extend(found),
                    Err(error) => draft.find(format!("{}: {error:#}", case.name)),
                }
            }
            Err(error) => {
                draft.find(format!("{}: {error:#}", case.name));
                let row = cells![case.name, false, (), (), (), (), case.options];
                draft.row("Scenes", COLUMNS, row);
                // The device may be lost.
                gpu = device::open()?;
            }
        }
        draft.keep();
    }
    if !unusual.is_empty() {
        draft.find(format!("different from the stored images: {}", unusual.join(", ")));
    }
    let missing = SCENES.iter().filter(|case| case.stored.is_empty()).count();
    if missing > 0 {
        draft.note(format!("{missing} scenes have no stored image."));
    }
    Ok(())
}

/// Adds row and images of a scene. Returns its name and difference if they are unusual.
fn compare(
    draft: &mut Draft,
    case: &SceneCase,
    image: &Image,
    (again, elapsed): (&str, Duration),
) -> Result<Option<String>> {
    let stored = (!case.stored.is_empty()).then(|| picture::decode(std::io::Cursor::new(case.stored)));
    let stored = stored.transpose().with_context(|| format!("the stored image of {}", case.name))?;
    let found = stored.as_ref().map(|stored| difference(image, stored).context("the sizes differ"));
    let found = found.transpose()?;
    let (mean, p99) = found.as_ref().map(|found| (found.mean, found.p99)).unzip();
    let row = cells![case.name, true, elapsed.as_secs_f64(), mean, p99, again, case.options];
    draft.row("Scenes", COLUMNS, row);
    let mut images = vec![("this adapter", image)];
    if let (Some(stored), Some(found)) = (&stored, &found) {
        images.extend([("stored", stored), ("difference × 8", &found.image)]);
    }
    draft.figure(case.name, &images)?;
    Ok(found.filter(is_unusual).map(|found| format!("{} (mean {:.1})", case.name, found.mean)))
}

fn is_unusual(found: &ImageDifference) -> bool {
    found.mean > MAX_MEAN || found.p99 > MAX_P99
}

/// Draws a scene as `tresses render` does.
fn draw(gpu: &Gpu, case: &SceneCase) -> Result<Image> {
    let words = std::iter::once("scene").chain(COMMON.split(' ')).chain(case.options.split(' '));
    let SceneArgs { render: args } = SceneArgs::try_parse_from(words)?;
    let mut scene = Photographer::on(gpu.clone(), &args.preset()?, args.size)?;
    scene.show(&args.debug)?;
    let (motion, mut drawn) = (Motion::open(&args.motion)?, None);
    let camera = Viewpoint::portrait(args.camera, scene.subject(), args.size.aspect(), args.zoom);
    let times = FrameTimes { frames: args.frames.unwrap_or(1), fps: args.fps, lead: 0.0 };
    render::play(&mut scene, &Shot::still(camera), &motion, times, "drawing", |scene, frame, camera| {
        if frame + 1 == times.frames {
            drawn = Some(scene.picture(camera)?);
        }
        Ok(())
    })?;
    drawn.context("no frame was drawn")
}

/// Draws all scenes on a software driver and writes their images into `folder`.
pub fn store(folder: &Path) -> Result<()> {
    let gpu = device::open()?;
    ensure!(gpu.context.tier().software, "{} is a GPU: stored images are a software driver's", gpu.info.name);
    let mut bytes = 0;
    for case in SCENES {
        let path = folder.join(format!("{}.png", case.name));
        files::prepare(&path)?;
        let png = draw(&gpu, case)?.png()?;
        files::write(&path, &png)?;
        bytes += png.len();
        say!("{}", path.display());
    }
    say!("{} images, {:.2} MB, {}", SCENES.len(), bytes as f64 * 1e-6, gpu.info.name);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_scenes_are_valid() {
        for case in SCENES {
            let words = std::iter::once("scene").chain(COMMON.split(' ')).chain(case.options.split(' '));
            let args = SceneArgs::try_parse_from(words).map(|args| args.render);
            let args = args.unwrap_or_else(|error| panic!("{}: {error}", case.name));
            assert_eq!((args.size.width, args.size.height, args.frames), (200, 150, Some(2)));
            args.preset().unwrap();
        }
    }
}
