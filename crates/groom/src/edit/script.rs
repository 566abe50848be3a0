//! Strokes as files: JSON lines.
//!
//! ```text
//! {"version":1}
//! {"tool":"comb","set":{"radius":0.03},"samples":[[0,0.1,1.7,0.9,-0.1,0,-0.99,1],[0.02,0.1,1.7,0.9,-0.1,-0.02,-0.99,1]]}
//! {"tool":"smooth","path":[[0.1,1.6,0],[0.1,1.5,0]]} {"do":"undo"}
//! {"do":"pose","guides":[[12,[[0,1.7,0.1],[0,1.71,0.1]]]]}
//! ```
//! A sample is time (s), eye (x, y, z, meters), direction of sight (x, y, z) and pressure, in groom space. A path has
//! the middle of the brush instead, without a camera. [`Brush::of`] gives the values that `set` does not name.

use super::{Brush, BrushTool, GroomDocument, GroomEditor, StrokeSample};
use crate::error::{At, Error, Result};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::Path;

/// Version of the format.
const VERSION: u32 = 1;

/// A step of a script.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptStep {
    /// A stroke.
    Stroke {
        /// The brush.
        brush: Brush,
        /// At least one sample.
        samples: Vec<StrokeSample>,
    },
    /// Takes the last stroke back.
    Undo,
    /// Puts guides into other shapes: index and vertices of each.
    Pose(Vec<(usize, Vec<Vec3>)>),
}

/// A recording of strokes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrokeScript {
    /// The steps in order.
    pub steps: Vec<ScriptStep>,
}

/// A line of the file.
#[derive(Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<BrushTool>,
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    set: Map<String, Value>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    samples: Vec<[f32; 8]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    path: Vec<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    guides: Vec<(usize, Vec<[f32; 3]>)>,
    #[serde(rename = "do", skip_serializing_if = "Option::is_none")]
    act: Option<String>,
}

impl StrokeScript {
    /// Reads a script. Errors name `path` and the line.
    ///
    /// # Errors
    /// [`Error::File`] for an unknown version, tool or value, and for a stroke without samples.
    pub fn read(text: &str, path: &Path) -> Result<Self> {
        let mut script = Self::default();
        let mut has_version = false;
        for (number, text) in (1u64..).zip(text.lines()).filter(|(_, text)| !text.trim().is_empty()) {
            let wrong =
                |problem: String| Error::File { path: path.to_path_buf(), at: At::Line(number), problem };
            let line: Line = serde_json::from_str(text).map_err(|error| {
                let message = error.to_string();
                wrong(message.split(" at line ").next().unwrap_or_default().into())
            })?;
            if !has_version {
                if line.version != Some(VERSION) {
                    return Err(wrong(format!("strokes begin with the line {{\"version\":{VERSION}}}")));
                }
                has_version = true;
                continue;
            }
            script.steps.push(line.step().map_err(wrong)?);
        }
        Ok(script)
    }

    /// Returns the text of the script.
    pub fn write(&self) -> String {
        let mut text = format!("{{\"version\":{VERSION}}}\n");
        for step in &self.steps {
            text += &serde_json::to_string(&Line::of(step)).unwrap_or_default();
            text.push('\n');
        }
        text
    }

    /// Applies the steps to the groom of `editor`. Returns the version after each step that has changed it.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a brush out of range, [`Error::Unusable`] for an undo without a stroke.
    pub fn apply(&self, editor: &mut GroomEditor) -> Result<Vec<GroomDocument>> {
        let mut versions = vec![editor.document().clone()];
        for step in &self.steps {
            match step {
                ScriptStep::Stroke { brush, samples } => {
                    let Some((first, others)) = samples.split_first() else { continue };
                    if editor.press(brush, first)? {
                        others.iter().try_for_each(|sample| editor.drag(sample))?;
                        versions.extend(editor.release());
                    }
                }
                ScriptStep::Pose(guides) => {
                    let n = editor.document().vertex_count();
                    let mut positions = editor.positions().to_vec();
                    for (i, vertices) in guides {
                        let fits = *i < editor.document().guides().len() && vertices.len() == n;
                        if !fits {
                            let problem =
                                format!("the groom has no guide {i} with {} vertices", vertices.len());
                            return Err(Error::Unusable(problem));
                        }
                        positions[i * n..(i + 1) * n].copy_from_slice(vertices);
                    }
                    versions.extend(editor.keep(&positions)?);
                }
                ScriptStep::Undo => {
                    versions.pop();
                    let Some(version) = versions.last() else {
                        return Err(Error::Unusable("there is no stroke to undo".into()));
                    };
                    editor.go_to(version.clone())?;
                }
            }
        }
        versions.remove(0);
        Ok(versions)
    }
}

