//! Step-by-step hair simulation and rendering.

// `work::run` polls each future on a single thread, which holds the lock for the whole operation.
#![allow(clippy::await_holding_lock)]

use crate::{
    TressesError,
    arrays::{floats, points},
    body::BodyInput,
    device,
    given::StrandAttachments,
    groom::Groom,
    picture::{self, HeadDrawing, OutputNames, capture_camera, matrix},
    pose::{PoseTuple, pose, pose_to_tuple, vector},
    raised, settings,
    strands::Strands,
    work::run,
};
use anyhow::{Context, ensure};
use numpy::PyArrayDyn;
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict},
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tresses::{
    Background, Gesture, Gpu,
    glam::Vec3,
    low_level::{GuideState, MAX_STEPS},
};
use tresses_scene::{CaptureCamera, CompanionFiles, Quality, Scene, Shelf, settings::Settings as Values};

/// Maximum length of a step, seconds.
const LONGEST: f32 = 3600.0;

/// State accessed by methods that release the GIL.
struct Inner {
    scene: Scene,
    settings: Values,
    gesture: Gesture,
    /// Vertices of the body and transforms of its joints, in place of the gesture.
    body: BodyInput,
    /// Whether the hair has been put at rest, by `reset` or on first use.
    is_initialized: bool,
    /// The groom, if it was made from given strands, until their places are known.
    groom: Option<Py<Groom>>,
    attachments: Option<StrandAttachments>,
}

/// Hair simulation on the GPU.
///
/// `step` advances the hair, `strands` and `guides` read it back, and `render` draws it. On the same GPU, the same
/// calls give bit-identical results.
///
/// Parameters
/// ----------
/// groom : Groom
///     Hair to simulate.
/// settings : dict or Settings, optional
///     Overrides of the groom's settings: physics, wind, colors, lights.
/// progress : callable, optional
///     Called with the current task (str) and the fraction of it that is done (0 to 1).
#[pyclass(frozen, module = "tresses")]
pub struct Simulation {
    inner: Mutex<Inner>,
}

/// Pose of the character and wind, as passed by the caller.
struct PoseInput {
    gesture: Gesture,
    body: BodyInput,
    wind: Option<Vec3>,
}

impl Simulation {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        // After a panic the scene may be partially updated; the next step sets the whole state again.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Applies the given arguments to the current gesture. Arguments that are `None` keep their last value.
    fn pose_input(
        &self,
        py: Python<'_>,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
        [skin, joints]: [Option<&Bound<'_, PyAny>>; 2],
    ) -> PyResult<PoseInput> {
        let mut gesture = py.detach(|| self.lock().gesture.clone());
        let deformed = match BodyInput::new(skin, joints)? {
            Some(deformed) => deformed,
            None => py.detach(|| self.lock().body.clone()),
        };
        if let Some(head) = head {
            gesture.head = pose(head, "head")?;
        }
        if let Some(body) = body {
            gesture.body = pose(body, "body")?;
        }
        if let Some(shapes) = shapes {
            gesture.shapes.clear();
            for (name, weight) in shapes {
                let (name, weight): (String, f32) = (name.extract()?, weight.extract()?);
                if !weight.is_finite() {
                    return Err(TressesError::new_err(format!(
                        "the weight of blend shape {name} is {weight}, but must be finite"
                    )));
                }
                gesture.shapes.push((Arc::from(name), weight));
            }
        }
        let wind = wind.map(|wind| vector(wind, "wind")).transpose()?;
        Ok(PoseInput { gesture, body: deformed, wind })
    }
}

impl Inner {
    fn take(&mut self, input: &PoseInput) -> anyhow::Result<()> {
        if let Some(rig) = self.scene.character.rig() {
            for (name, _) in &input.gesture.shapes {
                rig.find_shape(name)?;
            }
        }
        if let Some(wind) = input.wind {
            let mut physics = self.scene.character.physics;
            physics.wind.velocity = wind;
            physics.check()?;
            self.scene.character.physics = physics;
        }
        Ok(())
    }

    /// Poses the body by vertices or joints.
    fn deform(&mut self, body: &BodyInput) -> anyhow::Result<()> {
        let BodyInput { skin, joints } = body;
        if skin.is_none() && joints.is_none() {
            return Ok(());
        }
        let rigged = self.scene.character.rig_mut();
        let rigged = rigged.context("skin and joints need a rig: give Groom.of a Rig, or Rig.single()")?;
        let pose = joints.as_ref().map(|joints| rigged.pose_of(joints)).transpose()?;
        match skin {
            Some(skin) => rigged.set_vertices(skin, pose.as_ref())?,
            None => rigged.set_pose(pose),
        }
        Ok(())
    }

