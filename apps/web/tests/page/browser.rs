//! A headless Chromium, controlled with the DevTools protocol over a WebSocket.

use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    net::TcpStream,
    ops::Range,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// Timeout of each operation; software rendering on a busy machine is slow.
pub const PATIENCE: Duration = Duration::from_secs(240);

/// Program names of browsers with WebGPU.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Flags for WebGPU on the CPU (SwiftShader) with a canvas.
const FLAGS: [&str; 17] = [
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-dev-shm-usage",
    "--disable-background-timer-throttling",
    "--disable-renderer-backgrounding",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-gpu-watchdog",
];

/// Parts of messages that are no complaints: a page without an icon, a browser without WebGPU, and a browser that reads
/// back its own picture.
const EXPECTED: [&str; 4] = [
    "favicon.ico",
    "Failed to create WebGPU Context Provider",
    "No available adapters",
    "GPU stall due to ReadPixels",
];

/// A browser with one page.
pub struct Browser {
    child: Child,
    _profile: TempDir,
    socket: WebSocket<TcpStream>,
    session: String,
    calls: u64,
    complaints: Vec<String>,
}

/// A screenshot of the page: RGBA, rows from the top.
#[derive(Clone, PartialEq)]
pub struct Picture {
    pub size: [u32; 2],
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Returns the fraction of pixels whose color differs by more than `least` of 255 in some channel.
    pub fn difference(&self, other: &Self, least: u8) -> f64 {
        assert_eq!(self.size, other.size);
        let (a, b) = (self.rgba.as_chunks::<4>().0, other.rgba.as_chunks::<4>().0);
        let differs = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > least);
        a.iter().zip(b).filter(differs).count() as f64 / a.len() as f64
    }

    /// Returns the region `xs` × `ys`, pixels from the left and the top.
    pub fn part(&self, xs: Range<u32>, ys: Range<u32>) -> Self {
        let row = |y: u32| {
            let at = |x: u32| 4 * (y * self.size[0] + x) as usize;
            &self.rgba[at(xs.start)..at(xs.end)]
        };
        let rgba = ys.clone().flat_map(row).copied().collect();
        Self { size: [xs.end - xs.start, ys.end - ys.start], rgba }
    }

    /// Returns the fraction of pixels for which `is` holds, given a pixel and its right neighbor.
    pub fn share(&self, is: impl Fn([u8; 4], [u8; 4]) -> bool) -> f64 {
        let pixels = self.rgba.as_chunks::<4>().0;
        pixels.array_windows().filter(|[a, b]| is(*a, *b)).count() as f64 / pixels.len() as f64
    }

    /// Writes a PNG for inspection into the folder `TRESSES_PICTURES`, if that is set.
    pub fn keep(&self, name: &str) {
        let Some(folder) = std::env::var_os("TRESSES_PICTURES").map(PathBuf::from) else { return };
        std::fs::create_dir_all(&folder).unwrap();
        let file = std::fs::File::create(folder.join(name)).unwrap();
        let mut encoder = png::Encoder::new(file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header().unwrap().write_image_data(&self.rgba).unwrap();
    }
}

impl Browser {
    /// Starts a browser of `size` pixels with a blank page. Returns `None` if no browser is installed and none is
    /// required.
    pub fn start(size: [u32; 2]) -> Option<Self> {
        Self::with_flags(size, &FLAGS)
    }

    /// Starts a browser without WebGPU.
    pub fn without_webgpu(size: [u32; 2]) -> Option<Self> {
        let mut flags: Vec<&str> = FLAGS.into_iter().filter(|flag| !flag.contains("webgpu")).collect();
        flags.push("--disable-features=WebGPU,WebGPUService");
        Self::with_flags(size, &flags)
    }

