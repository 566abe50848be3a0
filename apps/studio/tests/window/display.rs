//! A virtual display with the studio on it, and simulated pointer and keys.

use std::{
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};
use x11rb::{
    connection::Connection,
    protocol::{
        xproto::{self, Atom, AtomEnum, ConfigureWindowAux, ConnectionExt as _, ImageFormat, Window},
        xtest::ConnectionExt as _,
    },
    rust_connection::RustConnection,
};

/// Timeout of each wait, generous for busy machines.
const PATIENCE: Duration = Duration::from_secs(120);

/// The X server, the studio, and a connection to the server.
pub struct Desk {
    server: Child,
    studio: Child,
    connection: RustConnection,
    state: PathBuf,
    root: Window,
    window: Window,
    /// Last position of the pointer, pixels; none before its first event.
    pointer: Option<[i16; 2]>,
}

/// A screenshot of the window.
#[derive(Clone, PartialEq)]
pub struct Shot {
    pub width: usize,
    pub height: usize,
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

impl Shot {
    /// Saves the screenshot under `target/tmp`, for inspection.
    pub fn keep(&self, name: &str) {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("studio-{name}.png"));
        let bytes = self.pixels.as_flattened();
        let (width, height) = (self.width as u32, self.height as u32);
        image::save_buffer(path, bytes, width, height, image::ExtendedColorType::Rgb8).unwrap();
    }

    /// Returns the fraction of viewport pixels for which `is` holds.
    pub fn share(&self, is: impl Fn(usize, [u8; 3]) -> bool) -> f64 {
        let (xs, ys) = self.picture();
        let all = xs.len() * ys.len();
        let count =
            ys.flat_map(|y| xs.clone().map(move |x| y * self.width + x)).filter(|&i| is(i, self.pixels[i]));
        count.count() as f64 / all as f64
    }

    /// Returns a range of pixels that is inside the viewport.
    fn picture(&self) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        (90..self.width.saturating_sub(320).max(100), 50..self.height - 80)
    }

    /// Returns the fraction of the viewport that differs visibly from `other`.
    pub fn change(&self, other: &Self) -> f64 {
        assert_eq!((self.width, self.height), (other.width, other.height));
        self.share(|i, p| (0..3).any(|c| p[c].abs_diff(other.pixels[i][c]) > 12))
    }

    /// Returns the fraction of the viewport that is strands: warm, and of a different brightness than the pixel to the
    /// right.
    pub fn hair(&self) -> f64 {
        let light = |p: [u8; 3]| p.iter().map(|c| i32::from(*c)).sum::<i32>();
        self.share(|i, p| {
            let next = self.pixels[i + 1];
            p[0] > p[2].saturating_add(10) && (light(p) - light(next)).abs() > 10
        })
    }
}

/// Returns why there is no virtual display, if there is none.
pub fn missing() -> Option<String> {
    Command::new("Xvfb")
        .arg("-help")
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .status()
        .err()
        .map(|e| format!("Xvfb: {e}"))
}

impl Desk {
    /// Opens the studio on a screen of 1920 × 1200.
    pub fn open(arguments: &[&str]) -> Self {
        Self::open_with(arguments, &[])
    }

    /// Opens the studio with environment variables.
    pub fn open_with(arguments: &[&str], variables: &[(&str, &str)]) -> Self {
        Self::open_in(Path::new("."), arguments, variables)
    }

