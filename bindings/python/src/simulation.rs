//! Hair that moves, step by step, and pictures of it.

// What waits is polled by one thread, which holds the lock for as long as the work lasts.
#![allow(clippy::await_holding_lock)]

use crate::{
    TressesError,
    arrays::floats,
    device,
    groom::Groom,
    picture::{self, Wanted, matrix, viewpoint},
    pose::{Told, pose, told, vector},
    raised, settings,
    strands::Strands,
    work::run,
};
use anyhow::ensure;
use numpy::PyArrayDyn;
use pyo3::{prelude::*, types::PyDict};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tresses::{Camera, character::Gesture, clock::MAX_STEPS, glam::Vec3, gpu::Gpu, present::Background};
use tresses_scene::{
    Companions, Quality, Scene, Shelf, camera::VERTICAL_FOV, scene::Asked, settings::Settings as Values,
};

/// The longest step, seconds.
const LONGEST: f32 = 3600.0;

/// What is behind methods that release the interpreter's lock.
struct Inner {
    scene: Scene,
    settings: Values,
    gesture: Gesture,
    /// Whether hair has been put to rest since what the character does was said last.
    begun: bool,
}

/// Hair on the GPU: it is moved by `step`, read by `strands` and `guides`, drawn by `render`. The same calls give the same
/// bits, on one GPU.
///
/// Parameters
/// ----------
/// groom : Groom
/// settings : dict or Settings, optional
///     What differs from the settings that the groom was made with: physics, wind, colours, lights.
/// progress : callable, optional
///     Is called with what goes on (str) and how much of it is done (0 to 1).
#[pyclass(frozen, module = "tresses")]
pub struct Simulation {
    inner: Mutex<Inner>,
}

/// What the character does, as a caller says it.
struct Said {
    gesture: Gesture,
    wind: Option<Vec3>,
}

impl Simulation {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        // After a panic the scene is one that has not been told everything: the next step tells it again.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is said, on top of what was said before.
    fn said(
        &self,
        py: Python<'_>,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Said> {
        let mut gesture = py.detach(|| self.lock().gesture.clone());
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
                    return Err(TressesError::new_err(format!("the shape {name} has the weight {weight}")));
                }
                gesture.shapes.push((Arc::from(name), weight));
            }
        }
        let wind = wind.map(|wind| vector(wind, "wind")).transpose()?;
        Ok(Said { gesture, wind })
    }
}

impl Inner {
    fn take(&mut self, said: &Said) -> anyhow::Result<()> {
        if let Some(rig) = self.scene.character.rig() {
            for (name, _) in &said.gesture.shapes {
                rig.find_shape(name)?;
            }
        }
        if let Some(wind) = said.wind {
            let mut physics = self.scene.character.physics;
            physics.wind.velocity = wind;
            physics.check()?;
            self.scene.character.physics = physics;
        }
        Ok(())
    }

    fn rest(&mut self, said: Said) -> anyhow::Result<()> {
        self.take(&said)?;
        self.scene.reset(&said.gesture)?;
        (self.gesture, self.begun) = (said.gesture, true);
        Ok(())
    }

