//! `tresses studio`: the window.

use crate::orient_args::OrientArgs;
use anyhow::Result;
use std::path::PathBuf;
use tresses::groom::styles::Style;

/// What the window shows first; everything can be changed there.
#[derive(clap::Args)]
pub struct Args {
    /// Files of one groom (.hair, .tfx, .obj and others, see `tresses info`) [default: a built-in style]
    grooms: Vec<PathBuf>,
    /// Meshes of the head that the groom grows on
    #[arg(long, value_name = "MESH", requires = "grooms")]
    head: Vec<PathBuf>,
    /// Built-in style: long, bob, curly or short
    #[arg(long, value_name = "STYLE", conflicts_with = "grooms", value_parser = style)]
    style: Option<String>,
    #[command(flatten)]
    orientation: OrientArgs,
}

fn style(name: &str) -> Result<String> {
    Ok(name.parse::<Style>()?.name().into())
}

/// Opens the window and returns when it is closed.
pub fn run(args: Args) -> Result<()> {
    let Args { grooms, head, style, orientation } = args;
    let import = orientation.options();
    tresses_studio::run(tresses_studio::Options { grooms, heads: head, style, import, ..Default::default() })
}
