//! Ctrl-C ends the program at once: a frame, or a driver's compilation, may take many seconds and cannot be canceled.
//! Files are written atomically ([`files`]), so none is left incomplete.

use crate::{files, progress};

/// Exit code after Ctrl-C.
const EXIT_CODE: i32 = 130;

/// Installs the Ctrl-C handler.
pub fn listen() {
    let handler = || {
        progress::clear();
        eprintln!("tresses: interrupted");
        files::leave(EXIT_CODE)
    };
    // An error would mean a second handler; then Ctrl-C keeps its default action.
    let _ = ctrlc::set_handler(handler);
}
