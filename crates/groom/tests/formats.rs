//! The table of formats in the documentation.

// Without a feature its formats are not written, and rows differ.
#![cfg(all(feature = "alembic", feature = "cooked", feature = "gltf", feature = "usd"))]

use tresses_groom::formats::{Content, FORMATS, listed, markdown};

#[test]
fn the_documentation_has_the_table() {
    let (page, table) = (include_str!("../../../docs/grooms.md"), markdown());
    assert!(page.contains(&table), "put this table into docs/grooms.md:\n{table}");
}

#[test]
fn the_web_component_names_what_it_opens() {
    let page = include_str!("../../../apps/web/component/README.md");
    let read = FORMATS.iter().filter(|format| format.in_browsers && format.reads.contains(&Content::Strands));
    let all: Vec<_> = read.flat_map(|format| format.extensions.iter().copied()).collect();
    let all = listed(&all, "or");
    assert!(page.contains(&all), "apps/web/component/README.md does not list {all}");
}
