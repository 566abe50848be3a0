//! The kernel of one fixed step.

use crate::{gpu::Binding, shaders};

/// Bindings of the kernel, in order.
pub(crate) const BINDINGS: [Binding; 8] = [
    Binding::UniformDynamic,
    Binding::Storage,
    Binding::Storage,
    Binding::Storage,
    Binding::StorageMut,
    Binding::StorageMut,
    Binding::StorageMut,
    Binding::Storage,
];

/// The vertex counts that the kernel is specialised for.
pub(crate) const CAPACITIES: [u32; 6] = [8, 16, 24, 32, 48, 64];

/// The smallest capacity that holds `vertex_count`.
pub(crate) fn capacity(vertex_count: u32) -> usize {
    CAPACITIES.iter().position(|c| *c >= vertex_count).unwrap_or(CAPACITIES.len() - 1)
}

/// The linked shader with room for `capacity` vertices.
///
/// WGSL sizes private arrays by constants, not by pipeline overrides, so the number is replaced
/// in the text.
pub(crate) fn source(capacity: u32) -> String {
    let source = shaders::source("simulate::step");
    let from = "CAPACITY: u32 = 64u;";
    debug_assert_eq!(source.matches(from).count(), 1);
    source.replacen(from, &format!("CAPACITY: u32 = {capacity}u;"), 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_capacity_is_in_the_text() {
        for capacity in CAPACITIES {
            assert!(source(capacity).contains(&format!("CAPACITY: u32 = {capacity}u;")));
        }
        assert_eq!([2, 8, 9, 64].map(capacity), [0, 0, 1, 5]);
    }
}