    fn with_flags([width, height]: [u32; 2], flags: &[&str]) -> Option<Self> {
        let Some(program) = installed() else {
            tresses_testing::skip("browser", "no Chromium was found");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let child = Command::new(program)
            .args(flags)
            .arg(format!("--window-size={width},{height}"))
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let (port, path) = endpoint(profile.path());
        let stream = TcpStream::connect(("127.0.0.1", port)).expect("the browser listens");
        stream.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
        stream.set_nodelay(true).unwrap();
        // The handshake has no timeout of its own.
        let (socket, _) = tungstenite::client(format!("ws://127.0.0.1:{port}{path}"), stream)
            .expect("the browser speaks the protocol");
        let mut browser =
            Self { child, _profile: profile, socket, session: String::new(), calls: 0, complaints: vec![] };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", target);
        browser.session = session["sessionId"].as_str().expect("a session").into();
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.resize([width, height]);
        Some(browser)
    }

    /// Navigates to `url`.
    pub fn go(&mut self, url: &str) {
        let answer = self.call("Page.navigate", json!({"url": url}));
        assert!(answer.get("errorText").is_none(), "{url}: {answer}");
    }

    /// Evaluates an expression in the page, awaiting promises.
    pub fn value(&mut self, expression: &str) -> Value {
        let what = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let answer = self.call("Runtime.evaluate", what);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Evaluates an expression repeatedly until `enough` accepts its value.
    pub fn until(&mut self, expression: &str, enough: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        loop {
            let value = self.value(expression);
            if enough(&value) {
                return value;
            }
            let heard = self.complaints.join("\n");
            assert!(begin.elapsed() < PATIENCE, "{expression} is still {value}\n{heard}");
            assert!(self.complaints.is_empty(), "{heard}");
            std::thread::sleep(Duration::from_millis(200));
        }
    }

    /// Takes a screenshot of the page.
    pub fn picture(&mut self) -> Picture {
        let answer = self.call("Page.captureScreenshot", json!({"format": "png"}));
        let png = BASE64_STANDARD.decode(answer["data"].as_str().expect("a picture")).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        let rgba = match info.color_type {
            png::ColorType::Rgba => pixels,
            png::ColorType::Rgb => {
                pixels.as_chunks().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect()
            }
            other => panic!("a screenshot of type {other:?}"),
        };
        Picture { size: [info.width, info.height], rgba }
    }

    /// Sends a mouse event for the left button. `kind` is a type of the protocol, such as `mousePressed`.
    pub fn mouse(&mut self, kind: &str, place: [f64; 2]) {
        self.pointer(kind, None, place);
    }

    /// Sends an event of the mouse, or of a pen with this pressure.
    fn pointer(&mut self, kind: &str, pressure: Option<f64>, [x, y]: [f64; 2]) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let mut event = json!({"type": kind, "x": x, "y": y, "button": button, "clickCount": 1});
        if let Some(pressure) = pressure {
            let held = u32::from(kind != "mouseReleased");
            event["pointerType"] = json!("pen");
            event["force"] = json!(pressure * f64::from(held));
            event["buttons"] = json!(held);
        }
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Clicks at `place`.
    pub fn click(&mut self, place: [f64; 2]) {
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            self.mouse(kind, place);
        }
    }

    /// Drags the mouse from `from` to `to`.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.stroke(None, from, to);
    }

