//! The table as a page of documentation.

use super::{Change, SECTIONS, Value};
use std::fmt::Write;

/// `docs/knobs.md`.
pub fn markdown() -> String {
    let mut page = String::from(
        "# Parameters\n\n\
         Everything that can be changed while hair is shown. Written by `tresses knobs --markdown`; a test keeps it current.\n\n\
         A path such as `simulation.drag` is the key `drag` of the table `[simulation]` in a preset, and \
         `--set simulation.drag=5` on the command line; some parameters have a flag of their own. *auto* is as it suits \
         the style, the file or the colour. The last column says what a change costs: nothing (it shows in the next frame), \
         *strands* (they are grown again) or *pipelines* (they are built again). The studio folds those marked *advanced* away.\n",
    );
    for section in SECTIONS {
        // Writing to a string cannot fail.
        let _ = write!(page, "\n## {}\n{}\n\n", section.title, section.about);
        page.push_str(
            "| path | what it does | allowed | default | flag | costs |\n|---|---|---|---|---|---|\n",
        );
        for knob in section.knobs {
            let cost = match knob.cost {
                Change::Frame => "",
                Change::Regrow => "strands",
                Change::Rebuild => "pipelines",
            };
            let default = match knob.default() {
                Value::Auto => "*auto*".to_owned(),
                value => knob.text(value),
            };
            let flag = knob.flag.map(|flag| format!("`--{}`", flag.name)).unwrap_or_default();
            let _ = writeln!(
                page,
                "| `{}` | **{}**. {}{} | {} | {default} | {flag} | {cost} |",
                knob.path,
                knob.label,
                knob.hint,
                if knob.advanced { " *Advanced.*" } else { "" },
                knob.range()
            );
        }
    }
    page
}
