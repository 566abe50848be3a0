//! Grooms: render strands and their guides, with or without a head.

use crate::{
    TressesError,
    arrays::{array, floats, given_numbers_for, given_points},
    cards::Cards,
    device,
    files::{Orientation, paths},
    mesh::Mesh,
    raised,
    reading::unknown,
    rig::Rig,
    settings::{self, settings_of},
    strands::Strands,
    work::run,
};
use numpy::PyArrayDyn;
use pyo3::{prelude::*, types::PyDict};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use tresses::{
    CharacterParts, CharacterSource,
    groom::{
        self,
        cards::CardOptions,
        edit::{GroomDocument, GroomEditor, HeadFiles, StrokeScript},
        import::ImportOptions,
        lint,
    },
    low_level::lod,
};
use tresses_scene::{
    CompanionFiles, Preset, PresetSource, Shelf,
    cards::{LevelRequest, of_parts, options},
    settings::Settings,
    source,
};

/// Hair that is ready for simulation.
///
/// A groom has guides, which are simulated, and render strands, which follow them. It may have a head. Create one with
/// `built_in`, `read`, `of` or `preset`.
#[pyclass(frozen, module = "tresses")]
pub struct Groom {
    /// The character, with strands in drawing order.
    pub character: CharacterParts,
    /// Names of the companion files.
    pub source: PresetSource,
    /// Settings the groom was made with.
    pub settings: Settings,
    /// Source index of each strand.
    pub order: Vec<u32>,
    /// The strands of `of`, before their repair.
    pub given: Option<groom::Strands>,
}

/// Sets the companion files that the keyword arguments name in `source`.
fn set_companion_files(source: &mut PresetSource, files: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    for (key, file) in files.into_iter().flatten() {
        let key: String = key.extract()?;
        let companion = source::companion(&key)
            .ok_or_else(|| unknown(&key, source::COMPANION_FILES.iter().map(|companion| companion.key)))?;
        let file: PathBuf = file.extract()?;
        companion.set(source, Some(file.to_string_lossy().into_owned()));
    }
    Ok(())
}

impl Groom {
    fn new(mut character: CharacterParts, preset: Preset) -> Self {
        let strands = &mut character.groom.strands;
        // The upload sorts strands the same way; sorting sorted strands has no effect.
        let order = lod::order(strands);
        lod::arrange(strands);
        Self { character, source: preset.source, settings: preset.settings, order, given: None }
    }

    /// Multiplies the stiffness of each guide by the mean of `factors`, one per strand of `given`, over the strands
    /// that follow it.
    fn stiffen(&mut self, given: &groom::Strands, factors: &[f32]) {
        let (_, kept) = lint::repair_kept(&mut given.clone());
        let groom = &mut self.character.groom;
        let mut sums = vec![(0.0, 0.0); groom.guides.len()];
        for (binding, source) in groom.strands.bindings.iter().zip(&self.order) {
            let Some(factor) = kept.get(*source as usize).map(|i| factors[*i as usize]) else { continue };
            for (guide, weight) in binding.weighted() {
                let sum: &mut (f32, f32) = &mut sums[guide];
                (sum.0, sum.1) = (sum.0 + weight * factor, sum.1 + weight);
            }
        }
        for (stiffness, (sum, weight)) in groom.guides.stiffness.iter_mut().zip(sums) {
            *stiffness *= if weight > 0.0 { sum / weight } else { 1.0 };
        }
    }

    fn open(py: Python<'_>, preset: Preset, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let character =
            run(py, progress, async |teller| preset.character(&device::open()?.context, teller).await)?;
        Ok(Self::new(character, preset))
    }
}

#[pymethods]
impl Groom {
    /// Grow a built-in hairstyle on the built-in character.
    ///
    /// Parameters
    /// ----------
    /// style : str
    ///     ``"long"``, ``"bob"``, ``"curly"`` or ``"short"``.
    /// settings : dict or Settings, optional
    ///     Settings for growth and the initial settings of a `Simulation`. For example, ``style.strands`` sets the
    ///     number of strands and ``style.seed`` the random seed.
    /// progress : callable, optional
    ///     Called with the current task (str) and the fraction of it that is done (0 to 1).
    /// head : path or list of paths, optional
    ///     Mesh that the style grows on, in place of the built-in head. The style is scaled to the head.
    /// **files : path
    ///     Companion files: density_map, thickness_map, length_map, curl_map, stiffness_map, color_map, curl_curve,
    ///     lod_maps, colliders, ties, environment.
    #[staticmethod]
    #[pyo3(signature = (style="long", settings=None, *, head=None, progress=None, **files))]
    fn built_in(
        py: Python<'_>,
        style: &str,
        settings: Option<&Bound<'_, PyAny>>,
        head: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
        files: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let style: groom::styles::Style = style.parse().map_err(raised)?;
        let heads = head.map(paths).transpose()?.unwrap_or_default();
        let mut source = PresetSource { style: Some(style.name().to_owned()), heads, ..Default::default() };
        set_companion_files(&mut source, files)?;
        Self::open(py, Preset { name: None, source, settings: settings_of(settings)? }, progress)
    }