impl Line {
    fn step(self) -> std::result::Result<ScriptStep, String> {
        let Self { version, tool, set, samples, path, guides, act } = self;
        match (version, tool, act.as_deref()) {
            (None, Some(tool), None) => {
                let mut values = serde_json::to_value(Brush::of(tool)).map_err(|error| error.to_string())?;
                values.as_object_mut().into_iter().for_each(|values| values.extend(set.clone()));
                let brush: Brush = serde_json::from_value(values).map_err(|error| error.to_string())?;
                let brush = Brush { tool, ..brush };
                brush.check().map_err(|error| error.to_string())?;
                let ray = |[time, ox, oy, oz, dx, dy, dz, pressure]: [f32; 8]| StrokeSample {
                    origin: Vec3::new(ox, oy, oz),
                    direction: Vec3::new(dx, dy, dz),
                    pressure,
                    time,
                };
                let samples: Vec<_> = match (samples.is_empty(), path.is_empty()) {
                    (false, true) => samples.into_iter().map(ray).collect(),
                    (true, false) => path.into_iter().map(|p| StrokeSample::point(p.into())).collect(),
                    _ => return Err("a stroke has either samples or a path".into()),
                };
                Ok(ScriptStep::Stroke { brush, samples })
            }
            (None, None, Some("undo")) => Ok(ScriptStep::Undo),
            (None, None, Some("pose")) => {
                let points = |points: Vec<[f32; 3]>| points.into_iter().map(Vec3::from).collect();
                Ok(ScriptStep::Pose(guides.into_iter().map(|(i, vertices)| (i, points(vertices))).collect()))
            }
            (None, None, Some(other)) => {
                Err(format!("there is nothing to do named {other}; there are undo and pose"))
            }
            _ => Err("a line has either a tool or something to do".into()),
        }
    }

    fn of(step: &ScriptStep) -> Self {
        let (brush, samples) = match step {
            ScriptStep::Stroke { brush, samples } => (brush, samples),
            ScriptStep::Undo => return Self { act: Some("undo".into()), ..Self::default() },
            ScriptStep::Pose(guides) => {
                let points = |points: &Vec<Vec3>| points.iter().map(Vec3::to_array).collect();
                let guides = guides.iter().map(|(i, vertices)| (*i, points(vertices))).collect();
                return Self { act: Some("pose".into()), guides, ..Self::default() };
            }
        };
        let values = |brush: &Brush| match serde_json::to_value(brush) {
            Ok(Value::Object(values)) => values,
            _ => Map::new(),
        };
        let plain = values(&Brush::of(brush.tool));
        let set = values(brush).into_iter().filter(|(key, value)| plain.get(key) != Some(value)).collect();
        let line = Self { tool: Some(brush.tool), set, ..Self::default() };
        match samples.iter().all(|sample| sample.direction == Vec3::ZERO) {
            true => Self { path: samples.iter().map(|sample| sample.origin.to_array()).collect(), ..line },
            false => Self {
                samples: samples
                    .iter()
                    .map(|StrokeSample { origin: o, direction: d, pressure, time }| {
                        [*time, o.x, o.y, o.z, d.x, d.y, d.z, *pressure]
                    })
                    .collect(),
                ..line
            },
        }
    }
}
