//! `tresses sample`: sample files to try the other commands on.

use crate::{
    args::SourceArgs,
    export::{RestingCharacter, drawn_strands, write_body, write_strands},
    files,
    progress::TaskProgress,
    say,
};
use anyhow::{Context, Result};
use std::path::PathBuf;
use tresses::groom::{
    Guides, Strands,
    export::{ExportHair, Writer},
    formats::ContentKind,
};
use tresses_scene::Preset;

/// Strands of the sample grooms.
const STRANDS: u32 = 2000;

/// The whole groom.
const GROOMS: [&str; 3] = ["groom.tfx", "groom.abc", "groom.usda"];

/// Options of `tresses sample`.
#[derive(clap::Args, Debug)]
pub struct SampleArgs {
    /// Folder for the files
    #[arg(value_name = "FOLDER", default_value = "samples")]
    pub folder: PathBuf,
}

/// Runs `tresses sample`.
pub fn run(args: &SampleArgs) -> Result<()> {
    std::fs::create_dir_all(&args.folder).with_context(|| args.folder.display().to_string())?;
    files::probe(&args.folder)?;
    let mut preset = Preset::default();
    SourceArgs { style: Some("bob".into()), ..Default::default() }.apply(&mut preset);
    preset.settings.set("style.strands", STRANDS)?;
    let preparing = TaskProgress::new("opening the GPU");
    let RestingCharacter { scene, head, rig, guides } = RestingCharacter::new(&preset, &preparing)?;
    let body = head.as_ref().context("the built-in character has a body")?;
    let strands = drawn_strands(&scene, [&scene.character.hair().strands])?;
    let at = |name: &str| args.folder.join(name);
    let mut messages = Vec::new();
    for name in GROOMS {
        let path = at(name);
        messages.push(write_strands(&path, Writer::of(&path)?, &strands)?);
    }
    let path = at("guides.tfx");
    messages.push(write_strands(&path, Writer::of(&path)?, &as_strands(&guides))?);
    for (name, rig) in [("head.obj", None), ("body.glb", rig.as_ref())] {
        let path = at(name);
        messages.push(write_body(&path, Writer::holding(&path, ContentKind::Mesh)?, body, rig)?);
    }
    let (path, look) = (at("character.glb"), scene.look(&preset.settings));
    let hair = [ExportHair { name: "hair", strands: &strands, packed: false, look: look.as_ref() }];
    files::write(&path, &Writer::of(&path)?.character(Some((body, rig.as_ref())), &hair)?)?;
    messages.push(format!("{}: body and hair", path.display()));
    drop(preparing);
    say!("{}", messages.join("\n"));
    Ok(())
}

/// Returns the rest poses of `guides` as strands.
fn as_strands(guides: &Guides) -> Strands {
    let mut strands = Strands::default();
    (0..guides.len()).for_each(|i| strands.push(guides.guide(i)));
    strands
}