    /// Read a groom from files, with its head.
    ///
    /// Parameters
    /// ----------
    /// files : path or list of paths
    ///     Files of the groom; ``formats()["grooms"]`` lists the extensions.
    /// head : path or list of paths, optional
    ///     Mesh that the hair grows on. A mesh with joints, blend shapes or animations becomes a skinned body.
    /// settings, progress, **beside
    ///     As `settings`, `progress` and `files` of `built_in`.
    /// unit, up, front, mirror : optional
    ///     Known unit and axes of the groom; the importer guesses the others.
    #[staticmethod]
    #[pyo3(signature = (files, head=None, settings=None, *, unit=None, up=None, front=None, mirror=None, progress=None,
        **beside))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn read(
        py: Python<'_>,
        files: &Bound<'_, PyAny>,
        head: Option<&Bound<'_, PyAny>>,
        settings: Option<&Bound<'_, PyAny>>,
        unit: Option<String>,
        up: Option<String>,
        front: Option<String>,
        mirror: Option<bool>,
        progress: Option<Py<PyAny>>,
        beside: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let orient = Orientation { unit, up, front, mirror }.choice()?;
        let mut source = PresetSource {
            grooms: paths(files)?,
            heads: head.map(paths).transpose()?.unwrap_or_default(),
            orientation: ImportOptions { orient, ..Default::default() },
            ..Default::default()
        };
        set_companion_files(&mut source, beside)?;
        Self::open(py, Preset { name: None, source, settings: settings_of(settings)? }, progress)
    }

    /// Create a groom from strands in arrays, with or without a head.
    ///
    /// Coordinates are meters, Y up, face toward +Z. Invalid strands are repaired as by `Strands.repaired`. The groom
    /// keeps the widths and colors of the strands, and simulates those that are guides. `rig` makes the head, or the
    /// whole body, follow `joints` or `skin` of `Simulation.step`. `stiffness`, array [n], has a factor on the
    /// stiffness of each strand. `built_in` describes the other parameters.
    #[staticmethod]
    #[pyo3(signature = (strands, head=None, settings=None, *, rig=None, stiffness=None, progress=None, **files))]
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    fn of(
        py: Python<'_>,
        strands: &Strands,
        head: Option<&Mesh>,
        settings: Option<&Bound<'_, PyAny>>,
        rig: Option<&Rig>,
        stiffness: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
        files: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let stiffness =
            stiffness.map(|of| given_numbers_for(of, "stiffness", strands.0.len())).transpose()?;
        if stiffness.iter().flatten().any(|factor| !(factor.is_finite() && *factor >= 0.0)) {
            return Err(TressesError::new_err("factors of stiffness must be finite and not below 0"));
        }
        let rig = match (rig, head) {
            (Some(rig), Some(head)) => Some(rig.of(head)?),
            (Some(_), None) => return Err(TressesError::new_err("a rig needs the head that it moves")),
            (None, _) => None,
        };
        let mut source = PresetSource::default();
        set_companion_files(&mut source, files)?;
        let settings = settings_of(settings)?;
        let character = run(py, progress, async |teller| {
            let maps = CompanionFiles::of(&source, Shelf::default()).maps()?;
            let head = head.map(|head| head.0.clone());
            let base = CharacterSource::given(strands.0.clone(), head, rig, teller).await?;
            Ok(base.parts(&settings.styling(None, &maps)?, teller).await?)
        })?;
        let mut groom = Self::new(character, Preset { name: None, source, settings });
        if let Some(factors) = stiffness {
            groom.stiffen(&strands.0, &factors);
        }
        Ok(Self { given: Some(strands.0.clone()), ..groom })
    }

    /// Create the groom of a preset file (.toml): hair, head, companion files and settings. `settings` take precedence
    /// over the file.
    #[staticmethod]
    #[pyo3(signature = (file, settings=None, *, progress=None))]
    fn preset(
        py: Python<'_>,
        file: PathBuf,
        settings: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mut preset = Preset::open(&file).map_err(raised)?;
        if let Some(values) = settings {
            let mut all = settings::Settings(preset.settings);
            all.update(values)?;
            preset.settings = all.0;
        }
        preset.settings.check().map_err(raised)?;
        Self::open(py, preset, progress)
    }

    /// Return the render strands at rest, in the order of `Simulation.strands`: Strands with widths, and with colors if
    /// the groom has them.
    fn strands(&self, py: Python<'_>) -> Strands {
        py.detach(|| Strands(self.character.groom.strands.unbound()))
    }

    /// Bake the groom to textured cards with levels of detail: Cards.
    ///
    /// Parameters
    /// ----------
    /// levels : list of int
    ///     Number of cards of each level, falling. ``"helmet"`` at the end adds an opaque shell.
    /// texture : int
    ///     Edge of the textures, texels: a power of two from 128 to 8192.
    /// textures : int
    ///     Number of different pictures of locks in the textures.
    /// triangles : list of int, optional
    ///     Largest number of triangles of each level.
    /// bones : int
    ///     Chains of four bones that carry the cards in a ``.glb``, at most 256.
    /// progress : callable, optional
    ///     As for `built_in`.
    #[allow(clippy::too_many_arguments)] // Python keyword arguments.
    #[pyo3(signature = (levels=None, *, texture=2048, textures=32, triangles=None, bones=0, progress=None))]
    fn cards(
        &self,
        py: Python<'_>,
        levels: Option<Vec<Bound<'_, PyAny>>>,
        texture: u32,
        textures: u32,
        triangles: Option<Vec<u32>>,
        bones: u32,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Cards> {
        let level_options = match levels {
            Some(levels) => {
                let level = |level: &Bound<'_, PyAny>| {
                    level.str()?.to_string().parse::<LevelRequest>().map_err(raised)
                };
                options(&levels.iter().map(level).collect::<PyResult<Vec<_>>>()?).map_err(raised)?
            }
            None => CardOptions::default(),
        };
        let triangles = triangles.unwrap_or_default();
        let options = CardOptions {
            texture_size: texture,
            lock_texture_count: textures,
            triangles,
            chain_count: bones,
            ..level_options
        };
        let (character, colored) = (&self.character, self.settings.material().uses_file_colors);
        let head = character.head.clone();
        let rig = self.character.anatomy.as_ref().map(|anatomy| anatomy.rig.clone());
        let baked = run(py, progress, async |teller| of_parts(character, &options, colored, teller).await)?;
        Ok(Cards::new(
            baked,
            character.groom.strands.len(),
            self.settings.clone(),
            head.map(|head| (head, rig)),
        ))
    }

    /// Return the groom with its hair drawn as a level of `cards`, which were baked from it. The cards move with the
    /// guides. The strands of the result are the columns of the cards.
    ///
    /// Parameters
    /// ----------
    /// cards : Cards
    ///     Result of `cards`.
    /// level : int
    ///     Index of the level. A helmet cannot be drawn.
    #[pyo3(signature = (cards, level=0))]
    fn with_cards(&self, cards: &Cards, level: usize) -> PyResult<Self> {
        let mut character = self.character.clone().with_cards(cards.baked(), level).map_err(raised)?;
        let order = lod::order(&character.groom.strands);
        lod::arrange(&mut character.groom.strands);
        if let Some(sheet) = &mut character.cards {
            let strips = sheet.strips_in(&order).map_err(raised)?;
            Arc::make_mut(sheet).strips = strips;
        }
        Ok(Self {
            character,
            source: self.source.clone(),
            settings: self.settings.clone(),
            order,
            given: None,
        })
    }

    /// Return the groom after a stroke of a brush without a camera, on both sides of the head.
    ///
    /// Parameters
    /// ----------
    /// tool : str
    ///     comb, grab, smooth, puff, lay, pinch, spread, cut, line, length, plant, remove, refine, part, width,
    ///     stiffness, color or hold.
    /// path : array_like, float32 [n, 3]
    ///     The middle of the brush, meters.
    /// **brush : optional
    ///     ``radius`` (meters), ``strength``, ``falloff``, ``reach``, ``root_tip``, ``share``, ``keep_shape``,
    ///     ``keep_volume``, ``neighbors``, ``spacing`` (meters), ``length`` (meters), ``density`` (per cm²), ``color``,
    ///     ``layer``, ``mirror``, ``inverted``.
    #[pyo3(signature = (tool, path, **brush))]
    fn stroked(
        &self,
        py: Python<'_>,
        tool: &str,
        path: &Bound<'_, PyAny>,
        brush: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (_, points) = given_points(path, "the path")?;
        let line = PyDict::new(py);
        line.set_item("tool", tool)?;
        line.set_item("path", points.iter().map(|p| p.to_array()).collect::<Vec<_>>())?;
        line.set_item("set", brush.cloned().unwrap_or_else(|| PyDict::new(py)))?;
        let line: String = py.import("json")?.call_method1("dumps", (line,))?.extract()?;
        self.groomed(py, &format!("{{\"version\":1}}\n{line}\n"))
    }

    /// Return the groom after recorded strokes, for example of the studio.
    ///
    /// Parameters
    /// ----------
    /// strokes : str
    ///     Content of a ``.jsonl`` file with strokes.
    fn groomed(&self, py: Python<'_>, strokes: &str) -> PyResult<Self> {
        let script = StrokeScript::read(strokes, Path::new("strokes")).map_err(raised)?;
        let (parts, order) = py
            .detach(|| -> groom::Result<_> {
                let character = &self.character;
                let document =
                    GroomDocument::new(character.groom.clone(), HeadFiles::None, character.neck.x)?;
                let field = character.body_field().cloned().map(Arc::new);
                let mut editor = GroomEditor::new(document, field);
                if let Some(body) = &character.head {
                    editor = editor.on_skin(body);
                }
                script.apply(&mut editor)?;
                let mut groom = editor.document().groom();
                // Indices of new strands follow the indices of the source.
                let (origins, known) = (editor.document().origins(), self.order.len() as u32);
                let last = self.order.iter().max().map_or(0, |last| last + 1);
                let source = |i: &u32| match origins[*i as usize] {
                    origin if origin < known => self.order[origin as usize],
                    new => last + new - known,
                };
                let order: Vec<u32> = lod::order(&groom.strands).iter().map(source).collect();
                lod::arrange(&mut groom.strands);
                Ok((CharacterParts { groom, ..character.clone() }, order))
            })
            .map_err(raised)?;
        Ok(Self {
            character: parts,
            source: self.source.clone(),
            settings: self.settings.clone(),
            order,
            given: None,
        })
    }

    /// Source index of each strand, counted after invalid strands were dropped: int32 [n]. Strands that were filled in
    /// between the given ones, or grown on a style, have indices of their own.
    #[getter]
    fn order<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        array(py, &[self.order.len()], self.order.iter().map(|i| *i as i32).collect())
    }

    /// Guides at rest, meters: float32 [g, v, 3].
    #[getter]
    fn guides<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let guides = &self.character.groom.guides;
        floats(py, &[guides.len(), guides.vertex_count as usize, 3], &guides.positions)
    }

    /// Binding of strands to guides: a dict of ``guides`` (int32 [n, 3], in order of decreasing weight), ``weights``
    /// (float32 [n, 3], sum 1) and ``scales`` (float32 [n, 3], position along each guide, 0 to 1, that drives the tip
    /// of the strand).
    #[getter]
    fn binding<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let bindings = &self.character.groom.strands.bindings;
        let shape = [bindings.len(), 3];
        let dict = PyDict::new(py);
        let guides = bindings.iter().flat_map(|binding| binding.guides).map(|guide| guide as i32).collect();
        dict.set_item("guides", array(py, &shape, guides)?)?;
        let weights = |binding: &groom::bound::StrandBinding| {
            [1.0 - binding.weight_b - binding.weight_c, binding.weight_b, binding.weight_c]
        };
        dict.set_item(
            "weights",
            array(py, &shape, bindings.iter().flat_map(weights).collect::<Vec<f32>>())?,
        )?;
        dict.set_item(
            "scales",
            array(py, &shape, bindings.iter().flat_map(|b| b.scale).collect::<Vec<f32>>())?,
        )?;
        Ok(dict)
    }

    /// Head mesh that is drawn with the hair: a Mesh, or None.
    #[getter]
    fn head(&self) -> Option<Mesh> {
        self.character.head.clone().map(Mesh)
    }

    /// Remarks from creating the groom: a list of str.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.character.notes.clone()
    }

    /// Settings the groom was made with.
    #[getter]
    fn settings(&self) -> settings::Settings {
        settings::Settings(self.settings.clone())
    }

    fn __len__(&self) -> usize {
        self.character.groom.strands.len()
    }

    fn __repr__(&self) -> String {
        let (strands, guides) = (self.character.groom.strands.len(), self.character.groom.guides.len());
        let head = if self.character.head.is_some() { "on a head" } else { "without a head" };
        format!("Groom({strands} strands, {guides} guides, {head})")
    }
}
