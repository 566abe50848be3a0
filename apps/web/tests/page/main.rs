//! The pages in a browser, and the functions that build them.

mod browser;
mod files;
mod modules;
mod studio;
mod viewer;

use std::{path::Path, thread};
use tresses_web::Server;

/// Starts a server of `folder` that runs until it is stopped.
fn serve(folder: &Path) -> (Server, thread::JoinHandle<()>) {
    let server = Server::new(folder, 0).unwrap();
    let serving = thread::spawn({
        let server = server.clone();
        move || server.run()
    });
    (server, serving)
}