    fn rest(&mut self, input: PoseInput) -> anyhow::Result<()> {
        self.take(&input)?;
        self.deform(&input.body)?;
        self.scene.reset(&input.gesture)?;
        (self.gesture, self.body, self.is_initialized) = (input.gesture, input.body, true);
        Ok(())
    }

    /// Puts the hair at rest unless this has happened already.
    fn begin(&mut self) -> anyhow::Result<()> {
        if self.is_initialized {
            return Ok(());
        }
        let (gesture, body) = (self.gesture.clone(), self.body.clone());
        self.rest(PoseInput { gesture, body, wind: None })
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (groom, settings=None, *, progress=None))]
    fn new(
        py: Python<'_>,
        groom: &Bound<'_, Groom>,
        settings: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let given_groom = groom.get().given.is_some().then(|| groom.clone().unbind());
        let groom = groom.get();
        let mut all = settings::Settings(groom.settings.clone());
        if let Some(values) = settings {
            all.update(values)?;
        }
        let settings = settings_of_groom(all.0, groom)?;
        let inner = run(py, progress, async |teller| {
            let gpu = device::open()?;
            let companion_files = CompanionFiles::of(&groom.source, Shelf::default());
            let (colliders, surroundings) = (companion_files.colliders()?, companion_files.surroundings()?);
            let character = groom.character.clone();
            let quality = sampled(&settings, [16, 16], &gpu)?;
            let motion = settings.pipelines_of_motion(&character.guide_vertices());
            gpu.context.prepare(&motion, teller).await?;
            let scene = Scene::new(gpu, character, colliders, &settings, &quality, teller);
            let mut scene = scene.await?;
            scene.apply(&settings)?;
            scene.set_surroundings(surroundings.map(Arc::new));
            Ok(Inner {
                scene,
                settings: settings.clone(),
                gesture: Gesture::default(),
                body: BodyInput::default(),
                is_initialized: false,
                groom: given_groom,
                attachments: None,
            })
        })?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    /// Advance the simulation by a time step.
    ///
    /// Parameters
    /// ----------
    /// dt : float
    ///     Time step, seconds. The physics runs in as many fixed steps as are due, each of the length set by
    ///     ``simulation.step``. The visible hair is interpolated between the last two fixed steps.
    /// head : array [4, 4], or (translation, quaternion), optional
    ///     Pose of the head at the end of the step, relative to its rest pose: a rigid matrix, or a translation in
    ///     meters and a quaternion (x, y, z, w). Without it the head keeps its pose. The head moves evenly during the
    ///     step. If it jumps, its hair moves with it.
    /// body : array [4, 4], or (translation, quaternion), optional
    ///     Pose of the whole character, in the same forms as `head`.
    /// shapes : dict, optional
    ///     Weights of blend shapes by name (see the property `shapes`). Replaces all previous weights.
    /// wind : array [3], optional
    ///     Wind velocity far from the head, m/s. It stays in effect until the next `wind` argument or call of `apply`.
    /// skin : array [v, 3], optional
    ///     Vertices of the head mesh at the end of the step, as the caller has deformed them, relative to `body`, meters.
    ///     Replaces `head` and `shapes`. Requires a groom with a `Rig`.
    /// joints : array [j, 4, 4], optional
    ///     Transforms of the rig's joints at the end of the step, relative to `body`. They deform the mesh; beside `skin`
    ///     they tell only how the parts of the mesh move, which `step` otherwise fits to the vertices.
    #[pyo3(signature = (dt, head=None, *, body=None, shapes=None, wind=None, skin=None, joints=None))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn step(
        &self,
        py: Python<'_>,
        dt: f32,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
        skin: Option<&Bound<'_, PyAny>>,
        joints: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if !(0.0..=LONGEST).contains(&dt) {
            return Err(TressesError::new_err(format!("dt is {dt} s, but must be from 0 to {LONGEST}")));
        }
        let input = self.pose_input(py, head, body, shapes, wind, [skin, joints])?;
        run(py, None, async |teller| {
            let mut inner = self.lock();
            inner.begin()?;
            inner.take(&input)?;
            // The library runs at most `MAX_STEPS` fixed steps per frame and drops the rest, so split long steps.
            let max_dt = MAX_STEPS as f32 * inner.scene.character.physics.step;
            let parts = (dt / max_dt).ceil().max(1.0) as u32;
            let (from, first) = (inner.gesture.clone(), inner.body.clone());
            for part in 1..=parts {
                if part == parts {
                    inner.deform(&input.body)?;
                } else {
                    inner.deform(&first.lerp(&input.body, part as f32 / parts as f32))?;
                }
                let gesture = match part == parts {
                    true => input.gesture.clone(),
                    false => from.lerp(&input.gesture, part as f32 / parts as f32),
                };
                inner.scene.advance(&gesture, dt / parts as f32)?;
                inner.gesture = gesture;
                tresses::Progress::step(teller, "simulating", part as f32 / parts as f32).await;
            }
            inner.body = input.body;
            Ok(())
        })
    }

