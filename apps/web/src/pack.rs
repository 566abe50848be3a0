//! Builds a page.

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

/// A page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Page {
    /// The studio.
    Studio,
    /// The studio's viewport as a custom element, `<tresses-viewer>`, packaged for npm.
    Viewer,
    /// The smallest program that renders hair: the library's example `minimal`.
    Minimal,
}

impl Page {
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
                ("tresses-viewer.d.ts", include_str!("../component/tresses-viewer.d.ts")),
                ("package.json", include_str!("../component/package.json")),
                ("README.md", include_str!("../component/README.md")),
                ("example.html", include_str!("../component/example.html")),
            ],
            Self::Minimal => &[("index.html", include_str!("../pages/minimal.html"))],
        }
    }
}

/// Sizes of the files that a visitor loads: name, bytes, bytes after gzip.
#[derive(Debug)]
pub struct Sizes(Vec<(String, u64, u64)>);

impl Sizes {
    /// Returns the size of all files after gzip, bytes.
    pub fn compressed(&self) -> u64 {
        self.0.iter().map(|(_, _, compressed)| compressed).sum()
    }

    /// Checks that the size does not exceed [`LIMIT`].
    ///
    /// # Errors
    /// Returns one sentence with both sizes.
    pub fn check(&self) -> Result<()> {
        let (size, limit) = (self.compressed(), LIMIT);
        if size > limit {
            bail!("the page has {size} compressed bytes, but the limit is {limit}");
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

/// Builds `page` into the folder `out`, creating it if necessary. `small` optimizes for size, for visitors. Otherwise
/// the build uses the dev profile, for tests: it is much faster, because build-time dependencies are already compiled.
///
/// # Errors
/// Fails if the program cannot be compiled or the folder cannot be written.
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
        .context("cannot start cargo")?;
    if !status.success() {
        bail!("cannot compile the page's program (see above)");
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
