//! `tresses knobs`: lists all parameters with their ranges and hints.

use crate::say;
use anyhow::{Result, ensure};
use tresses_scene::{
    Change,
    knobs::{
        SECTIONS,
        light_list::{self, LightField},
        markdown,
    },
};

/// Options of `tresses knobs`.
#[derive(clap::Args, Debug)]
pub struct KnobsArgs {
    /// List only parameters whose path, name or hint contains this, such as wind or simulation.drag
    #[arg(value_name = "WORD")]
    pub word: Option<String>,
    /// Print docs/reference/parameters.md
    #[arg(long, conflicts_with = "word")]
    pub markdown: bool,
}

/// Runs `tresses knobs`.
pub fn run(args: &KnobsArgs) -> Result<()> {
    if args.markdown {
        say!("{}", markdown().trim_end());
        return Ok(());
    }
    let word = args.word.as_deref().unwrap_or_default().to_lowercase();
    let mut found = false;
    for section in SECTIONS {
        let matches = |text: &str| text.to_lowercase().contains(&word);
        let knobs: Vec<_> = section
            .knobs
            .iter()
            .filter(|knob| matches(knob.path) || matches(knob.label) || matches(knob.hint))
            .collect();
        if knobs.is_empty() {
            continue;
        }
        if found {
            say!("");
        }
        found = true;
        say!("{}: {}", section.title, section.about);
        for knob in knobs {
            let cost = match knob.cost {
                Change::Frame => "",
                Change::Regrow => "; rebuilds strands",
                Change::Rebuild => "; recreates pipelines",
            };
            say!("  {} = {} ({}{cost})", knob.path, knob.text(knob.default()), knob.range());
            say!("      {}", knob.hint);
        }
    }
    let matches = |field: &LightField| {
        let text = format!("{} {} {}", light_list::PATH, field.key, field.hint).to_lowercase();
        text.contains(&word)
    };
    let fields: Vec<_> = light_list::FIELDS.iter().filter(|field| matches(field)).collect();
    if !fields.is_empty() {
        say!(
            "{}List of lights, {}: `tresses render --help` describes --light.",
            if found { "\n" } else { "" },
            light_list::PATH
        );
        found = true;
    }
    for field in fields {
        let shapes: Vec<_> = field.shapes.iter().map(|shape| shape.name()).collect();
        say!("  {} ({}): {}", field.key, field.range(), shapes.join(", "));
        say!("      {}", field.hint);
    }
    ensure!(found, "no parameter has {word} in its name or hint; without a word, all are listed");
    Ok(())
}
