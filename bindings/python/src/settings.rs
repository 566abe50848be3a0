//! The table of parameters, and settings by its names.

use crate::{TressesError, raised};
use pyo3::{
    exceptions::PyKeyError,
    prelude::*,
    types::{PyBool, PyDict, PyList},
};
use std::path::PathBuf;
use tresses_scene::{
    Change, Knob, Preset, Value,
    knobs::{self, Kind},
    preset::Extent,
    settings,
};

/// A row of the table of parameters.
#[pyclass(frozen, get_all, module = "tresses")]
pub struct Parameter {
    /// Its name, for example ``"wind.speed"``.
    name: &'static str,
    /// What a panel calls it.
    label: &'static str,
    /// What it does and when to change it.
    hint: &'static str,
    /// ``"number"``, ``"integer"``, ``"toggle"``, ``"choice"`` or ``"color"``.
    kind: &'static str,
    /// The unit of its numbers; empty for plain ones.
    unit: &'static str,
    /// The smallest number, or None.
    least: Option<f64>,
    /// The largest number, or None.
    most: Option<f64>,
    /// What is allowed, in words.
    range: String,
    /// The names of a choice with what they do, a list of pairs.
    choices: Vec<(&'static str, &'static str)>,
    /// The value by default; None for automatic.
    default: Py<PyAny>,
    /// Whether None is a value: as it suits the style, the file or the colour.
    automatic: bool,
    /// Whether it is seldom needed.
    advanced: bool,
    /// What a change takes: ``"frame"`` (the next frame has it), ``"rebuild"`` (targets are made again) or ``"regrow"``
    /// (another Groom).
    cost: &'static str,
}

#[pymethods]
impl Parameter {
    fn __repr__(&self) -> String {
        format!("Parameter({}: {})", self.name, self.range)
    }
}

/// All parameters: a list of Parameter, in the order in which people look for them.
#[pyfunction]
pub fn parameters(py: Python<'_>) -> PyResult<Vec<Py<Parameter>>> {
    let row = |knob: &'static Knob| {
        let (kind, unit, least, most) = match knob.kind {
            Kind::Number { unit, least, most, .. } => ("number", unit.symbol, Some(least), Some(most)),
            Kind::Integer { unit, least, most, .. } => {
                ("integer", unit.symbol, Some(f64::from(least)), Some(f64::from(most)))
            }
            Kind::Toggle => ("toggle", "", None, None),
            Kind::Choice(_) => ("choice", "", None, None),
            Kind::Color => ("color", "", None, None),
        };
        let choices = match knob.kind {
            Kind::Choice(choices) => choices.iter().map(|choice| (choice.name, choice.hint)).collect(),
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
                least,
                most,
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

/// A value as Python has it, numbers in the parameter's unit.
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

/// A value of Python's for a parameter.
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
        Kind::Number { .. } => Value::Number(knob.inner(value.extract::<f64>().map_err(wrong)?)),
        Kind::Integer { .. } => Value::Integer(value.extract::<u32>().map_err(wrong)?),
        Kind::Toggle => Value::Toggle(value.extract::<bool>().map_err(wrong)?),
        // Numbers of samples are names.
        Kind::Choice(_) => return knob.parse(&value.str()?.to_string()).map_err(raised),
        Kind::Color => Value::Color(value.extract::<[u8; 3]>().map_err(wrong)?),
    };
    knob.check(value).map_err(raised)?;
    Ok(value)
}

fn named(name: &str) -> PyResult<&'static Knob> {
    knobs::named(name).map_err(PyKeyError::new_err)
}

/// Everything that can be turned, by the names of `parameters()`: a mapping from names to values.
///
/// Numbers are in the parameter's unit (``settings["style.curl_radius"] = 9`` is 9 mm); a str may have a unit of its own
/// (``"0.9 cm"``). None is automatic. A value out of range is refused with TressesError, an unknown name with KeyError.
///
/// Parameters
/// ----------
/// values : dict or Settings, optional
///     What differs from the defaults.
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

    /// The settings of a preset file (.toml). Which hair it is for is left out: `Groom.preset` has both.
    #[staticmethod]
    fn open(file: PathBuf) -> PyResult<Self> {
        Ok(Self(Preset::open(&file).map_err(raised)?.settings))
    }

    /// Writes a preset file (.toml) of what differs from the defaults.
    #[pyo3(signature = (file, name=None))]
    fn save(&self, file: PathBuf, name: Option<String>) -> PyResult<()> {
        let preset = Preset { name, settings: self.0.clone(), ..Default::default() };
        preset
            .save(&file, Extent::Changed)
            .map_err(|error| TressesError::new_err(format!("{}: {error}", file.display())))
    }

    /// Takes what `values` (a dict or Settings) have; of Settings, what is not as by default. All of it or, after an
    /// error, nothing.
    pub fn update(&mut self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut changed = self.0.clone();
        if let Ok(other) = values.cast::<Self>() {
            let other = other.borrow();
            for knob in knobs::all().filter(|knob| !knob.is_default(&other.0)) {
                knob.set(&mut changed, knob.get(&other.0)).map_err(raised)?;
            }
        } else {
            for (name, value) in values.cast::<PyDict>()?.iter() {
                let knob = named(&name.extract::<String>()?)?;
                knob.set(&mut changed, given(knob, &value)?).map_err(raised)?;
            }
        }
        self.0 = changed;
        Ok(())
    }

    /// A dict of what differs from the defaults.
    fn changed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for knob in knobs::all().filter(|knob| !knob.is_default(&self.0)) {
            dict.set_item(knob.path, shown(py, knob, knob.get(&self.0))?)?;
        }
        Ok(dict)
    }

    /// Another one with the same values.
    fn copy(&self) -> Self {
        self.clone()
    }

    /// The names of all parameters.
    fn keys(&self) -> Vec<&'static str> {
        knobs::all().map(|knob| knob.path).collect()
    }

    /// The values of all parameters.
    fn values(&self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        knobs::all().map(|knob| shown(py, knob, knob.get(&self.0))).collect()
    }

    /// Names and values of all parameters.
    fn items(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, Py<PyAny>)>> {
        knobs::all().map(|knob| Ok((knob.path, shown(py, knob, knob.get(&self.0))?))).collect()
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let knob = named(name)?;
        shown(py, knob, knob.get(&self.0))
    }

    fn __setitem__(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let knob = named(name)?;
        knob.set(&mut self.0, given(knob, value)?).map_err(raised)
    }

    /// Gives a parameter its default back.
    fn __delitem__(&mut self, name: &str) -> PyResult<()> {
        named(name)?.reset(&mut self.0);
        Ok(())
    }

    fn __contains__(&self, name: &str) -> bool {
        knobs::find(name).is_some()
    }

    fn __len__(&self) -> usize {
        knobs::all().count()
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

/// What a caller gives for settings: None, a dict, or Settings.
pub fn settings_of(values: Option<&Bound<'_, PyAny>>) -> PyResult<settings::Settings> {
    let settings = Settings::new(values)?.0;
    settings.check().map_err(raised)?;
    Ok(settings)
}
