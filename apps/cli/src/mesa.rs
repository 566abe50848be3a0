//! Mesa's device-selection layer prints "XDG_RUNTIME_DIR is invalid" several times on machines without a user session.

/// Replaces this process by one that runs the same command with the layer off, on Linux without a user session.
pub fn silence() {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::process::CommandExt;
        let is_set = |name| std::env::var_os(name).is_some();
        if is_set("XDG_RUNTIME_DIR") || is_set("NODEVICE_SELECT") {
            return;
        }
        let mut words = std::env::args_os();
        let (Ok(program), Some(name)) = (std::env::current_exe(), words.next()) else { return };
        // `exec` returns only on failure. The command then runs here, and the layer prints.
        let _ = std::process::Command::new(program).arg0(name).args(words).env("NODEVICE_SELECT", "1").exec();
    }
}
