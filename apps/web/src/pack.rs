//! Building a page.

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

/// The most bytes that a page may have a visitor load, compressed as every server can.
pub const LIMIT: u64 = 5_000_000;

/// The pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Page {
    /// The studio.
    Studio,
    /// The studio's picture as an element for pages of others, `<tresses-viewer>`: a package for npm.
    Viewer,
    /// The smallest program with hair: the library's example `minimal`.
    Minimal,
}

impl Page {
    /// What cargo builds, and the file that comes of it.
    fn program(self) -> (&'static [&'static str], &'static str) {
        match self {
            // Only here is the studio a module of its own; everywhere else it is a library.
            Self::Studio | Self::Viewer => {
                (&["--package", "tresses-studio", "--lib", "--crate-type", "cdylib"], "tresses_studio.wasm")
            }
            Self::Minimal => (&["--package", "tresses", "--example", "minimal"], "examples/minimal.wasm"),
        }
    }

    /// What lies beside the program: names and texts.
    fn files(self) -> &'static [(&'static str, &'static str)] {
        const ELEMENT: (&str, &str) = ("tresses-viewer.js", include_str!("../component/tresses-viewer.js"));
        match self {
            Self::Studio => &[("index.html", include_str!("../pages/studio.html")), ELEMENT],
            Self::Viewer => &[
                ELEMENT,
                ("tresses-viewer.d.ts", include_str!("../component/tresses-viewer.d.ts")),
                ("package.json", include_str!("../component/package.json")),
                ("README.md", include_str!("../component/README.md")),
                ("example.html", include_str!("../component/example.html")),
            ],
            Self::Minimal => &[("index.html", include_str!("../pages/minimal.html"))],
        }
    }
}

/// What a visitor loads: name, bytes, bytes compressed by gzip.
#[derive(Debug)]
pub struct Sizes(Vec<(String, u64, u64)>);

impl Sizes {
    /// Bytes of all files, compressed.
    pub fn compressed(&self) -> u64 {
        self.0.iter().map(|(_, _, compressed)| compressed).sum()
    }

    /// Fails when that is more than [`LIMIT`].
    ///
    /// # Errors
    /// One sentence.
    pub fn check(&self) -> Result<()> {
        let (size, limit) = (self.compressed(), LIMIT);
        if size > limit {
            bail!("the page takes {size} bytes compressed, more than the {limit} it may");
        }
        Ok(())
    }
}

impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, raw: u64, compressed: u64| {
            writeln!(f, "{name:<24}{:>8} kB{:>8} kB with gzip", raw.div_ceil(1000), compressed.div_ceil(1000))
        };
        for (name, raw, compressed) in &self.0 {
            line(name, *raw, *compressed)?;
        }
        line("all", self.0.iter().map(|(_, raw, _)| raw).sum(), self.compressed())
    }
}

/// Builds `page` into the folder `out`, which is made: small, for visitors, or with the profile of everything
/// else, for tests, which compiles much faster as what runs while compiling is there already.
///
/// # Errors
/// When the program cannot be compiled, or the folder not be written.
pub fn pack(page: Page, out: &Path, small: bool) -> Result<Sizes> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let (what, file) = page.program();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .current_dir(&root)
        .args(["rustc", "--locked", "--target", "wasm32-unknown-unknown"])
        .args(["--profile", if small { "web" } else { "dev" }])
        .args(what)
        .status()
        .context("cargo cannot be started")?;
    if !status.success() {
        bail!("the page's program cannot be compiled (see above)");
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
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
    let loaded = |name: &&str| name.ends_with(".js") || name.ends_with(".html");
    let names = page.files().iter().map(|(name, _)| *name).filter(loaded);
    let files: Vec<_> = names.chain(["tresses.js", "tresses_bg.wasm"]).collect();
    files.iter().map(|name| size(out, name)).collect::<Result<_>>().map(Sizes)
}

fn size(folder: &Path, name: &str) -> Result<(String, u64, u64)> {
    let bytes = std::fs::read(folder.join(name)).with_context(|| name.to_owned())?;
    let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
    gzip.write_all(&bytes)?;
    Ok((name.into(), bytes.len() as u64, gzip.finish()?.len() as u64))
}
