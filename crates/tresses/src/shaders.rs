//! Linked shaders: plain WGSL by module path, one per file with an entry point.

use crate::constants::TIERED;
use std::{borrow::Cow, sync::OnceLock};

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

/// Returns the text of a linked shader for a GPU: with the other values of [`TIERED`](crate::constants::TIERED).
pub fn for_gpu(text: &str) -> Cow<'_, str> {
    let mut text = Cow::Borrowed(text);
    for (name, software, gpu) in TIERED {
        let declared = format!("{name} = {software}u;");
        if text.contains(&declared) {
            text = Cow::Owned(text.replacen(&declared, &format!("{name} = {gpu}u;"), 1));
        }
    }
    text
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaders_of_gpus_differ_in_one_declaration() {
        for (name, software, gpu) in TIERED {
            let users: Vec<_> = all().iter().filter(|(_, wgsl)| wgsl.contains(name)).collect();
            assert!(!users.is_empty(), "{name}");
            for (module, wgsl) in users {
                assert!(wgsl.contains(&format!("{name} = {software}u;")), "{module}: {name}");
                let changed = for_gpu(wgsl);
                assert!(changed.contains(&format!("{name} = {gpu}u;")), "{module}: {name}");
                assert_eq!(changed.lines().count(), wgsl.lines().count(), "{module}");
            }
        }
        assert!(matches!(for_gpu("fn f() {}"), Cow::Borrowed(_)));
    }

    /// Returns the negated comparisons of floats in `wgsl`, and comparisons of a value with itself.
    fn nan_tests(wgsl: &str) -> Vec<&str> {
        let is_suspect = |statement: &&str| {
            let negated = statement.split("!(").skip(1).any(|rest| {
                let mut depth = 1;
                let end = rest.find(|c| {
                    depth += i32::from(c == '(') - i32::from(c == ')');
                    depth == 0
                });
                let inside = &rest[..end.unwrap_or(rest.len())];
                [" < ", " > ", " <= ", " >= "].iter().any(|operator| inside.contains(operator))
            });
            let same = [" == ", " != "].iter().any(|operator| {
                statement.split_once(operator).is_some_and(|(left, right)| {
                    let name = |c: char| c.is_alphanumeric() || "._[]".contains(c);
                    let left = &left[left.rfind(|c| !name(c)).map_or(0, |at| at + 1)..];
                    let right = &right[..right.find(|c| !name(c)).unwrap_or(right.len())];
                    !left.is_empty() && left == right
                })
            });
            negated || same
        };
        wgsl.split(['{', '}', ';']).filter(is_suspect).collect()
    }

    /// Metal compiles with fast math, which may drop comparisons that only NaN fails. `math::bits` compares bits.
    #[test]
    fn no_shader_detects_nan_by_comparing_floats() {
        for (name, wgsl) in all() {
            let found = nan_tests(wgsl);
            assert!(found.is_empty(), "{name}: use math::bits in place of {found:?}");
        }
        for text in ["if !(a > 0.0 && b < vec3(1.0).x) {", "let is_nan = x.y != x.y;"] {
            assert_eq!(nan_tests(text).len(), 1, "{text}");
        }
        assert!(nan_tests("if !(is_a || f(b)) && c < 1.0 { let d = e == f; }").is_empty());
    }
}
