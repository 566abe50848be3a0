//! Outputs of `Simulation.render` as arrays.

use crate::{
    TressesError,
    arrays::{array, given_matrix},
    pose::vector,
};
use numpy::PyArrayDyn;
use pyo3::{prelude::*, types::PyDict};
use tresses::{Bounds, glam::Mat4, groom::Strands};
use tresses_scene::{
    CaptureCamera, Viewpoint,
    camera::Angle,
    scene::{Capture, OutputRequest},
};

/// Names of the outputs, in the order of the documentation.
pub const OUTPUTS: [&str; 12] = [
    "color",
    "linear",
    "body_depth",
    "body_normal",
    "coverage",
    "depth",
    "motion",
    "strand",
    "groom",
    "share",
    "along",
    "tangent",
];

/// How the head is drawn.
#[derive(FromPyObject)]
pub enum HeadDrawing {
    /// Whether it is drawn.
    Shown(bool),
    /// A word: `holdout`.
    Word(String),
}

impl HeadDrawing {
    /// Returns `request` with this drawing of the head.
    pub fn request(&self, request: OutputRequest) -> PyResult<OutputRequest> {
        match self {
            Self::Shown(shown) => Ok(OutputRequest { hair_only: !shown, ..request }),
            Self::Word(word) if word == "holdout" => Ok(OutputRequest { holdout: true, ..request }),
            Self::Word(word) => {
                Err(TressesError::new_err(format!("head is {word}, but must be True, False or \"holdout\"")))
            }
        }
    }
}

/// Requested outputs.
pub struct OutputNames(Vec<String>);

impl OutputNames {
    /// Checks a list of output names.
    pub fn new(names: Vec<String>) -> PyResult<Self> {
        if let Some(name) = names.iter().find(|name| !OUTPUTS.contains(&name.as_str())) {
            let all = OUTPUTS.join(", ");
            return Err(TressesError::new_err(format!("there is no output {name}; choose {all}")));
        }
        Ok(Self(names))
    }

    fn has(&self, name: &str) -> bool {
        self.0.iter().any(|requested| requested == name)
    }

    /// Returns the capture options of the scene.
    pub fn request(&self) -> OutputRequest {
        OutputRequest {
            linear: self.has("linear"),
            hair: OUTPUTS[4..].iter().any(|name| self.has(name)),
            body: self.has("body_depth") || self.has("body_normal"),
            ..Default::default()
        }
    }

    /// Returns whether the outputs require reading back the strands.
    pub fn needs_strands(&self) -> bool {
        self.has("tangent") || self.has("along")
    }
}

/// Converts a camera from Python: the name of an angle, eye and target, or view and projection.
pub fn capture_camera(
    camera: &Bound<'_, PyAny>,
    subject: Bounds,
    size: [u32; 2],
    zoom: f32,
    distance: Option<f32>,
) -> PyResult<CaptureCamera> {
    if let Ok(pair) = camera.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>()
        && let Ok(view) = given_matrix(&pair.0, "the camera's view")
    {
        let projection = given_matrix(&pair.1, "the camera's projection")?;
        let both = projection * view;
        if !both.is_finite() || both.determinant() == 0.0 {
            return Err(TressesError::new_err("view and projection of the camera need an inverse"));
        }
        return Ok(CaptureCamera::Matrices(view, projection));
    }
    viewpoint(camera, subject, size, zoom, distance).map(CaptureCamera::Viewpoint)
}