    /// Put the hair at rest on the posed character and set the time to 0.
    ///
    /// `step` describes the parameters. Omitted parameters keep their last value.
    ///
    /// Parameters
    /// ----------
    /// state : bytes, optional
    ///     Result of `state`: the hair starts with it instead of at rest. Give the pose of that moment too.
    #[pyo3(signature = (head=None, *, body=None, shapes=None, wind=None, skin=None, joints=None, state=None))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn reset(
        &self,
        py: Python<'_>,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
        skin: Option<&Bound<'_, PyAny>>,
        joints: Option<&Bound<'_, PyAny>>,
        state: Option<&[u8]>,
    ) -> PyResult<()> {
        let input = self.pose_input(py, head, body, shapes, wind, [skin, joints])?;
        run(py, None, async |_| {
            let mut inner = self.lock();
            let words = state.map(bytemuck::pod_collect_to_vec::<u8, u32>);
            let states = words.map(|words| GuideState::all_of(&words)).transpose()?;
            inner.rest(input)?;
            let Some(states) = states else { return Ok(()) };
            inner.scene.character.set_state(&states)?;
            // A frame without time draws the strands anew.
            let gesture = inner.gesture.clone();
            inner.scene.advance(&gesture, 0.0)
        })
    }

    /// Return the state of the hair, for `reset` of a Simulation of the same Groom with the same settings. The motion
    /// of the air is not part of it.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let words = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            let states = inner.scene.character.state().await?;
            Ok(states.iter().flat_map(GuideState::words).collect::<Vec<u32>>())
        })?;
        Ok(PyBytes::new(py, bytemuck::cast_slice(&words)))
    }

    /// Change the settings.
    ///
    /// Parameters
    /// ----------
    /// settings : dict or Settings
    ///     Settings to change. Parameters that require other strands (`Parameter.cost` is ``"regrow"``) raise
    ///     TressesError; create a new Groom to change them.
    fn apply(&self, py: Python<'_>, settings: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut all = settings::Settings(py.detach(|| self.lock().settings.clone()));
        all.update(settings)?;
        let settings = all.0;
        settings.check().map_err(raised)?;
        run(py, None, async |_| {
            let mut inner = self.lock();
            let changes = settings.changes(&inner.settings);
            ensure!(!changes.regrow, "these settings change the strands: create another Groom with them");
            inner.scene.apply(&settings)?;
            inner.settings = settings;
            Ok(())
        })
    }

    /// Return the render strands in their current state: Strands with widths, in world space, meters.
    fn strands(&self, py: Python<'_>) -> PyResult<Strands> {
        run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            inner.scene.drawn([&inner.scene.character.hair().strands]).await
        })
        .map(Strands)
    }

    /// Return the strands given to `Groom.of` in their current state, in world space, meters: float32 [all, 3], vertex
    /// by vertex in the given order. Strands that the repair has dropped move with the head. Curls, length and other
    /// settings that restyle strands do not show.
    fn given<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let positions = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            if inner.attachments.is_none() {
                let groom = inner.groom.as_ref().map(Py::get);
                let (groom, given) = groom
                    .and_then(|groom| Some((groom, groom.given.as_ref()?)))
                    .context("the groom was not made by Groom.of")?;
                let rest = groom.character.groom.strands.unbound();
                inner.attachments = Some(StrandAttachments::new(given, &rest, &groom.order)?);
                inner.groom = None;
            }
            let drawn = inner.scene.drawn([&inner.scene.character.hair().strands]).await?;
            let attachments = inner.attachments.as_ref().context("the places of the strands are known")?;
            attachments.deformed_positions(&drawn.positions, &inner.scene.character.head())
        })?;
        points(py, &positions)
    }

    /// Return brows, lashes and beard in their current state, one Strands each. Outputs of `render` number them as
    /// grooms 1, 2, ….
    fn face(&self, py: Python<'_>) -> PyResult<Vec<Strands>> {
        let all = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            let mut all = Vec::new();
            for hair in inner.scene.character.grooms().skip(1) {
                all.push(inner.scene.drawn([&hair.strands]).await?);
            }
            Ok(all)
        })?;
        Ok(all.into_iter().map(Strands).collect())
    }

    /// Return the guides after the last fixed step, in world space, meters: float32 [g, v, 3].
    fn guides<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (shape, guides) = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            let guides = &inner.scene.character.hair().guides;
            let shape = [guides.count as usize, guides.vertex_count as usize, 3];
            Ok((shape, inner.scene.guides().await?))
        })?;
        floats(py, &shape, &guides)
    }

    /// Render the current state.
    ///
    /// Parameters
    /// ----------
    /// camera : str, (eye, target) or (view, projection), optional
    ///     ``"front"``, ``"three-quarter"`` (the default), ``"side"`` or ``"back"``, or position and target of the
    ///     camera in meters. The vertical field of view is 30°. Or the matrices (view, projection) of any camera, as
    ///     `camera` returns them.
    /// size : (int, int)
    ///     Width and height, pixels.
    /// outputs : list of str, optional
    ///     Names of the arrays to return, see below. Without it only ``color``.
    /// zoom : float
    ///     Zoom factor of a named camera; 2 shows half as much.
    /// distance : float, optional
    ///     Distance of the camera from its target, meters.
    /// background : ``"transparent"`` or array [3], optional
    ///     No background, or its linear radiance. The default is a grayish blue.
    /// head : bool or ``"holdout"``
    ///     Whether to draw the head. With False, the head neither occludes hair nor casts shadows. A holdout does, but is
    ///     itself transparent.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Arrays by output name, rows from the top:
    ///     ``color`` uint8 [h, w, 4], sRGB and alpha (premultiplied before encoding);
    ///     ``linear`` float32 [h, w, 4], radiance before exposure and tone mapping, premultiplied;
    ///     ``body_depth`` float32 [h, w], view-space depth of the body in meters, also behind hair, inf without body;
    ///     ``body_normal`` float32 [h, w, 3], unit normal of the body in world space, 0 without body;
    ///     ``coverage`` float32 [h, w], opacity of the hair;
    ///     ``depth`` float32 [h, w], view-space depth of the visible hair in meters, inf without hair;
    ///     ``motion`` float32 [h, w, 2], motion in pixels to the right and down since the last render that had any
    ///     output from ``coverage`` on, nan if unknown;
    ///     ``groom`` int32 [h, w], 0 for the hair, 1 and up for the items of ``face()``, -1 without hair;
    ///     ``strand`` int32 [h, w], index in this groom of the strand that covers most of the pixel, -1 without hair;
    ///     ``share`` float32 [h, w], share of the pixel that this strand covers;
    ///     ``along`` float32 [h, w], position along this strand from 0 (root) to 1 (tip), nan without hair;
    ///     ``tangent`` float32 [h, w, 3], direction of this strand from root to tip in world space, 0 without hair.
    ///     The outputs from ``coverage`` on require tiled hair (``renderer.kind``) without supersampling
    ///     (``edges.ssaa``).
    #[pyo3(signature = (camera=None, size=(1280, 720), outputs=None, *, zoom=1.0, distance=None, background=None, head=HeadDrawing::Shown(true)))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&Bound<'py, PyAny>>,
        size: (u32, u32),
        outputs: Option<Vec<String>>,
        zoom: f32,
        distance: Option<f32>,
        background: Option<&Bound<'py, PyAny>>,
        head: HeadDrawing,
    ) -> PyResult<Bound<'py, PyDict>> {
        let names = OutputNames::new(outputs.unwrap_or_else(|| vec!["color".into()]))?;
        let size = sized(size)?;
        let background = match background {
            None => Background::default(),
            Some(of) if of.extract::<String>().is_ok_and(|name| name == "transparent") => {
                Background::transparent()
            }
            Some(of) => Background::flat(vector(of, "background")?),
        };
        let view = self.look(py, camera, size, zoom, distance)?;
        let request = head.request(names.request())?;
        let (captured, projection, strands) = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            let Inner { scene, settings, .. } = &mut *inner;
            let quality = sampled(settings, size, &scene.gpu)?;
            ensure!(
                !request.hair || quality.ssaa == 1,
                "outputs of the hair need images without supersampling: set edges.ssaa to 1"
            );
            scene.set_quality(&quality)?;
            scene.gpu.context.prepare(&settings.pipelines(quality.view), &()).await?;
            scene.picture.background = background;
            let captured = scene.capture(view, request).await?;
            let mut strands = Vec::new();
            if names.needs_strands() {
                for hair in scene.character.grooms() {
                    strands.push(scene.drawn([&hair.strands]).await?);
                }
            }
            Ok((captured, scene.picture.camera.projection, strands))
        })?;
        picture::outputs(py, &names, &captured, (size, projection), &strands)
    }

    /// Return the matrices of a camera. `render` describes the parameters.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``view``, from world space to camera space (looking along -Z), and ``projection``, from camera space to
    ///     normalized device coordinates (Y up, depth 1 at the near plane and 0 at infinity): float32 [4, 4], for
    ///     column vectors.
    #[pyo3(signature = (camera=None, size=(1280, 720), *, zoom=1.0, distance=None))]
    fn camera<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&Bound<'py, PyAny>>,
        size: (u32, u32),
        zoom: f32,
        distance: Option<f32>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let size = sized(size)?;
        let view = self.look(py, camera, size, zoom, distance)?;
        let camera = view.camera(size);
        let dict = PyDict::new(py);
        dict.set_item("view", matrix(py, camera.view)?)?;
        dict.set_item("projection", matrix(py, camera.projection)?)?;
        Ok(dict)
    }

    /// Time since the hair was put at rest, seconds.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.lock().scene.character.time())
    }

    /// Joint that the head turns about, meters: 3 numbers.
    #[getter]
    fn pivot(&self, py: Python<'_>) -> [f32; 3] {
        py.detach(|| self.lock().scene.character.neck().to_array())
    }

    /// Pose of the head relative to its rest pose: translation and quaternion (x, y, z, w).
    #[getter]
    fn head(&self, py: Python<'_>) -> PoseTuple {
        py.detach(|| pose_to_tuple(&self.lock().scene.character.head()))
    }

    /// Names of the character's blend shapes.
    #[getter]
    fn shapes(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| {
            let inner = self.lock();
            inner.scene.character.rig().into_iter().flat_map(|rig| rig.shapes()).map(str::to_owned).collect()
        })
    }

    /// Current settings.
    #[getter]
    fn settings(&self, py: Python<'_>) -> settings::Settings {
        settings::Settings(py.detach(|| self.lock().settings.clone()))
    }

    /// GPU memory of the hair, bytes.
    #[getter]
    fn bytes(&self, py: Python<'_>) -> u64 {
        py.detach(|| self.lock().scene.facts().bytes)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let facts = py.detach(|| self.lock().scene.facts());
        format!("Simulation({} strands, {} guides)", facts.strands, facts.guides)
    }
}

