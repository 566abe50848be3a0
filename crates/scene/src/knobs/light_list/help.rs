//! Help texts of the list of lights.

use super::{FIELDS, KeyPresence, LightField, SHAPE, fields, shapes};
use crate::{knobs::flags::sentence, settings::LightKind};

/// Returns the help text of [`FLAG`]: shapes with their keys, and the keys.
pub fn flag_help() -> String {
    let mut help = String::from(
        "A shape and its values, as in \"spot position=0.3,0.3,0.5 target=0,0.1,0 intensity=2 color=#ffaa66\". \
         AZIMUTH,ELEVATION[,IRRADIANCE] is short for a distant light. The lights replace those of a preset.\n\nShapes:",
    );
    for kind in LightKind::ALL {
        help += &format!("\n- {}:", kind.name());
        let (required, others): (Vec<_>, Vec<_>) =
            fields(kind).partition(|field| field.presence == KeyPresence::Required);
        // Keys of most shapes are in the list of values only.
        let own = others.iter().filter(|field| field.shapes.len() < LightKind::ALL.len() - 1);
        let keys: Vec<_> = required.iter().map(|field| field.key.to_owned()).collect();
        let others: Vec<_> = own.map(|field| format!("[{}]", field.key)).collect();
        help += &format!(" {}", [keys, others].concat().join(", "));
    }
    help += "\n\nValues; positions are X,Y,Z in the space of the groom, which `tresses info` describes:";
    for field in FIELDS {
        let default = match (field.presence, field.default()) {
            (KeyPresence::Required, _) => String::new(),
            (_, text) if text.is_empty() => String::new(),
            (_, text) => format!(" [default: {text}]"),
        };
        help += &format!("\n- {}: {} {}{default}", field.key, field.hint, sentence(&field.range()));
    }
    help
}

/// Returns the table of keys in `docs/reference/parameters.md`.
pub(in crate::knobs) fn markdown() -> String {
    let mut page = String::from(
        "\n### List of lights\n\
         `lights.list` holds any number of lights, which stay in place: the tables `[[lights.list]]` in a preset, \
         `--light` on the command line, a list of dicts in Python. Lengths are meters, angles degrees. Positions are in \
         the space of the groom: x to the left of the head, y up, z to the front. A text such as \
         `spot position=0.3,0.3,0.5 target=0,0.1,0 intensity=2` is a light, too; `--set lights.list=…`, queries of the \
         page and its scripts take such texts, separated by semicolons.\n\n\
         | key | meaning | shapes | allowed | default |\n|---|---|---|---|---|\n",
    );
    page += &format!("| `{SHAPE}` | **Shape**. | | {} | required |\n", shapes());
    for field in FIELDS {
        let LightField { key, label, hint, shapes, presence, .. } = field;
        let shapes = match *shapes == LightKind::ALL {
            true => "all".to_owned(),
            false => shapes.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", "),
        };
        let (range, default) = (field.range(), field.default());
        let default = if *presence == KeyPresence::Required { "required" } else { &default };
        page += &format!("| `{key}` | **{label}**. {hint} | {shapes} | {range} | {default} |\n");
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_lists_every_shape_and_key() {
        let help = flag_help();
        for kind in LightKind::ALL {
            assert!(help.contains(&format!("\n- {}:", kind.name())), "{}", kind.name());
        }
        for field in FIELDS {
            assert!(help.contains(&format!("\n- {}: {}", field.key, field.hint)), "{}", field.key);
        }
    }
}
