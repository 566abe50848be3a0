use super::super::styles::{GridScalp, Style, guides};
use super::*;

#[test]
fn totals_are_exact() {
    let head = GridScalp::mannequin(96);
    let styled = guides(&Style::default(), &head);
    let grown = grow(&styled, &Growth::default().with_strands(1234), &head).unwrap();
    assert_eq!(grown.strands.len(), 1234);
}
