//! Writes a layer as text. Rust prints floats so that they read back exactly.

use std::fmt::{Display, Write};

use glam::{DMat4, Vec3};

/// A layer being written: its text so far, and the number of open prims.
#[derive(Default)]
pub(super) struct Layer {
    text: String,
    depth: usize,
}

impl Layer {
    /// Begins a file with these lines of metadata.
    pub fn new(lines: &[String]) -> Self {
        let text =
            lines.iter().fold(String::from("#usda 1.0\n(\n"), |text, line| text + "    " + line + "\n");
        Self { text: text + ")\n", depth: 0 }
    }

    pub fn line(&mut self, line: impl Display) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.text, "{:1$}{line}", "", 4 * self.depth);
    }

    /// Opens a prim.
    pub fn open(&mut self, schema: &str, name: &str, apis: &[&str]) {
        self.text.push('\n');
        match apis {
            [] => self.line(format_args!("def {schema} \"{name}\"")),
            apis => {
                let apis: Vec<_> = apis.iter().map(|api| format!("\"{api}\"")).collect();
                self.line(format_args!("def {schema} \"{name}\" ("));
                self.line(format_args!("    prepend apiSchemas = [{}]", apis.join(", ")));
                self.line(")");
            }
        }
        self.line("{");
        self.depth += 1;
    }

    pub fn close(&mut self) {
        self.depth -= 1;
        self.line("}");
    }

    /// Writes an attribute with its metadata, such as the interpolation.
    pub fn list<T: Display>(&mut self, name: &str, values: impl IntoIterator<Item = T>, about: &[String]) {
        let list = listed(values);
        match about {
            [] => self.line(format_args!("{name} = {list}")),
            about => {
                self.line(format_args!("{name} = {list} ("));
                about.iter().for_each(|word| self.line(format_args!("    {word}")));
                self.line(")");
            }
        }
    }

    /// Writes the samples of an attribute: time codes and values.
    pub fn samples(&mut self, name: &str, samples: impl IntoIterator<Item = (u32, String)>) {
        self.line(format_args!("{name}.timeSamples = {{"));
        samples.into_iter().for_each(|(code, value)| self.line(format_args!("    {code}: {value},")));
        self.line("}");
    }

    pub fn finish(self) -> String {
        self.text
    }
}

/// Returns the interpolation of an attribute as metadata.
pub(super) fn per(interpolation: &str) -> Vec<String> {
    vec![format!("interpolation = \"{interpolation}\"")]
}

pub(super) fn listed<T: Display>(values: impl IntoIterator<Item = T>) -> String {
    let mut text = String::from("[");
    for (i, value) in values.into_iter().enumerate() {
        let _ = write!(text, "{}{value}", if i == 0 { "" } else { ", " });
    }
    text + "]"
}

pub(super) fn point(p: &Vec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

pub(super) fn quoted(text: &str) -> String {
    // Names of joints and blend shapes rarely have these characters; replacing them is enough.
    format!("\"{}\"", text.replace(['"', '\\', '\n', '\r'], "_"))
}

/// Formats a matrix. USD's multiply row vectors: their rows are the columns of `DMat4`.
pub(super) fn matrix(m: &DMat4) -> String {
    let rows = m.to_cols_array_2d().map(|[a, b, c, d]| format!("({a}, {b}, {c}, {d})"));
    format!("( {} )", rows.join(", "))
}
