//! The table of formats in the documentation.

// A disabled feature changes the rows of its formats.
#![cfg(all(
    feature = "alembic",
    feature = "cooked",
    feature = "edit",
    feature = "gltf",
    feature = "npz",
    feature = "usd"
))]

use tresses_groom::formats::{ContentKind, FORMATS, listed, markdown};

#[test]
fn docs_contain_format_table() {
    let (page, table) = (include_str!("../../../docs/reference/formats.md"), markdown());
    assert!(page.contains(&table), "put this table into docs/reference/formats.md:\n{table}");
}

#[test]
fn web_component_lists_readable_formats() {
    let page = include_str!("../../../apps/web/component/README.md");
    let read =
        FORMATS.iter().filter(|format| format.in_browsers && format.reads.contains(&ContentKind::Strands));
    let all: Vec<_> = read.flat_map(|format| format.extensions.iter().copied()).collect();
    let all = listed(&all, "or");
    assert!(page.contains(&all), "apps/web/component/README.md does not list {all}");
}