    /// Makes what is to be seen of hair that nobody has moved yet.
    fn begin(&mut self) -> anyhow::Result<()> {
        if self.begun {
            return Ok(());
        }
        self.rest(Said { gesture: self.gesture.clone(), wind: None })
    }
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (groom, settings=None, *, progress=None))]
    fn new(
        py: Python<'_>,
        groom: &Groom,
        settings: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mut all = settings::Settings(groom.settings.clone());
        if let Some(values) = settings {
            all.update(values)?;
        }
        let settings = settings_of_groom(all.0, groom)?;
        let inner = run(py, progress, async |teller| {
            let gpu = device::open()?;
            let companions = Companions::of(&groom.source, Shelf::default());
            let (colliders, surroundings) = (companions.colliders()?, companions.surroundings()?);
            let character = groom.character.clone();
            let quality = sampled(&settings, [16, 16], &gpu)?;
            let motion = settings.pipelines_of_motion(&character.guide_vertices());
            gpu.context.prepare(&motion, teller).await?;
            let physics = settings.physics();
            let scene = Scene::new(gpu, character, colliders, &physics, &quality, teller);
            let mut scene = scene.await?;
            scene.apply(&settings)?;
            scene.set_surroundings(surroundings.map(Arc::new));
            Ok(Inner { scene, settings: settings.clone(), gesture: Gesture::default(), begun: false })
        })?;
        Ok(Self { inner: Mutex::new(inner) })
    }

    /// Time passes, and the hair moves.
    ///
    /// Parameters
    /// ----------
    /// dt : float
    ///     Seconds. The physics goes on in fixed steps of ``1 / simulation.rate``, as many as are due; what is seen lies
    ///     between the last two.
    /// head : array [4, 4], or (translation, quaternion), optional
    ///     Where the head is at the end of the step, relative to where it rests: a rigid matrix, or metres and (x, y, z, w).
    ///     Without it the head stays where it is. It moves evenly during the step; one that jumps takes its hair along.
    /// body : likewise, optional
    ///     Where all of the character is.
    /// shapes : dict, optional
    ///     How much there is of the body's shapes (`shapes`), instead of what was said before.
    /// wind : array [3], optional
    ///     Velocity of the air far from the head, m/s, from here on, until `apply` says another.
    #[pyo3(signature = (dt, head=None, *, body=None, shapes=None, wind=None))]
    fn step(
        &self,
        py: Python<'_>,
        dt: f32,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if !(0.0..=LONGEST).contains(&dt) {
            return Err(TressesError::new_err(format!("dt is {dt} s, but must be from 0 to {LONGEST}")));
        }
        let said = self.said(py, head, body, shapes, wind)?;
        run(py, None, async |teller| {
            let mut inner = self.lock();
            inner.begin()?;
            inner.take(&said)?;
            // A frame of the library has so many fixed steps at most, and leaves the rest out.
            let most = MAX_STEPS as f32 * inner.scene.character.physics.step;
            let parts = (dt / most).ceil().max(1.0) as u32;
            let from = inner.gesture.clone();
            for part in 1..=parts {
                let gesture = match part == parts {
                    true => said.gesture.clone(),
                    false => from.lerp(&said.gesture, part as f32 / parts as f32),
                };
                inner.scene.advance(&gesture, dt / parts as f32)?;
                inner.gesture = gesture;
                tresses::Progress::step(teller, "simulating", part as f32 / parts as f32).await;
            }
            Ok(())
        })
    }

    /// Puts the hair to rest on a character that does what is said; time is 0.
    #[pyo3(signature = (head=None, *, body=None, shapes=None, wind=None))]
    fn reset(
        &self,
        py: Python<'_>,
        head: Option<&Bound<'_, PyAny>>,
        body: Option<&Bound<'_, PyAny>>,
        shapes: Option<&Bound<'_, PyDict>>,
        wind: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let said = self.said(py, head, body, shapes, wind)?;
        run(py, None, async |_| self.lock().rest(said))
    }

    /// Takes other settings from here on: None, a dict of what changes, or Settings. What makes other strands
    /// (`Parameter.cost` is ``"regrow"``) is refused: that takes another Groom.
    fn apply(&self, py: Python<'_>, settings: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut all = settings::Settings(py.detach(|| self.lock().settings.clone()));
        all.update(settings)?;
        let settings = all.0;
        settings.check().map_err(raised)?;
        run(py, None, async |_| {
            let mut inner = self.lock();
            let changes = settings.changes(&inner.settings);
            ensure!(!changes.regrow, "these settings make other strands: make another Groom with them");
            inner.scene.apply(&settings)?;
            inner.settings = settings;
            Ok(())
        })
    }

    /// The strands as they are drawn now, in the world: Strands with widths, metres.
    fn strands(&self, py: Python<'_>) -> PyResult<Strands> {
        run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            inner.scene.drawn([&inner.scene.character.hair().strands]).await
        })
        .map(Strands)
    }

    /// Brows, lashes and beard as they are drawn now, one Strands each: outputs name them as grooms 1, 2, ….
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

    /// The guides after the last fixed step, in the world, metres: float32 [g, v, 3].
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

    /// Draws the hair as it is now.
    ///
    /// Parameters
    /// ----------
    /// camera : str, or (eye, target)
    ///     ``"front"``, ``"three-quarter"``, ``"side"`` or ``"back"``, or where it is and what it looks at, metres. The field of
    ///     view is 30° vertically.
    /// size : (int, int)
    ///     Width and height, pixels.
    /// outputs : list of str
    ///     What is returned, see below.
    /// zoom, distance : float, optional
    ///     How much closer a named camera is, and how far from what it looks at, metres.
    /// background : ``"transparent"`` or array [3], optional
    ///     Nothing, or linear radiance; grey-blue without it.
    /// head : bool
    ///     Whether the head is drawn; it casts no shadows and hides nothing where it is not.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Arrays, rows from the top:
    ///     ``color`` uint8 [h, w, 4], sRGB and alpha (premultiplied before it is encoded);
    ///     ``linear`` float32 [h, w, 4], radiance before exposure and tone mapping, premultiplied;
    ///     ``coverage`` float32 [h, w], how opaque the hair is;
    ///     ``depth`` float32 [h, w], metres along the view to what is seen of the hair, inf where there is none;
    ///     ``motion`` float32 [h, w, 2], pixels to the right and down since the last picture that had one of these outputs,
    ///     nan where that is not known;
    ///     ``strand`` int32 [h, w], the strand that the pixel shows most of, -1 for none: an index into ``strands()``;
    ///     ``groom`` int32 [h, w], 0 for the hair, from 1 on those of ``face()``, -1 for none;
    ///     ``share`` float32 [h, w], how much of the pixel that strand covers;
    ///     ``along`` float32 [h, w], where on it, 0 (root) to 1 (tip), nan for none;
    ///     ``tangent`` float32 [h, w, 3], its direction from root to tip in the world, 0 for none.
    #[pyo3(signature = (camera=None, size=(1280, 720), outputs=None, *, zoom=1.0, distance=None, background=None, head=true))]
    #[allow(clippy::too_many_arguments)] // Keywords.
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: Option<&Bound<'py, PyAny>>,
        size: (u32, u32),
        outputs: Option<Vec<String>>,
        zoom: f32,
        distance: Option<f32>,
        background: Option<&Bound<'py, PyAny>>,
        head: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wanted = Wanted::new(outputs.unwrap_or_else(|| vec!["color".into()]))?;
        let size = sized(size)?;
        let background = match background {
            None => Background::default(),
            Some(of) if of.extract::<String>().is_ok_and(|name| name == "transparent") => {
                Background::transparent()
            }
            Some(of) => Background::flat(vector(of, "background")?),
        };
        let view = self.look(py, camera, size, zoom, distance)?;
        let asked = Asked { bare: !head, ..wanted.asked() };
        let (captured, projection, strands) = run(py, None, async |_| {
            let mut inner = self.lock();
            inner.begin()?;
            let Inner { scene, settings, .. } = &mut *inner;
            let quality = sampled(settings, size, &scene.gpu)?;
            ensure!(
                !asked.hair || quality.ssaa == 1,
                "where hair is, is known of pictures without supersampling: set edges.ssaa to 1"
            );
            scene.set_quality(&quality)?;
            scene.gpu.context.prepare(&settings.pipelines(quality.view), &()).await?;
            scene.picture.background = background;
            let captured = scene.capture(&view, asked).await?;
            let mut strands = Vec::new();
            if wanted.needs_strands() {
                for hair in scene.character.grooms() {
                    strands.push(scene.drawn([&hair.strands]).await?);
                }
            }
            Ok((captured, scene.picture.camera.projection, strands))
        })?;
        picture::outputs(py, &wanted, &captured, (size, projection), &strands)
    }

    /// The matrices of a camera of `render`: a dict of ``view`` (from the world to the camera, which looks along -Z) and
    /// ``projection`` (to normalised coordinates, y up, depth 1 at the near plane and 0 far away), float32 [4, 4] for columns.
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
        let camera = Camera::look_at(view.eye, view.target, VERTICAL_FOV, size);
        let dict = PyDict::new(py);
        dict.set_item("view", matrix(py, camera.view)?)?;
        dict.set_item("projection", matrix(py, camera.projection)?)?;
        Ok(dict)
    }

    /// Seconds since the hair was put to rest.
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.lock().scene.character.time())
    }

    /// The joint that the head turns about, metres: 3 numbers.
    #[getter]
    fn pivot(&self, py: Python<'_>) -> [f32; 3] {
        py.detach(|| self.lock().scene.character.neck().to_array())
    }

    /// Where the head is, relative to where it rests: translation and quaternion (x, y, z, w).
    #[getter]
    fn head(&self, py: Python<'_>) -> Told {
        py.detach(|| told(&self.lock().scene.character.head()))
    }

    /// The names of the body's shapes.
    #[getter]
    fn shapes(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| {
            let inner = self.lock();
            inner.scene.character.rig().into_iter().flat_map(|rig| rig.shapes()).map(str::to_owned).collect()
        })
    }

    /// The settings that it has now.
    #[getter]
    fn settings(&self, py: Python<'_>) -> settings::Settings {
        settings::Settings(py.detach(|| self.lock().settings.clone()))
    }

    /// Bytes of GPU memory that the hair takes.
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
    ) -> PyResult<tresses_scene::Viewpoint> {
        let subject = py.detach(|| self.lock().scene.subject());
        let usual = pyo3::types::PyString::new(py, "three-quarter").into_any();
        viewpoint(camera.unwrap_or(&usual), subject, size, zoom, distance)
    }
}

/// How pictures of `size` are sampled.
fn sampled(settings: &Values, size: [u32; 2], gpu: &Gpu) -> anyhow::Result<Quality> {
    let most = gpu.context.tier().max_samples;
    let quality = settings.quality(size, most)?;
    ensure!(
        quality.view.samples <= most,
        "{} samples per pixel, but {} offers at most {most}",
        quality.view.samples,
        gpu.info.name
    );
    Ok(quality)
}

/// The size of a picture.
fn sized((width, height): (u32, u32)) -> PyResult<[u32; 2]> {
    if width == 0 || height == 0 {
        return Err(TressesError::new_err(format!("a picture of {width} x {height} pixels has none")));
    }
    Ok([width, height])
}

/// `settings` for hair that is there already.
fn settings_of_groom(settings: Values, groom: &Groom) -> PyResult<Values> {
    settings.check().map_err(raised)?;
    if settings.changes(&groom.settings).regrow {
        return Err(TressesError::new_err("these settings make other strands: give them to the Groom"));
    }
    Ok(settings)
}
