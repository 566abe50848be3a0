//! Comparisons with other renderers, from `peers.toml`.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

const FILE: &str = include_str!("../../peers.toml");

/// A renderer, and how it was compared.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Peer {
    /// Its name.
    pub name: String,
    /// Its page.
    pub url: String,
    /// The measured version.
    pub version: String,
    /// Scene and machine.
    pub method: String,
    /// The command that measured it.
    pub command: String,
    /// The command that measured Tresses.
    #[serde(rename = "ours")]
    pub tresses_command: String,
    /// The figures.
    #[serde(rename = "figure")]
    pub figures: Vec<Figure>,
}

/// Milliseconds per frame of both.
#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// The measured part.
    pub scene: String,
    /// The day of the measurement.
    pub date: String,
    /// The clock.
    pub clock: String,
    /// Tresses, milliseconds.
    #[serde(rename = "ours")]
    pub tresses_ms: u64,
    /// The peer, milliseconds.
    #[serde(rename = "theirs")]
    pub peer_ms: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PeerFile {
    #[serde(rename = "peer")]
    peers: Vec<Peer>,
}

/// Reads the comparisons.
pub fn read() -> Result<Vec<Peer>> {
    Ok(toml::from_str::<PeerFile>(FILE).context("tools/evidence/peers.toml")?.peers)
}
