//! `tresses compare`: compares renders with path-traced ones of the same hair, camera and lights. It reports the
//! perceived difference (FLIP) and the light on hair and skin ([`tones`]), for all lights together and for each light
//! alone where the reference has that.
//!
//! Strands and head are read unchanged from the files that the reference names. Nothing is oriented, simulated or
//! fitted, so only rendering differs. If the reference has images of each light's single scattering, the light is split
//! by how often it was scattered ([`orders`]). If it has them with and without shadows, the transmitted fractions are
//! compared too ([`transmission`]). A crowd is compared head by head ([`heads`]).

mod heads;
mod lights;
mod metrics;
mod orders;
mod rig;
mod scenes;
mod tones;
mod transmission;

use crate::{
    args,
    flags::{FlagSet, RowFlags},
    picture, progress, say,
};
use anyhow::{Context, Result, ensure};
use heads::HeadLuminance;
use metrics::{Difference, Linear};
use orders::ScatteringOrders;
use rig::ReferenceScene;
use scenes::{Folders, ONCE, Pair, ReferenceView, Scenes};
use serde::Serialize;
use std::{fmt::Write, path::PathBuf};
use tones::{Regions, Tones};
use transmission::Transmission;
use tresses_scene::knobs::Flag;

/// Options of `tresses compare`.
#[derive(clap::Args, Debug)]
pub struct CompareArgs {
    /// Description of the reference images (scenes.json), in the same folder as the images
    #[arg(value_name = "FILE")]
    pub scenes: PathBuf,
    /// Folder of the grooms that the description calls assets [default: $TRESSES_ASSETS]
    #[arg(long, value_name = "FOLDER")]
    pub assets: Option<PathBuf>,
    /// Compare only this image; may be repeated [default: all images with all lights]
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Samples per pixel: 1, 4, 8 or 16 [default: 8, or as many as the adapter offers]
    #[arg(long, value_name = "N", value_parser = args::samples)]
    pub samples: Option<u32>,
    #[command(flatten)]
    pub shading: RowFlags<Shading>,
    /// Folder for side-by-side images of render, reference and difference
    #[arg(long, value_name = "FOLDER")]
    pub out: Option<PathBuf>,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
}

/// The parameters that `compare` has flags for.
#[derive(Clone, Debug, Default)]
pub struct Shading;

impl FlagSet for Shading {
    fn has(flag: &Flag) -> bool {
        ["shading", "melanin", "roughness", "ambient", "ambient-cells", "shadows", "strand-map"]
            .contains(&flag.name)
    }
}

/// One view, our render against the reference.
#[derive(Debug, Serialize)]
struct Row {
    name: String,
    /// FLIP difference; `None` for images of a single light.
    #[serde(flatten)]
    difference: Option<Difference>,
    #[serde(rename = "ours")]
    rendered: Tones,
    reference: Tones,
}

/// All results.
#[derive(Debug, Default, Serialize)]
struct Report {
    /// Views with all lights.
    views: Vec<Row>,
    /// Views with one light alone.
    lights: Vec<Row>,
    /// The light of lamps by how often it was scattered.
    orders: Vec<ScatteringOrders>,
    /// The heads of crowds.
    heads: Vec<HeadLuminance>,
    /// Transmitted fractions of single lights.
    #[serde(rename = "shares")]
    transmissions: Vec<Transmission>,
}

/// Runs `tresses compare`.
pub fn run(args: &CompareArgs) -> Result<()> {
    let assets = args.assets.clone().or_else(|| std::env::var_os("TRESSES_ASSETS").map(PathBuf::from));
    let folders = Folders { scenes: &args.scenes, assets: assets.as_deref() };
    let scenes = Scenes::read(&args.scenes)?;
    let (views, pairs) = (scenes.views(&args.only)?, scenes.pairs(&args.only)?);
    ensure!(
        !(views.is_empty() && pairs.is_empty()),
        "{}: no image matches the options",
        args.scenes.display()
    );
    let bar = progress::frames("comparing", (views.len() + pairs.len()) as u64);
    let mut report = Report::default();
    let mut last = None;
    for view in &views {
        let stage = stage(&mut last, view, &folders, args.samples)?;
        let rendered = stage.draw(view, &scenes, &args.shading)?;
        let linear = stage.radiance(view, &scenes, &args.shading)?;
        let reference = folders.picture(view.name)?;
        let mask = folders.mask(view, (rendered.width, rendered.height))?;
        ensure!(
            (rendered.width, rendered.height) == (reference.width, reference.height),
            "{}: the reference is {} × {} pixels, but its description says {} × {}",
            view.name,
            reference.width,
            reference.height,
            rendered.width,
            rendered.height
        );
        let (difference, map) = metrics::flip(&reference, &rendered, &mask);
        let size = (rendered.width, rendered.height);
        let radiance = folders.radiance(view.name, size)?;
        let regions = Regions::new(&mask, &radiance);
        let row = |name: &str, difference, noise, rendered: &Linear, reference: &Linear| Row {
            name: name.to_owned(),
            difference,
            rendered: Tones::new(rendered, &regions, Some(0.0)),
            reference: Tones::new(reference, &regions, noise),
        };
        report.views.push(row(view.name, Some(difference), Some(view.noise), &linear, &radiance.linear));
        if let Some(owners) = folders.heads(view, size)? {
            report.heads.extend(HeadLuminance::of_view(view.name, &owners, &linear, &radiance.linear));
        }
        let mut once = Vec::new();
        for one in view.single_lights() {
            let linear = stage.radiance(&one, &scenes, &args.shading)?;
            let radiance = folders.radiance(one.name, size)?;
            // The noise of images of a single light is unknown.
            let row = row(one.name, None, None, &linear, &radiance.linear);
            if one.once {
                once.push(row);
            } else {
                report.lights.push(row);
            }
        }
        for once in &once {
            let all = report.lights.iter().find(|all| Some(&*all.name) == once.name.strip_suffix(ONCE));
            report.orders.extend(all.map(|all| ScatteringOrders::new(all, once)));
        }
        if let Some(folder) = &args.out {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            let sheet = picture::side_by_side(&[&rendered, &reference, &map]);
            picture::write(&sheet, &folder.join(format!("{}.png", view.name)))?;
        }
        bar.inc(1);
    }
    for Pair { view, unshadowed } in &pairs {
        let stage = stage(&mut last, view, &folders, args.samples)?;
        let rendered = stage.draw_once(view, &scenes, &args.shading)?;
        let size = rendered[0].size();
        let reference =
            [folders.radiance(view.name, size)?.linear, folders.radiance(unshadowed, size)?.linear];
        report.transmissions.push(Transmission::new(
            view.name,
            &rendered,
            &reference,
            &folders.mask(view, size)?,
        ));
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

/// Returns the rig with the groom of `view`. Consecutive views of one groom share it.
fn stage<'a>(
    last: &'a mut Option<ReferenceScene>,
    view: &ReferenceView<'_>,
    folders: &Folders<'_>,
    samples: Option<u32>,
) -> Result<&'a mut ReferenceScene> {
    if last.as_ref().is_none_or(|stage| stage.groom() != view.groom_name) {
        *last = Some(ReferenceScene::new(view, folders, samples)?);
    }
    last.as_mut().context("the stage was made just now")
}

