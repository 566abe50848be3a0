//! `tresses compare`: our pictures beside path-traced ones of the same hair, camera and lights, with
//! the difference that people would see (FLIP) and the light on the hair.
//!
//! Strands and head come from the files the reference names, as they are: nothing is oriented,
//! simulated or fitted. What differs is rendering alone.

mod metrics;
mod scenes;
mod stage;

use crate::{args, interrupt, picture, progress, say, shading_args::ShadingArgs};
use anyhow::{Context, Result, ensure};
use metrics::Difference;
use scenes::{Folders, Scenes};
use serde::Serialize;
use stage::Stage;
use std::{fmt::Write, path::PathBuf};

/// The options of `tresses compare`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The description of the reference pictures (scenes.json); they lie beside it
    #[arg(value_name = "FILE")]
    pub scenes: PathBuf,
    /// The folder of the grooms it calls assets [default: $TRESSES_ASSETS]
    #[arg(long, value_name = "FOLDER")]
    pub assets: Option<PathBuf>,
    /// Only this picture; may be given again [default: all that show all of the light]
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Samples per pixel: 1, 4, 8 or 16 [default: 8, or as many as the adapter offers]
    #[arg(long, value_name = "N", value_parser = args::samples)]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub shading: ShadingArgs,
    /// Folder for ours, the reference and the map of the difference side by side, a picture each
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// One view, ours against the reference.
#[derive(Debug, Serialize)]
struct Row {
    name: String,
    #[serde(flatten)]
    difference: Difference,
    /// Mean linear luminance of the pixels that the reference calls hair.
    luminance: f64,
    reference_luminance: f64,
}

/// Runs `tresses compare`.
pub fn run(args: &Args) -> Result<()> {
    args.shading.check()?;
    let assets = args.assets.clone().or_else(|| std::env::var_os("TRESSES_ASSETS").map(PathBuf::from));
    let folders = Folders { scenes: &args.scenes, assets: assets.as_deref() };
    let scenes = Scenes::read(&args.scenes)?;
    let views = scenes.views(&args.only)?;
    ensure!(!views.is_empty(), "{}: no picture shows all of the light", args.scenes.display());
    let bar = progress::frames("comparing", views.len() as u64);
    let mut rows = Vec::new();
    let mut stage: Option<Stage> = None;
    for view in views {
        interrupt::check()?;
        // Pictures of one groom follow each other.
        let stage = match &mut stage {
            Some(stage) if stage.groom() == view.groom_name => stage,
            other => other.insert(Stage::new(&view, &folders, args.samples)?),
        };
        let (ours, linear) = stage.draw(&view, &scenes, &args.shading)?;
        let reference = folders.picture(view.name)?;
        let mask = folders.picture(&format!("{}_hairmask", view.groom_name))?;
        ensure!(
            (ours.width, ours.height) == (reference.width, reference.height)
                && (mask.width, mask.height) == (reference.width, reference.height),
            "{}: the reference is {} × {} pixels, its description says {} × {}",
            view.name,
            reference.width,
            reference.height,
            ours.width,
            ours.height
        );
        let (difference, map) = metrics::flip(&reference, &ours, &mask);
        rows.push(Row {
            name: view.name.to_owned(),
            difference,
            luminance: metrics::luminance(&linear, &mask),
            reference_luminance: view.luminance,
        });
        if let Some(folder) = &args.out {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            let sheet = picture::beside(&[&ours, &reference, &map]);
            picture::write(&sheet, &folder.join(format!("{}.png", view.name)))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if args.json {
        say!("{}", serde_json::to_string_pretty(&rows)?);
    } else {
        say!("{}", table(&rows).trim_end());
    }
    Ok(())
}

fn table(rows: &[Row]) -> String {
    let wide = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let mut text = format!(
        "{:wide$}  {:>8}  {:>9}  {:>10}  {:>10}  {:>6}\n",
        "", "FLIP", "on hair", "luminance", "reference", "ratio"
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{:wide$}  {:8.4}  {:9.4}  {:10.4}  {:10.4}  {:6.3}",
            row.name,
            row.difference.picture,
            row.difference.hair,
            row.luminance,
            row.reference_luminance,
            row.luminance / row.reference_luminance.max(1e-9)
        );
    }
    text
}
