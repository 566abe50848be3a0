//! The table of parameters, and settings by parameter name.

use crate::{TressesError, lights, raised};
use pyo3::{
    exceptions::PyKeyError,
    prelude::*,
    types::{PyBool, PyDict, PyList},
};
use std::path::PathBuf;
use tresses_scene::{
    Change, Knob, Preset, Value,
    knobs::{self, ValueKind, light_list},
    preset::Extent,
    settings,
};

/// A parameter: one row of the table that `parameters` returns.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Parameter {
    /// Name, for example ``"wind.speed"``.
    name: &'static str,
    /// Label in user interfaces.
    label: &'static str,
    /// Effect, and when to change it.
    hint: &'static str,
    /// ``"number"``, ``"integer"``, ``"toggle"``, ``"choice"`` or ``"color"``.
    kind: &'static str,
    /// Unit of numbers; empty for plain numbers.
    unit: &'static str,
    /// Minimum, or None.
    min: Option<f64>,
    /// Maximum, or None.
    max: Option<f64>,
    /// Allowed values, in words.
    range: String,
    /// Names and descriptions of a choice's values: a list of pairs.
    choices: Vec<(&'static str, &'static str)>,
    /// Default value; None for automatic.
    default: Py<PyAny>,
    /// Whether None is allowed. The value then follows from the style, the file or the color.
    automatic: bool,
    /// Whether it is rarely needed.
    advanced: bool,
    /// Cost of a change: ``"frame"`` (it takes effect in the next frame), ``"rebuild"`` (render targets are recreated)
    /// or ``"regrow"`` (a new Groom is required).
    cost: &'static str,
}

#[pymethods]
impl Parameter {
    /// Former name of `min`.
    #[getter]
    fn least(&self) -> Option<f64> {
        self.min
    }

    /// Former name of `max`.
    #[getter]
    fn most(&self) -> Option<f64> {
        self.max
    }

    fn __repr__(&self) -> String {
        format!("Parameter({}: {})", self.name, self.range)
    }
}

/// Return all parameters: a list of Parameter in display order.
#[pyfunction]
pub fn parameters(py: Python<'_>) -> PyResult<Vec<Py<Parameter>>> {
    let row = |knob: &'static Knob| {
        let (kind, unit, min, max) = match knob.kind {
            ValueKind::Number { unit, min, max, .. } => ("number", unit.symbol, Some(min), Some(max)),
            ValueKind::Integer { unit, min, max, .. } => {
                ("integer", unit.symbol, Some(f64::from(min)), Some(f64::from(max)))
            }
            ValueKind::Toggle => ("toggle", "", None, None),
            ValueKind::Choice(_) => ("choice", "", None, None),
            ValueKind::Color => ("color", "", None, None),
        };
        let choices = match knob.kind {
            ValueKind::Choice(choices) => choices.iter().map(|choice| (choice.name, choice.hint)).collect(),
            _ => Vec::new(),
        };
        let cost = match knob.cost {
            Change::Frame => "frame",
            Change::Regrow => "regrow",
            Change::Rebuild => "rebuild",
        };
        let default = shown(py, knob, knob.default())?;
        let Knob { path: name, label, hint, automatic, advanced, .. } = *knob;
        let range = knob.range();
        Py::new(
            py,
            Parameter {
                name,
                label,
                hint,
                kind,
                unit,
                min,
                max,
                range,
                choices,
                default,
                automatic,
                advanced,
                cost,
            },
        )
    };
    knobs::all().map(row).collect()
}

/// Converts a value to Python, with numbers in the parameter's unit.
fn shown(py: Python<'_>, knob: &Knob, value: Value) -> PyResult<Py<PyAny>> {
    Ok(match value {
        Value::Auto => py.None(),
        Value::Number(v) => knob.shown(v).into_pyobject(py)?.into_any().unbind(),
        Value::Integer(v) => v.into_pyobject(py)?.into_any().unbind(),
        Value::Toggle(on) => PyBool::new(py, on).to_owned().into_any().unbind(),
        Value::Choice(name) => name.into_pyobject(py)?.into_any().unbind(),
        Value::Color(_) => knob.text(value).into_pyobject(py)?.into_any().unbind(),
    })
}

/// Converts a Python value for the parameter `knob`.
fn given(knob: &Knob, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.is_none() {
        return Ok(Value::Auto);
    }
    if let Ok(text) = value.extract::<String>() {
        return knob.parse(&text).map_err(raised);
    }
    let wrong = |_: PyErr| {
        let range = knob.range();
        TressesError::new_err(format!("{} is {value:?}, but must be {range}", knob.path))
    };
    let value = match knob.kind {
        ValueKind::Number { .. } => Value::Number(knob.inner(value.extract::<f64>().map_err(wrong)?)),
        ValueKind::Integer { .. } => Value::Integer(value.extract::<u32>().map_err(wrong)?),
        ValueKind::Toggle => Value::Toggle(value.extract::<bool>().map_err(wrong)?),
        // Sample counts are choices with numeric names.
        ValueKind::Choice(_) => return knob.parse(&value.str()?.to_string()).map_err(raised),
        ValueKind::Color => Value::Color(value.extract::<[u8; 3]>().map_err(wrong)?),
    };
    knob.check(value).map_err(raised)?;
    Ok(value)
}

