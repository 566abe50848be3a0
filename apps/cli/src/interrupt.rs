//! Ctrl-C ends the program at once, whatever it is doing: a frame, or a driver's compilation, may take many seconds and
//! cannot be stopped half way. Files appear complete or not at all ([`files`]), so nothing is broken by it.

use crate::{files, progress};

/// The exit code of a program that Ctrl-C ended.
const EXIT_CODE: i32 = 130;

/// Listens for Ctrl-C from here on.
pub fn listen() {
    let handler = || {
        progress::clear();
        eprintln!("tresses: interrupted");
        files::leave(EXIT_CODE)
    };
    // A second listener cannot exist; were there one, Ctrl-C would end the program the plain way.
    let _ = ctrlc::set_handler(handler);
}