fn viewpoint(
    camera: &Bound<'_, PyAny>,
    subject: Bounds,
    size: [u32; 2],
    zoom: f32,
    distance: Option<f32>,
) -> PyResult<Viewpoint> {
    let view = match camera.extract::<String>() {
        Ok(name) => {
            let angle = Angle::ALL.iter().find(|(_, known)| *known == name).map(|(angle, _)| *angle);
            let all = Angle::ALL.map(|(_, name)| name).join(", ");
            let none = || {
                TressesError::new_err(format!(
                    "there is no camera {name}; choose {all}, or give (eye, target) or (view, projection)"
                ))
            };
            if !(zoom.is_finite() && zoom > 0.0) {
                return Err(TressesError::new_err(format!("zoom is {zoom}, but must be above 0")));
            }
            Viewpoint::portrait(angle.ok_or_else(none)?, subject, size[0] as f32 / size[1] as f32, zoom)
        }
        Err(_) => {
            let pair: (Bound<'_, PyAny>, Bound<'_, PyAny>) = camera
                .extract()
                .map_err(|_| TressesError::new_err("camera must be a name, or (eye, target)"))?;
            Viewpoint {
                eye: vector(&pair.0, "the camera's eye")?,
                target: vector(&pair.1, "the camera's target")?,
            }
        }
    };
    if view.distance().is_nan() || view.distance() < 1e-4 {
        return Err(TressesError::new_err("eye and target of the camera are the same point"));
    }
    match distance {
        None => Ok(view),
        Some(distance) if distance.is_finite() && distance > 0.0 => Ok(view.at_distance(distance)),
        Some(distance) => Err(TressesError::new_err(format!("distance is {distance}, but must be above 0"))),
    }
}

/// Returns a matrix as an array [4, 4] of rows.
pub fn matrix<'py>(py: Python<'py>, matrix: Mat4) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    array(py, &[4, 4], matrix.transpose().to_cols_array().to_vec())
}

/// Returns the outputs of a frame of `size` as a dict of arrays. `projection` is the projection matrix of its camera.
/// `strands` holds the strands of each groom, if [`needs_strands`](OutputNames::needs_strands).
pub fn outputs<'py>(
    py: Python<'py>,
    names: &OutputNames,
    captured: &Capture,
    ([width, height], projection): ([u32; 2], Mat4),
    strands: &[Strands],
) -> PyResult<Bound<'py, PyDict>> {
    let (w, h) = (width as usize, height as usize);
    let dict = PyDict::new(py);
    let labels = &captured.labels;
    for name in &names.0 {
        let plane = [h, w];
        let numbers =
            |of: &dyn Fn(usize) -> f32| array(py, &plane, (0..w * h).map(of).collect()).map(Bound::into_any);
        let integers =
            |of: &dyn Fn(usize) -> i32| array(py, &plane, (0..w * h).map(of).collect()).map(Bound::into_any);
        let value = match name.as_str() {
            "color" => array(py, &[h, w, 4], captured.color.clone())?.into_any(),
            "linear" => array(py, &[h, w, 4], captured.linear.as_flattened().to_vec())?.into_any(),
            "coverage" => array(py, &plane, captured.coverages())?.into_any(),
            "depth" => array(py, &plane, captured.depths(&projection))?.into_any(),
            "body_depth" => {
                array(py, &plane, captured.surface.iter().map(|sample| sample.depth).collect())?.into_any()
            }
            "body_normal" => {
                let normals = captured.surface.iter().flat_map(|sample| sample.normal.to_array());
                array(py, &[h, w, 3], normals.collect())?.into_any()
            }
            "motion" => array(py, &[h, w, 2], captured.motions().into_flattened())?.into_any(),
            "strand" => integers(&|i| labels[i].map_or(-1, |label| label.strand as i32))?,
            "groom" => integers(&|i| labels[i].map_or(-1, |label| label.groom as i32))?,
            "share" => numbers(&|i| labels[i].map_or(0.0, |label| label.coverage))?,
            "along" => numbers(&|i| {
                let position = labels[i].and_then(|label| {
                    let segments = strands.get(label.groom as usize)?.range(label.strand as usize).len() - 1;
                    Some((label.vertex as f32 + label.along) / segments as f32)
                });
                position.unwrap_or(f32::NAN)
            })?,
            _ => {
                let tangent = |i: usize| {
                    let direction = labels[i].and_then(|label| {
                        let line = strands.get(label.groom as usize)?.strand(label.strand as usize);
                        let vertex = label.vertex as usize;
                        Some((*line.get(vertex + 1)? - *line.get(vertex)?).normalize_or_zero())
                    });
                    direction.unwrap_or_default().to_array()
                };
                array(py, &[h, w, 3], (0..w * h).flat_map(tangent).collect())?.into_any()
            }
        };
        dict.set_item(name, value)?;
    }
    Ok(dict)
}