/// Sets the parameter `name` in `settings`, or the list of lights.
fn assign(settings: &mut settings::Settings, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    if name == light_list::PATH {
        settings.lights.list = lights::read(value)?;
        return Ok(());
    }
    let knob = named(name)?;
    knob.set(settings, given(knob, value)?).map_err(raised)
}

/// Returns the value of the parameter `name`, or the list of lights.
fn get(py: Python<'_>, settings: &settings::Settings, name: &str) -> PyResult<Py<PyAny>> {
    if name == light_list::PATH {
        return Ok(lights::show(py, &settings.lights.list)?.into_any().unbind());
    }
    let knob = named(name)?;
    shown(py, knob, knob.get(settings))
}

/// Iterates over the names of all parameters, and of the list of lights.
fn names() -> impl Iterator<Item = &'static str> {
    knobs::all().map(|knob| knob.path).chain([light_list::PATH])
}

fn named(name: &str) -> PyResult<&'static Knob> {
    knobs::named(name).map_err(PyKeyError::new_err)
}

/// All settings: a mapping from the names of `parameters()` to values, and ``"lights.list"`` to a list of lights.
///
/// A light is a dict of its shape and values, as in a preset: ``{"shape": "point", "position": (0.3, 0.2, 0.4)}``, or a
/// str as for ``--light``. Positions are three numbers, meters; angles are in degrees. To change a light, assign the
/// list again: reading it returns a copy.
///
/// Numbers are in the parameter's unit: ``settings["style.curl_radius"] = 9`` sets 9 mm. A str may contain a unit
/// (``"0.9 cm"``). None means automatic. Values out of range raise TressesError; unknown names raise KeyError.
///
/// Parameters
/// ----------
/// values : dict or Settings, optional
///     Values that differ from the defaults.
#[pyclass(module = "tresses", mapping)]
#[derive(Clone, Default)]
pub struct Settings(pub settings::Settings);

#[pymethods]
impl Settings {
    #[new]
    #[pyo3(signature = (values=None))]
    fn new(values: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let mut settings = Self::default();
        if let Some(values) = values {
            settings.update(values)?;
        }
        Ok(settings)
    }

    /// Read the settings of a preset file (.toml). It ignores the hair that the preset names; `Groom.preset` reads
    /// both.
    #[staticmethod]
    fn open(file: PathBuf) -> PyResult<Self> {
        Ok(Self(Preset::open(&file).map_err(raised)?.settings))
    }

    /// Write a preset file (.toml) with the settings that differ from the defaults.
    #[pyo3(signature = (file, name=None))]
    fn save(&self, file: PathBuf, name: Option<String>) -> PyResult<()> {
        let preset = Preset { name, settings: self.0.clone(), ..Default::default() };
        preset
            .save(&file, Extent::Changed)
            .map_err(|error| TressesError::new_err(format!("{}: {error}", file.display())))
    }

    /// Set the values in `values` (a dict or Settings). From Settings, only values that differ from the defaults are
    /// taken. After an error nothing has changed.
    pub fn update(&mut self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut changed = self.0.clone();
        if let Ok(other) = values.cast::<Self>() {
            let other = other.borrow();
            for knob in knobs::all().filter(|knob| !knob.is_default(&other.0)) {
                knob.set(&mut changed, knob.get(&other.0)).map_err(raised)?;
            }
            if !other.0.lights.list.is_empty() {
                changed.lights.list.clone_from(&other.0.lights.list);
            }
        } else {
            for (name, value) in values.cast::<PyDict>()?.iter() {
                assign(&mut changed, &name.extract::<String>()?, &value)?;
            }
        }
        self.0 = changed;
        Ok(())
    }

    /// Return a dict of the values that differ from the defaults.
    fn changed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for knob in knobs::all().filter(|knob| !knob.is_default(&self.0)) {
            dict.set_item(knob.path, shown(py, knob, knob.get(&self.0))?)?;
        }
        if !self.0.lights.list.is_empty() {
            dict.set_item(light_list::PATH, get(py, &self.0, light_list::PATH)?)?;
        }
        Ok(dict)
    }

    /// Return a copy.
    fn copy(&self) -> Self {
        self.clone()
    }

    /// Return the names of all parameters, and of the list of lights.
    fn keys(&self) -> Vec<&'static str> {
        names().collect()
    }

    /// Return the values of all parameters.
    fn values(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        names().map(|name| get(py, &self.0, name)).collect()
    }

    /// Return the names and values of all parameters: a list of pairs.
    fn items(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, Py<PyAny>)>> {
        names().map(|name| Ok((name, get(py, &self.0, name)?))).collect()
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        get(py, &self.0, name)
    }

    fn __setitem__(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        assign(&mut self.0, name, value)
    }

    /// Reset a parameter to its default.
    fn __delitem__(&mut self, name: &str) -> PyResult<()> {
        if name == light_list::PATH {
            self.0.lights.list.clear();
        } else {
            named(name)?.reset(&mut self.0);
        }
        Ok(())
    }

    fn __contains__(&self, name: &str) -> bool {
        name == light_list::PATH || knobs::find(name).is_some()
    }

    fn __len__(&self) -> usize {
        names().count()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyList::new(py, self.keys())?.try_iter()?.into_any())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("Settings({})", self.changed(py)?.repr()?))
    }
}

/// Converts the settings argument of a function: None, a dict, or Settings.
pub fn settings_of(values: Option<&Bound<'_, PyAny>>) -> PyResult<settings::Settings> {
    let settings = Settings::new(values)?.0;
    settings.check().map_err(raised)?;
    Ok(settings)
}