    /// Opens the studio in a folder, with environment variables.
    pub fn open_in(folder: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1920x1200x24", "-nolisten", "tcp", "-noreset", "-r"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let display = format!(":{}", number.trim());
        let state = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("studio-state{display}.json"));
        // Remove the state of an earlier run, if any.
        let _ = std::fs::remove_file(&state);
        // `TRESSES_STUDIO_PROGRAM` may name another program that contains the studio, with its arguments.
        let named = std::env::var("TRESSES_STUDIO_PROGRAM").unwrap_or_default();
        let mut words = named.split_whitespace();
        let mut studio = match words.next() {
            Some(program) => Command::new(program),
            None => Command::new(env!("CARGO_BIN_EXE_tresses-studio")),
        };
        let given = words.clone().next().is_some();
        let studio = studio
            .args(words)
            .args(arguments.iter().filter(|_| !given))
            .current_dir(folder)
            .env("DISPLAY", &display)
            .env("XDG_STATE_HOME", env!("CARGO_TARGET_TMPDIR"))
            .envs(variables.iter().copied())
            .env("TRESSES_STUDIO_STATE", &state)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .spawn()
            .unwrap();
        let (connection, screen) = RustConnection::connect(Some(&display)).unwrap();
        let root = connection.setup().roots[screen].root;
        let mut desk = Self { server, studio, connection, state, root, window: 0, pointer: None };
        desk.window = desk.wait_for("the window", Self::find);
        desk
    }

    /// Resizes the window to 1280 × 720 and waits for hair.
    pub fn show_hair(&mut self) {
        self.resize(1280, 720);
        self.wait_for("hair", |desk| (desk.state()?["frames"].as_u64()? > 2).then_some(()));
    }

    /// Switches to the current window, after the studio has reopened it.
    pub fn follow(&mut self) {
        self.window = self.wait_for("the window", Self::find);
    }

    /// Waits until `what` returns a value.
    pub fn wait_for<T>(&mut self, name: &str, mut what: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begun = Instant::now();
        loop {
            if let Some(found) = what(self) {
                return found;
            }
            if let Some(status) = self.studio.try_wait().unwrap() {
                panic!("the studio ended with {status} while {name} was waited for");
            }
            assert!(begun.elapsed() < PATIENCE, "no {name} after {PATIENCE:?}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Finds the visible window with the studio's title.
    fn find(&mut self) -> Option<Window> {
        let tree = self.connection.query_tree(self.root).ok()?.reply().ok()?;
        tree.children.into_iter().find(|&window| {
            let name = self.connection.get_property(false, window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64);
            let named =
                name.ok().and_then(|n| n.reply().ok()).is_some_and(|n| n.value.starts_with(b"Tresses"));
            let seen = self.connection.get_window_attributes(window).ok().and_then(|a| a.reply().ok());
            named && seen.is_some_and(|a| a.map_state == xproto::MapState::VIEWABLE)
        })
    }

    /// Returns a screenshot of the window.
    pub fn shot(&mut self) -> Shot {
        let at = self.connection.get_geometry(self.window).unwrap().reply().unwrap();
        self.part([0, 0], [at.width.min(1920), at.height.min(1200)])
    }

    /// Returns a screenshot of a part of the window, given its top left corner and size.
    pub fn part(&self, [x, y]: [i16; 2], [width, height]: [u16; 2]) -> Shot {
        let image = self.connection.get_image(ImageFormat::Z_PIXMAP, self.window, x, y, width, height, !0);
        let data = image.unwrap().reply().unwrap().data;
        let pixels = data.as_chunks::<4>().0.iter().map(|[b, g, r, _]| [*r, *g, *b]).collect();
        Shot { width: width.into(), height: height.into(), pixels }
    }

    /// Returns the studio's published state; `None` while the studio writes it.
    pub fn state(&self) -> Option<serde_json::Value> {
        serde_json::from_slice(&std::fs::read(&self.state).ok()?).ok()
    }

    /// Waits until the studio has seen the pointer where it is now, and so every event before.
    pub fn arrive(&mut self) {
        let Some([x, y]) = self.pointer else { return };
        self.wait_for("pointer", |desk| {
            let pointer = desk.state()?["pointer"].clone();
            (pointer[0].as_f64() == Some(x.into()) && pointer[1].as_f64() == Some(y.into())).then_some(())
        });
    }

    /// Returns a screenshot once all events have been handled, nothing is in flight and the window no longer changes.
    pub fn still(&mut self) -> Shot {
        // The studio handles events in order, and a move by a pixel after all others.
        if let Some([x, y]) = self.pointer {
            self.move_to([x ^ 1, y]);
            self.arrive();
        }
        let mut last = None;
        self.wait_for("picture that stands still", |desk| {
            std::thread::sleep(Duration::from_millis(200));
            let rests = desk.state()?["busy"] == false;
            let now = desk.shot();
            // The window shows a frame a little after it is drawn.
            let same = rests && last.as_ref() == Some(&now);
            if same {
                let state = desk.state()?;
                assert_eq!(state["seen"], state["frames"], "the last picture is seen: {state}");
            }
            last = rests.then(|| now.clone());
            same.then_some(now)
        })
    }

    fn fake(&mut self, kind: u8, detail: u8, x: i16, y: i16) {
        self.send(kind, detail, x, y);
        std::thread::sleep(Duration::from_millis(30));
    }

    fn send(&mut self, kind: u8, detail: u8, x: i16, y: i16) {
        if kind == xproto::MOTION_NOTIFY_EVENT {
            self.pointer = Some([x, y]);
        }
        self.connection.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).unwrap();
        self.connection.flush().unwrap();
    }

    /// Moves the pointer.
    pub fn move_to(&mut self, [x, y]: [i16; 2]) {
        self.fake(xproto::MOTION_NOTIFY_EVENT, 0, x, y);
    }

    /// Clicks with the left button.
    pub fn click(&mut self, at: [i16; 2]) {
        self.press(at, 1);
    }

    /// Turns the wheel by a notch: up, or else down.
    pub fn wheel(&mut self, at: [i16; 2], up: bool) {
        self.press(at, if up { 4 } else { 5 });
    }

    fn press(&mut self, at: [i16; 2], button: u8) {
        self.move_to(at);
        self.fake(xproto::BUTTON_PRESS_EVENT, button, 0, 0);
        self.fake(xproto::BUTTON_RELEASE_EVENT, button, 0, 0);
    }

    /// Drags between two positions with `button` (1 left, 3 right). `held` runs before the button is released.
    pub fn drag<R>(&mut self, button: u8, [a, b]: [[i16; 2]; 2], held: impl FnOnce(&mut Self) -> R) -> R {
        self.fake(xproto::MOTION_NOTIFY_EVENT, 0, a[0], a[1]);
        self.fake(xproto::BUTTON_PRESS_EVENT, button, 0, 0);
        for i in 1..=10 {
            let between = |c: usize| a[c] + (b[c] - a[c]) * i / 10;
            self.fake(xproto::MOTION_NOTIFY_EVENT, 0, between(0), between(1));
        }
        let result = held(self);
        self.fake(xproto::BUTTON_RELEASE_EVENT, button, 0, 0);
        result
    }

    /// Types the key with an X keysym (a Latin letter's keysym is its code point).
    pub fn key(&mut self, symbol: u32) {
        let code = self.code(symbol);
        self.fake(xproto::KEY_PRESS_EVENT, code, 0, 0);
        self.fake(xproto::KEY_RELEASE_EVENT, code, 0, 0);
    }

    /// Types the key with `modifier` held.
    pub fn chord(&mut self, modifier: u32, symbol: u32) {
        let held = self.code(modifier);
        self.fake(xproto::KEY_PRESS_EVENT, held, 0, 0);
        self.key(symbol);
        self.fake(xproto::KEY_RELEASE_EVENT, held, 0, 0);
    }

    /// Runs `inside` with the key held.
    pub fn hold<R>(&mut self, symbol: u32, inside: impl FnOnce(&mut Self) -> R) -> R {
        let held = self.code(symbol);
        self.fake(xproto::KEY_PRESS_EVENT, held, 0, 0);
        let result = inside(self);
        self.fake(xproto::KEY_RELEASE_EVENT, held, 0, 0);
        result
    }

    /// Types the key without delays.
    pub fn tap(&mut self, symbol: u32) {
        let code = self.code(symbol);
        self.send(xproto::KEY_PRESS_EVENT, code, 0, 0);
        self.send(xproto::KEY_RELEASE_EVENT, code, 0, 0);
    }

    /// Returns the keycode of an X keysym, and focuses the window.
    fn code(&self, symbol: u32) -> u8 {
        let setup = self.connection.setup();
        let (first, count) = (setup.min_keycode, setup.max_keycode - setup.min_keycode + 1);
        let map = self.connection.get_keyboard_mapping(first, count).unwrap().reply().unwrap();
        let each = usize::from(map.keysyms_per_keycode);
        let at =
            map.keysyms.chunks(each).position(|symbols| symbols.contains(&symbol)).expect("a key for it");
        self.connection.set_input_focus(xproto::InputFocus::PARENT, self.window, 0u32).unwrap();
        first + at as u8
    }

    /// Returns the studio's resident memory, bytes.
    pub fn resident(&self) -> i64 {
        let text = std::fs::read_to_string(format!("/proc/{}/statm", self.studio.id())).unwrap();
        4096 * text.split_whitespace().nth(1).unwrap().parse::<i64>().unwrap()
    }

    /// Returns the studio's processor time so far, seconds.
    pub fn processor(&self) -> f64 {
        let text = std::fs::read_to_string(format!("/proc/{}/stat", self.studio.id())).unwrap();
        // Fields after the name, which may contain anything: user and system time in hundredths of a second.
        let fields: Vec<_> = text.rsplit_once(')').unwrap().1.split_whitespace().collect();
        [11, 12].iter().map(|&at| fields[at].parse::<f64>().unwrap()).sum::<f64>() / 100.0
    }

    /// Resizes the window.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.connection.configure_window(self.window, &size).unwrap();
        self.connection.flush().unwrap();
    }

    /// Ends the studio without a chance to tidy up.
    pub fn kill(mut self) {
        self.studio.kill().unwrap();
        self.studio.wait().unwrap();
    }

    /// Closes the window as a desktop would, and waits for the studio to end.
    pub fn close(mut self) -> ExitStatus {
        let atom =
            |name: &[u8]| -> Atom { self.connection.intern_atom(false, name).unwrap().reply().unwrap().atom };
        let (protocols, delete) = (atom(b"WM_PROTOCOLS"), atom(b"WM_DELETE_WINDOW"));
        let event = xproto::ClientMessageEvent::new(32, self.window, protocols, [delete, 0, 0, 0, 0]);
        self.connection.send_event(false, self.window, xproto::EventMask::NO_EVENT, event).unwrap();
        self.connection.flush().unwrap();
        let begun = Instant::now();
        loop {
            if let Some(status) = self.studio.try_wait().unwrap() {
                return status;
            }
            assert!(begun.elapsed() < PATIENCE, "the studio does not end");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        // Both may have ended already.
        let _ = self.studio.kill();
        let _ = self.studio.wait();
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
