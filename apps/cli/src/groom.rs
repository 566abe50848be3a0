//! `tresses groom`: applies recorded strokes of a brush to a groom or a built-in style.

use crate::{
    args::Size, files, picture::OutputKind, progress::TaskProgress, say, settings_args::SettingsArgs,
    timelapse::Timelapse,
};
use anyhow::{Context, Result, ensure};
use std::{path::PathBuf, time::Instant};
use tresses::{
    Gpu,
    groom::{
        edit::{StrokeScript, file},
        formats,
    },
};

/// Options of `tresses groom`.
#[derive(clap::Args, Debug)]
pub struct GroomArgs {
    #[command(flatten)]
    pub settings: SettingsArgs,
    /// Strokes to apply: JSON lines, as the studio records them
    #[arg(long, value_name = "FILE")]
    pub strokes: Option<PathBuf>,
    /// File for the edited groom with its head, which every command opens
    #[arg(long, value_name = "FILE.groom", default_value = "out/hair.groom")]
    pub out: PathBuf,
    /// Film of the strokes: an animation (.webp, .gif, .apng), a video (.mp4, .webm; needs ffmpeg) or numbered frames
    #[arg(long, value_name = "PATH", requires = "strokes")]
    pub film: Option<PathBuf>,
    /// Size of the film, pixels
    #[arg(long, value_name = "WxH", default_value = "640x640", requires = "film")]
    pub size: Size,
    /// Print a hash of the guides: equal strokes give equal hashes on every machine
    #[arg(long)]
    pub hash: bool,
}

/// Runs `tresses groom`.
pub fn run(args: &GroomArgs) -> Result<()> {
    let is_groom = formats::extension(&args.out) == file::EXTENSION;
    ensure!(is_groom, "{}: an edited groom is a .groom file", args.out.display());
    files::prepare(&args.out)?;
    if let Some(film) = &args.film {
        let kind = OutputKind::of(film)?;
        ensure!(!kind.is_still(), "{}: a film is an animation, a video or numbered frames", film.display());
    }
    let script = match &args.strokes {
        Some(path) => {
            let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
            StrokeScript::read(&text, path)?
        }
        None => StrokeScript::default(),
    };
    let preset = args.settings.preset()?;
    let preparing = TaskProgress::new("opening the GPU");
    let gpu = pollster::block_on(Gpu::open())?;
    let (source, mut editor) = pollster::block_on(preset.editor(&gpu.context, &preparing))?;
    let before = editor.document().clone();
    let begin = Instant::now();
    let (strokes, film) = match &args.film {
        Some(path) => {
            drop(preparing);
            let film = Timelapse::new(gpu, &preset, &source, path, args.size)?;
            let (strokes, film) = film.film(&mut editor, &script)?;
            (strokes, Some(film))
        }
        None => (script.apply(&mut editor)?.len(), None),
    };
    let seconds = begin.elapsed().as_secs_f64();
    let after = editor.document();
    let bytes = after.write();
    files::write(&args.out, &bytes)?;
    let (now, was) = (after.guides().len(), before.guides().len());
    let changed_guides = (0..now).filter(|i| now == was && after.guide(*i) != before.guide(*i)).count();
    let guides = if now == was {
        format!("{changed_guides} of {now} guides moved")
    } else {
        format!("{now} guides instead of {was}")
    };
    say!(
        "{}: {} strokes, {guides}: {} dabs of {:.2} ms; {} strands, {:.1} MB",
        args.out.display(),
        strokes,
        editor.dab_count(),
        1e3 * seconds / editor.dab_count().max(1) as f64,
        after.base().strands.len(),
        bytes.len() as f64 / 1e6
    );
    if let Some(film) = film {
        say!("{film}");
    }
    if args.hash {
        say!("{:016x}", after.hash());
    }
    Ok(())
}
