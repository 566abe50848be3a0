//! `tresses compare`: our pictures beside path-traced ones of the same hair, camera and lights, with
//! the perceived difference (FLIP), and what hair and skin have of light ([`tones`]): of all lights, and of each alone
//! where the reference has that.
//!
//! Strands and head are read unchanged from the files that the reference names: nothing is oriented, simulated
//! or fitted, so only rendering differs. Where the reference has singly scattered light, with shadows and
//! without, the fractions that arrive are compared too ([`share`]).

mod metrics;
mod rig;
mod scenes;
mod share;
mod tones;

use crate::{
    args,
    flags::{RowFlags, Rows},
    picture, progress, say,
};
use anyhow::{Context, Result, ensure};
use metrics::{Difference, Linear};
use rig::Rig;
use scenes::{Folders, Pair, Scenes, WantedView};
use serde::Serialize;
use share::Share;
use std::{fmt::Write, path::PathBuf};
use tones::{Regions, Tones};
use tresses_scene::knobs::Flag;

/// The options of `tresses compare`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The description of the reference pictures (scenes.json); they lie beside it
    #[arg(value_name = "FILE")]
    pub scenes: PathBuf,
    /// The folder of the grooms it calls assets [default: $TRESSES_ASSETS]
    #[arg(long, value_name = "FOLDER")]
    pub assets: Option<PathBuf>,
    /// Only this picture; may be repeated [default: all that show all of the light]
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Samples per pixel: 1, 4, 8 or 16 [default: 8, or as many as the adapter offers]
    #[arg(long, value_name = "N", value_parser = args::samples)]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub shading: RowFlags<Shading>,
    /// Folder for ours, the reference and the map of the difference side by side, a picture each
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// The parameters that pictures are compared with.
#[derive(Clone, Debug, Default)]
pub struct Shading;

impl Rows for Shading {
    fn has(flag: &Flag) -> bool {
        ["shading", "melanin", "roughness", "shade-per", "ambient", "ambient-cells", "shadows", "strand-map"]
            .contains(&flag.name)
    }
}

/// One view, ours against the reference.
#[derive(Debug, Serialize)]
struct Row {
    name: String,
    /// Of pictures as they are shown; none of a light alone.
    #[serde(flatten)]
    difference: Option<Difference>,
    ours: Tones,
    reference: Tones,
}

/// All that was found.
#[derive(Debug, Default, Serialize)]
struct Report {
    /// All of the light.
    views: Vec<Row>,
    /// One light alone.
    lights: Vec<Row>,
    /// How much of one light arrives.
    shares: Vec<Share>,
}

