//! Tests that need more than a compiler: a GPU adapter, a browser, a display.

use std::fmt::Display;

/// Skips a test that needs `what` ("gpu", "browser" or "window"), which is missing because of `reason`. The caller returns.
///
/// # Panics
/// Unless the environment variable `TRESSES_SKIP` lists `what`, as in `TRESSES_SKIP=gpu,browser,window`.
pub fn skip(what: &str, reason: impl Display) {
    let listed = std::env::var("TRESSES_SKIP").unwrap_or_default();
    let is_listed = listed.split(',').any(|other| other.trim() == what);
    assert!(
        is_listed,
        "{reason}; `make setup` installs what is missing, TRESSES_SKIP={what} skips such tests"
    );
    println!("skipped: {reason}");
}

/// Returns the opened GPU; `None` without an adapter, and the caller returns.
///
/// # Panics
/// As [`skip`].
pub fn gpu_or_skip<T>(opened: Result<T, impl Display>) -> Option<T> {
    opened.map_err(|error| skip("gpu", error)).ok()
}

/// Whether the command failed with `output` for want of a GPU adapter. The caller returns.
///
/// # Panics
/// As [`skip`].
pub fn lacks_gpu(output: &str) -> bool {
    let lacks = output.contains("no GPU adapter");
    if lacks {
        skip("gpu", output);
    }
    lacks
}
