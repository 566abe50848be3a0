//! The kernel of one fixed step.

use crate::{constants::GUIDE_CAPACITIES, gpu::Binding};

/// Bindings of the kernel, in order.
pub(crate) const BINDINGS: [Binding; 7] = [
    Binding::StorageDynamic,
    Binding::Storage,
    Binding::Storage,
    Binding::StorageMut,
    Binding::StorageMut,
    Binding::Storage,
    Binding::StorageMut,
];

/// Returns the index of the smallest of [`GUIDE_CAPACITIES`] that holds `vertex_count`.
pub(crate) fn capacity(vertex_count: u32) -> usize {
    GUIDE_CAPACITIES.iter().position(|c| *c >= vertex_count).unwrap_or(GUIDE_CAPACITIES.len() - 1)
}

/// The shaders, one per entry of [`GUIDE_CAPACITIES`].
pub(crate) const MODULES: [&str; GUIDE_CAPACITIES.len()] = [
    "simulate::step::8",
    "simulate::step::16",
    "simulate::step::24",
    "simulate::step::32",
    "simulate::step::48",
    "simulate::step::64",
];

/// The shaders for hair with twist.
pub(crate) const TWIST_MODULES: [&str; GUIDE_CAPACITIES.len()] = [
    "simulate::twist::8",
    "simulate::twist::16",
    "simulate::twist::24",
    "simulate::twist::32",
    "simulate::twist::48",
    "simulate::twist::64",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_capacity_has_its_own_shader() {
        assert_eq!(GUIDE_CAPACITIES.map(|capacity| format!("simulate::step::{capacity}")), MODULES);
        assert_eq!(GUIDE_CAPACITIES.map(|capacity| format!("simulate::twist::{capacity}")), TWIST_MODULES);
        let sources = MODULES.map(crate::shaders::source);
        assert!((1..sources.len()).all(|i| !sources[..i].contains(&sources[i])));
        assert_eq!([2, 8, 9, 64].map(capacity), [0, 0, 1, 5]);
    }
}
