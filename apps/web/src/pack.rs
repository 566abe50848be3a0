//! Builds a page.

use crate::three;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use flate2::{Compression, write::GzEncoder};
use std::{
    fmt,
    io::Write,
    path::{Path, PathBuf},
    process::Command,
};
use wasm_bindgen_cli_support::Bindgen;

/// Size limit of the files that a visitor loads, bytes after gzip.
pub const LIMIT: u64 = 5_000_000;
/// Size limit of the files that a visitor loads in place of the program to see cards, bytes after gzip.
pub const CARDS_LIMIT: u64 = 250_000;

/// The module that draws cards.
const CARDS: &str = "tresses-cards.js";

/// A page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WebPage {
    /// The studio.
    Studio,
    /// The studio's viewport as a custom element, `<tresses-viewer>`, packaged for npm.
    Viewer,
    /// The smallest program that renders hair: the library's example `minimal`.
    Minimal,
}

impl WebPage {
    /// Returns cargo's arguments, and the file that cargo builds.
    fn program(self) -> (&'static [&'static str], &'static str) {
        match self {
            // Only this build makes the studio a `cdylib`; everywhere else it is a library.
            Self::Studio | Self::Viewer => {
                (&["--package", "tresses-studio", "--lib", "--crate-type", "cdylib"], "tresses_studio.wasm")
            }
            Self::Minimal => (&["--package", "tresses", "--example", "minimal"], "examples/minimal.wasm"),
        }
    }

    /// Returns names and contents of the files next to the program.
    fn files(self) -> &'static [(&'static str, &'static str)] {
        const ELEMENT: (&str, &str) = ("tresses-viewer.js", include_str!("../component/tresses-viewer.js"));
        match self {
            Self::Studio => &[("index.html", include_str!("../pages/studio.html")), ELEMENT],
            Self::Viewer => &[
                ELEMENT,
                (CARDS, include_str!("../component/tresses-cards.js")),
                ("tresses-viewer.d.ts", include_str!("../component/tresses-viewer.d.ts")),
                ("package.json", include_str!("../component/package.json")),
                ("README.md", include_str!("../component/README.md")),
                ("example.html", include_str!("../component/example.html")),
            ],
            Self::Minimal => &[("index.html", include_str!("../pages/minimal.html"))],
        }
    }
}

/// Name, bytes, and bytes after gzip of a file.
type Size = (String, u64, u64);

/// Sizes of the files that a visitor loads.
#[derive(Debug)]
pub struct Sizes {
    page: Vec<Size>,
    /// Files that replace the program where cards are drawn.
    cards: Vec<Size>,
}

impl Sizes {
    /// Returns the size after gzip of all files that a visitor with WebGPU loads, bytes.
    pub fn compressed(&self) -> u64 {
        compressed(&self.page)
    }

    /// Checks that the sizes do not exceed [`LIMIT`] and [`CARDS_LIMIT`].
    ///
    /// # Errors
    /// Returns one sentence with the size and its limit.
    pub fn check(&self) -> Result<()> {
        for (what, files, limit) in
            [("page", &self.page, LIMIT), ("drawing of cards", &self.cards, CARDS_LIMIT)]
        {
            let size = compressed(files);
            if size > limit {
                bail!("the {what} has {size} compressed bytes, but the limit is {limit}");
            }
        }
        Ok(())
    }
}

fn compressed(files: &[Size]) -> u64 {
    files.iter().map(|(_, _, compressed)| compressed).sum()
}

impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, raw: u64, compressed: u64| {
            writeln!(f, "{name:<28}{:>8} kB{:>8} kB with gzip", raw.div_ceil(1000), compressed.div_ceil(1000))
        };
        for (total, files) in [("all", &self.page), ("all for cards", &self.cards)] {
            for (name, raw, compressed) in files {
                line(name, *raw, *compressed)?;
            }
            if !files.is_empty() {
                line(total, files.iter().map(|(_, raw, _)| raw).sum(), compressed(files))?;
            }
        }
        Ok(())
    }
}

/// Builds `page` into the folder `out`, creating it if necessary. `small` optimizes for size, for visitors. Otherwise
/// the build uses the dev profile, for tests: it is much faster, because build-time dependencies are already compiled.
///
/// # Errors
/// Fails if the program cannot be compiled or the folder cannot be written.
pub fn pack(page: WebPage, out: &Path, small: bool) -> Result<Sizes> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let (what, file) = page.program();
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let mut cards = Vec::new();
    if page == WebPage::Viewer {
        cards = three::copy(&root.join("target/tools/three"), out)?;
        cards.push(CARDS.into());
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .current_dir(&root)
        .args(["rustc", "--locked", "--target", "wasm32-unknown-unknown"])
        .args(["--profile", if small { "web" } else { "dev" }])
        .args(what)
        .status()
        .context("cannot start cargo")?;
    if !status.success() {
        bail!("cannot compile the page's program (see above)");
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    Bindgen::new()
        .input_path(
            target.join("wasm32-unknown-unknown").join(if small { "web" } else { "debug" }).join(file),
        )
        .out_name("tresses")
        .web(true)?
        .typescript(false)
        .omit_default_module_path(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(out)
        .context("wasm-bindgen")?;
    for (name, text) in page.files() {
        std::fs::write(out.join(name), text).with_context(|| out.display().to_string())?;
    }
    let loaded = |name: &&str| (name.ends_with(".js") || name.ends_with(".html")) && *name != CARDS;
    let names = page.files().iter().map(|(name, _)| *name).filter(loaded);
    let sizes = |files: &[&str]| files.iter().map(|name| size(out, name)).collect::<Result<_>>();
    Ok(Sizes {
        page: sizes(&names.chain(["tresses.js", "tresses_bg.wasm"]).collect::<Vec<_>>())?,
        cards: sizes(&cards.iter().map(String::as_str).collect::<Vec<_>>())?,
    })
}

fn size(folder: &Path, name: &str) -> Result<Size> {
    let bytes = std::fs::read(folder.join(name)).with_context(|| name.to_owned())?;
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    gzip.write_all(&bytes)?;
    Ok((name.into(), bytes.len() as u64, gzip.finish()?.len() as u64))
}