/// Formats a ratio.
fn ratio(found: Option<f64>) -> String {
    found.map_or("-".into(), |ratio| format!("{ratio:.3}"))
}

impl Report {
    /// Formats the results as tables.
    fn text(&self) -> String {
        let mut text = String::new();
        let views = self.views.iter().chain(&self.lights).map(|row| &row.name);
        let names = views.chain(self.transmissions.iter().map(|row| &row.name));
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
            for Row { name, difference, rendered, reference } in rows {
                let flip =
                    difference.map(|found| [found.picture, found.hair].map(|flip| format!("{flip:.3}")));
                let [image, hair] = flip.unwrap_or(["-", "-"].map(String::from));
                let [luminance, dimmest, brightest, contrast, skin] = rendered.over(reference).map(ratio);
                let _ = writeln!(
                    text,
                    "{name:wide$}  {image:>6}  {hair:>7}  {:9.4}  {luminance:>7}  {dimmest:>8}  {brightest:>9}  \
                     {contrast:>8}  {skin:>6}",
                    rendered.luminance
                );
            }
        }
        if !self.views.is_empty() {
            let _ = writeln!(
                text,
                "\nLuminance is linear. The following columns are ratios, ours over the reference's: hair, the dimmest and the \
                 brightest tenth of its pixels, contrast of details finer than five pixels (without the reference's \
                 noise), and skin without hair"
            );
        }
        if !self.orders.is_empty() {
            let _ = writeln!(
                text,
                "\nEach light by how often it was scattered, ratios to the reference\n\
                 {:wide$}  {:>10}  {:>6}  {:>7}  {:>6}  {:>6}  {:>6}",
                "", "once, part", "once", "several", "red", "green", "blue"
            );
        }
        for ScatteringOrders { name, once_fraction, once, several, channels } in &self.orders {
            let [red, green, blue] = channels.map(ratio);
            let [once, several] = [once, several].map(|found| ratio(*found));
            let _ = writeln!(
                text,
                "{name:wide$}  {once_fraction:10.2}  {once:>6}  {several:>7}  {red:>6}  {green:>6}  {blue:>6}"
            );
        }
        if !self.heads.is_empty() {
            let _ = writeln!(
                text,
                "\nHair of each head of a crowd, linear luminance\n\
                 {:wide$}  {:>4}  {:>6}  {:>9}  {:>9}  {:>6}",
                "", "head", "pixels", "ours", "reference", "ratio"
            );
        }
        for row in &self.heads {
            let HeadLuminance { name, head, pixels, rendered, reference } = row;
            let ratio = ratio(row.ratio());
            let _ = writeln!(
                text,
                "{name:wide$}  {head:4}  {pixels:6}  {rendered:9.4}  {reference:9.4}  {ratio:>6}"
            );
        }
        if !self.transmissions.is_empty() {
            let _ = writeln!(
                text,
                "\nTransmitted fraction of each light (single scattering, with shadows over without)\n\
                 {:wide$}  {:>8}  {:>9}  {:>10}  {:>10}",
                "", "ours", "reference", "mean error", "unshadowed"
            );
        }
        for row in &self.transmissions {
            let _ = writeln!(
                text,
                "{:wide$}  {:8.4}  {:9.4}  {:10.4}  {:10.4}",
                row.name, row.fraction, row.reference_fraction, row.error, row.unshadowed
            );
        }
        text
    }
}
