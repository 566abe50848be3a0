//! Linked shaders: plain WGSL by module path, one per file with an entry point.

use std::sync::OnceLock;

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The bindings of each compute shader as a struct with named fields, for [`crate::gpu::Kernel`].
pub(crate) mod kernels {
    include!(concat!(env!("OUT_DIR"), "/kernels.rs"));
}

/// Returns the linked WGSL of `module`, for example `simulate::links` or `simulate::step::16`.
pub(crate) fn source(module: &str) -> &'static str {
    find(module).1
}

/// Returns the module path that equals `module`, from the table.
pub(crate) fn named(module: &str) -> &'static str {
    find(module).0
}

fn find(module: &str) -> (&'static str, &'static str) {
    let found = all().iter().find(|(name, _)| *name == module);
    *found.unwrap_or_else(|| panic!("no shader {module}"))
}

/// Returns every linked shader as (module path, WGSL), for tools and tests.
pub fn all() -> &'static [(&'static str, &'static str)] {
    static ALL: OnceLock<Vec<(&str, &str)>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut all = PLAIN.to_vec();
        for (module, text, line, values) in VARIED {
            // `line` declares the first of the values.
            let (first, declared) = (values[0], line.trim_end_matches(|c: char| c != '='));
            for value in *values {
                let text = match *value == first {
                    true => text,
                    false => &*text.replacen(line, &format!("{declared} {value}u;"), 1).leak(),
                };
                all.push((&*format!("{module}::{value}").leak(), text));
            }
        }
        all
    })
}
