//! Serves a folder to browsers on this machine.

use anyhow::{Context, Result, anyhow};
use percent_encoding::percent_decode_str;
use std::{
    fs::File,
    path::{Component, Path, PathBuf},
    sync::Arc,
};
use tiny_http::{Header, Request, Response};

/// An HTTP server of static files on the loopback interface.
#[derive(Clone)]
pub struct Server {
    http: Arc<tiny_http::Server>,
    folder: PathBuf,
}

impl Server {
    /// Listens on `port`, or on any free port for 0.
    ///
    /// # Errors
    /// Fails if the folder has no page or the port is in use.
    pub fn new(folder: &Path, port: u16) -> Result<Self> {
        if !folder.join("index.html").is_file() {
            return Err(anyhow!("{}: there is no page; build it with `make web`", folder.display()));
        }
        let http = tiny_http::Server::http(("127.0.0.1", port))
            .map_err(|error| anyhow!("{error}"))
            .with_context(|| format!("cannot listen on port {port}"))?;
        Ok(Self { http: Arc::new(http), folder: folder.to_path_buf() })
    }

    /// Returns the port that the server listens on.
    pub fn port(&self) -> u16 {
        self.http.server_addr().to_ip().map_or(0, |address| address.port())
    }

    /// Answers requests until [`stop`](Self::stop) is called.
    pub fn run(&self) {
        for request in self.http.incoming_requests() {
            // Ignore errors of a browser that has disconnected.
            let _ = self.answer(request);
        }
    }

    /// Makes [`run`](Self::run) return.
    pub fn stop(&self) {
        self.http.unblock();
    }

    fn answer(&self, request: Request) -> std::io::Result<()> {
        let file = file(&self.folder, request.url()).and_then(|path| Some((File::open(&path).ok()?, path)));
        let Some((file, path)) = file else {
            return request.respond(Response::from_string("not found").with_status_code(404));
        };
        let kind = match path.extension().and_then(|e| e.to_str()) {
            Some("html") => "text/html; charset=utf-8",
            Some("js") => "text/javascript; charset=utf-8",
            Some("wasm") => "application/wasm",
            _ => "application/octet-stream",
        };
        let header = |name: &str, value: &str| {
            Header::from_bytes(name, value).expect("names and values are plain text")
        };
        // Do not cache, so that a rebuilt page is loaded again.
        let headers = [header("Content-Type", kind), header("Cache-Control", "no-store")];
        request.respond(headers.into_iter().fold(Response::from_file(file), Response::with_header))
    }
}

/// Returns the path of a URL inside `folder`, never one outside of it.
pub fn file(folder: &Path, url: &str) -> Option<PathBuf> {
    let name = percent_decode_str(url.split(['?', '#']).next()?).decode_utf8().ok()?;
    let name = name.trim_start_matches('/');
    let name = Path::new(if name.is_empty() { "index.html" } else { name });
    let inside = name.components().all(|part| matches!(part, Component::Normal(_)));
    let path = folder.join(name);
    (inside && path.is_file()).then_some(path)
}
