//! The linked shaders: plain WGSL, one per entry-point file, by module path.

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The linked WGSL of `module`, for example `simulate::step`.
pub(crate) fn source(module: &str) -> &'static str {
    ALL.iter()
        .find(|(name, _)| *name == module)
        .map(|(_, wgsl)| *wgsl)
        .unwrap_or_else(|| panic!("no shader {module}"))
}

/// Every linked shader as (module path, WGSL), for tools and tests.
pub fn all() -> &'static [(&'static str, &'static str)] {
    ALL
}