impl Simulation {
    fn look(
        &self,
        py: Python<'_>,
        camera: Option<&Bound<'_, PyAny>>,
        size: [u32; 2],
        zoom: f32,
        distance: Option<f32>,
    ) -> PyResult<CaptureCamera> {
        let subject = py.detach(|| self.lock().scene.subject());
        let default_camera = pyo3::types::PyString::new(py, "three-quarter").into_any();
        capture_camera(camera.unwrap_or(&default_camera), subject, size, zoom, distance)
    }
}

/// Returns the image quality for frames of `size` pixels.
fn sampled(settings: &Values, size: [u32; 2], gpu: &Gpu) -> anyhow::Result<Quality> {
    let max_samples = gpu.context.tier().max_samples;
    let quality = settings.quality(size, max_samples)?;
    ensure!(
        quality.view.renderer.samples() <= max_samples,
        "renderer.samples is {}, but {} supports at most {max_samples}",
        quality.view.renderer.samples(),
        gpu.info.name
    );
    Ok(quality)
}

/// Checks the size of a frame.
fn sized((width, height): (u32, u32)) -> PyResult<[u32; 2]> {
    if width == 0 || height == 0 {
        return Err(TressesError::new_err(format!("size is {width} x {height}, but both must be above 0")));
    }
    Ok([width, height])
}

/// Checks that `settings` keep the strands of an existing groom.
fn settings_of_groom(settings: Values, groom: &Groom) -> PyResult<Values> {
    settings.check().map_err(raised)?;
    if settings.changes(&groom.settings).regrow {
        return Err(TressesError::new_err("these settings change the strands: give them to the Groom"));
    }
    Ok(settings)
}