    /// Drags the mouse, or a pen with this pressure, from `from` to `to`.
    pub fn stroke(&mut self, pressure: Option<f64>, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from);
        self.pointer("mousePressed", pressure, from);
        for i in 1..=4 {
            let between = |c: usize| from[c] + (to[c] - from[c]) * f64::from(i) / 4.0;
            self.pointer("mouseMoved", pressure, [between(0), between(1)]);
        }
        self.pointer("mouseReleased", pressure, to);
    }

    /// Types `text`.
    pub fn keys(&mut self, text: &str) {
        for letter in text.chars() {
            for kind in ["keyDown", "keyUp"] {
                let event = json!({"type": kind, "key": letter.to_string(), "text": letter.to_string()});
                self.call("Input.dispatchKeyEvent", event);
            }
        }
    }

    /// Drops files on the page.
    pub fn drop_files(&mut self, files: &[&Path], [x, y]: [f64; 2]) {
        let files: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
        let data = json!({"items": [], "files": files, "dragOperationsMask": 1});
        for kind in ["dragEnter", "dragOver", "drop"] {
            let event = json!({"type": kind, "x": x, "y": y, "data": data});
            self.call("Input.dispatchDragEvent", event);
        }
    }

    /// Sends a touch event: `fingers` are all fingers that touch the page. `kind` is a type of the protocol, such as
    /// `touchStart`.
    pub fn touch(&mut self, kind: &str, fingers: &[[f64; 2]]) {
        let points: Vec<_> =
            fingers.iter().enumerate().map(|(i, [x, y])| json!({"x": x, "y": y, "id": i})).collect();
        self.call("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": points}));
    }

    /// Moves fingers from `from` to `to`.
    pub fn swipe(&mut self, from: &[[f64; 2]], to: &[[f64; 2]]) {
        for count in 1..=from.len() {
            self.touch("touchStart", &from[..count]);
        }
        // egui measures a gesture from the positions in its first frame.
        self.frames();
        for i in 1..=4 {
            let between =
                |(a, b): (&[f64; 2], &[f64; 2])| [0, 1].map(|c| a[c] + (b[c] - a[c]) * f64::from(i) / 4.0);
            let now: Vec<_> = from.iter().zip(to).map(between).collect();
            self.touch("touchMove", &now);
        }
        self.touch("touchEnd", &[]);
    }

    /// Waits for some frames of the page.
    fn frames(&mut self) {
        let frame = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))";
        for _ in 0..2 {
            self.value(frame);
        }
    }

    /// Sets the size of the page, pixels.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// Turns the mouse wheel by `by` pixels.
    pub fn wheel(&mut self, [x, y]: [f64; 2], by: f64) {
        let event = json!({"type": "mouseWheel", "x": x, "y": y, "deltaX": 0.0, "deltaY": by});
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Returns the anonymous and shared memory of each process of the browser by process id, bytes, after a garbage
    /// collection. That includes the memory of WebAssembly and of the adapter. Returns `None` except on Linux.
    pub fn resident(&mut self) -> Option<BTreeMap<i64, i64>> {
        self.call("HeapProfiler.collectGarbage", json!({}));
        let number = |text: &str, name: &str| -> Option<i64> {
            text.lines().find_map(|line| line.strip_prefix(name)?.split_whitespace().next()?.parse().ok())
        };
        let entries = std::fs::read_dir("/proc").ok()?.flatten();
        let texts = entries.filter_map(|entry| std::fs::read_to_string(entry.path().join("status")).ok());
        let all: Vec<[i64; 3]> = texts
            .filter_map(|text| {
                let held = number(&text, "RssAnon:")? + number(&text, "RssShmem:")?;
                Some([number(&text, "Pid:")?, number(&text, "PPid:")?, held * 1024])
            })
            .collect();
        let mut family = vec![i64::from(self.child.id())];
        let mut next = 0;
        while let Some(parent) = family.get(next).copied() {
            family.extend(all.iter().filter(|[_, of, _]| *of == parent).map(|[pid, ..]| *pid));
            next += 1;
        }
        Some(
            all.iter().filter(|[pid, ..]| family.contains(pid)).map(|[pid, _, held]| (*pid, *held)).collect(),
        )
    }

    /// Directs downloads of the page into `folder`.
    pub fn download_into(&mut self, folder: &Path) {
        let how = json!({"behavior": "allow", "downloadPath": folder.display().to_string()});
        self.call("Browser.setDownloadBehavior", how);
    }

    /// Returns the errors and warnings in the page's console, including wgpu's and WebGPU's.
    pub fn complaints(&mut self) -> &[String] {
        // The browser sends pending events before the answer to this call.
        self.value("0");
        &self.complaints
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        let mut message = json!({"id": id, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.socket.send(Message::text(message.to_string())).expect("the browser is there");
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            let Some(message) = self.next() else { continue };
            if message["id"] == id {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.hear(&message);
        }
        panic!("{method}: no answer in {} s", PATIENCE.as_secs());
    }

    /// Returns the next message, if one arrives within a second.
    fn next(&mut self) -> Option<Value> {
        use std::io::ErrorKind::{TimedOut, WouldBlock};
        match self.socket.read() {
            Ok(Message::Text(text)) => Some(serde_json::from_str(&text).expect("JSON")),
            Ok(_) => None,
            Err(tungstenite::Error::Io(error)) if matches!(error.kind(), TimedOut | WouldBlock) => None,
            Err(error) => panic!("the browser is gone: {error}"),
        }
    }

    fn hear(&mut self, event: &Value) {
        let params = &event["params"];
        let complaint = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => Some(params["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled")
                if matches!(params["type"].as_str(), Some("error" | "warning" | "assert")) =>
            {
                Some(params["args"].to_string())
            }
            Some("Log.entryAdded")
                if matches!(params["entry"]["level"].as_str(), Some("error" | "warning")) =>
            {
                Some(params["entry"].to_string())
            }
            Some("Inspector.targetCrashed") => Some("the page crashed".into()),
            _ => None,
        };
        let expected = |text: &String| EXPECTED.iter().any(|part| text.contains(part));
        self.complaints.extend(complaint.filter(|text| !expected(text)));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn installed() -> Option<PathBuf> {
    let folders: Vec<_> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|p| p.is_file())
}

/// Reads the port and path at which the browser with `profile` listens; the browser writes them into a file.
fn endpoint(profile: &Path) -> (u16, String) {
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        let mut lines = text.lines();
        if let (Some(port), Some(path)) = (lines.next().and_then(|port| port.parse().ok()), lines.next()) {
            return (port, path.into());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    panic!("the browser does not listen");
}