/// Runs `tresses compare`.
pub fn run(args: &Args) -> Result<()> {
    let assets = args.assets.clone().or_else(|| std::env::var_os("TRESSES_ASSETS").map(PathBuf::from));
    let folders = Folders { scenes: &args.scenes, assets: assets.as_deref() };
    let scenes = Scenes::read(&args.scenes)?;
    let (views, pairs) = (scenes.views(&args.only)?, scenes.pairs(&args.only)?);
    ensure!(
        !(views.is_empty() && pairs.is_empty()),
        "{}: nothing can be compared with what was asked for",
        args.scenes.display()
    );
    let bar = progress::frames("comparing", (views.len() + pairs.len()) as u64);
    let mut report = Report::default();
    let mut last = None;
    for view in &views {
        let stage = stage(&mut last, view, &folders, args.samples)?;
        let ours = stage.draw(view, &scenes, &args.shading)?;
        let linear = stage.radiance(view, &scenes, &args.shading)?;
        let reference = folders.picture(view.name)?;
        let mask = folders.mask(view, (ours.width, ours.height))?;
        ensure!(
            (ours.width, ours.height) == (reference.width, reference.height),
            "{}: the reference is {} × {} pixels, its description says {} × {}",
            view.name,
            reference.width,
            reference.height,
            ours.width,
            ours.height
        );
        let (difference, map) = metrics::flip(&reference, &ours, &mask);
        let size = (ours.width, ours.height);
        let radiance = folders.radiance(view.name, size)?;
        let regions = Regions::new(&mask, &radiance);
        let row = |name: &str, difference, noise, ours: &Linear, reference: &Linear| Row {
            name: name.to_owned(),
            difference,
            ours: Tones::new(ours, &regions, Some(0.0)),
            reference: Tones::new(reference, &regions, noise),
        };
        report.views.push(row(view.name, Some(difference), Some(view.noise), &linear, &radiance.linear));
        for one in view.alone() {
            let linear = stage.radiance(&one, &scenes, &args.shading)?;
            let radiance = folders.radiance(one.name, size)?;
            // How noisy it is alone is not said.
            report.lights.push(row(one.name, None, None, &linear, &radiance.linear));
        }
        if let Some(folder) = &args.out {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            let sheet = picture::beside(&[&ours, &reference, &map]);
            picture::write(&sheet, &folder.join(format!("{}.png", view.name)))?;
        }
        bar.inc(1);
    }
    for Pair { view, unshadowed } in &pairs {
        let stage = stage(&mut last, view, &folders, args.samples)?;
        let ours = stage.draw_once(view, &scenes, &args.shading)?;
        let size = ours[0].size();
        let reference =
            [folders.radiance(view.name, size)?.linear, folders.radiance(unshadowed, size)?.linear];
        report.shares.push(Share::new(view.name, &ours, &reference, &folders.mask(view, size)?));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if args.json {
        say!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        say!("{}", report.text().trim_end());
    }
    Ok(())
}

/// The stage with the groom of `view`: pictures of one groom follow each other.
fn stage<'a>(
    last: &'a mut Option<Rig>,
    view: &WantedView<'_>,
    folders: &Folders<'_>,
    samples: Option<u32>,
) -> Result<&'a mut Rig> {
    if last.as_ref().is_none_or(|stage| stage.groom() != view.groom_name) {
        *last = Some(Rig::new(view, folders, samples)?);
    }
    last.as_mut().context("the stage was made just now")
}

impl Report {
    /// As tables.
    fn text(&self) -> String {
        let mut text = String::new();
        let views = self.views.iter().chain(&self.lights).map(|row| &row.name);
        let names = views.chain(self.shares.iter().map(|row| &row.name));
        let wide = names.map(String::len).max().unwrap_or(0);
        for (rows, title) in [(&self.views, ""), (&self.lights, "\nEach light alone\n")] {
            if rows.is_empty() {
                continue;
            }
            let _ = writeln!(
                text,
                "{title}{:wide$}  {:>6}  {:>7}  {:>9}  {:>7}  {:>8}  {:>9}  {:>8}  {:>6}",
                "", "FLIP", "on hair", "luminance", "of hair", "dimmest", "brightest", "contrast", "skin"
            );
            for Row { name, difference, ours, reference } in rows {
                let flip =
                    difference.map(|found| [found.picture, found.hair].map(|flip| format!("{flip:.3}")));
                let [whole, hair] = flip.unwrap_or(["-", "-"].map(String::from));
                let say = |ratio: Option<f64>| ratio.map_or("-".into(), |ratio| format!("{ratio:.3}"));
                let [luminance, dimmest, brightest, contrast, skin] = ours.over(reference).map(say);
                let _ = writeln!(
                    text,
                    "{name:wide$}  {whole:>6}  {hair:>7}  {:9.4}  {luminance:>7}  {dimmest:>8}  {brightest:>9}  \
                     {contrast:>8}  {skin:>6}",
                    ours.luminance
                );
            }
        }
        if !self.views.is_empty() {
            let _ = writeln!(
                text,
                "\nLuminance is linear; what follows is ours over the reference's: of hair, of the dimmest and the \
                 brightest tenth of its pixels, contrast of what is finer than five pixels (the reference's noise \
                 taken off), skin without hair"
            );
        }
        if !self.shares.is_empty() {
            let _ = writeln!(
                text,
                "\nThe share of a light that arrives (scattered once, with shadows over without)\n\
                 {:wide$}  {:>8}  {:>9}  {:>10}  {:>10}",
                "", "ours", "reference", "mean error", "unshadowed"
            );
        }
        for row in &self.shares {
            let _ = writeln!(
                text,
                "{:wide$}  {:8.4}  {:9.4}  {:10.4}  {:10.4}",
                row.name, row.share, row.reference_share, row.error, row.unshadowed
            );
        }
        text
    }
}
