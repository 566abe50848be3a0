//! The list of lights as dicts.

use crate::TressesError;
use pyo3::{
    prelude::*,
    types::{PyDict, PyList, PyString},
};
use tresses_scene::{
    knobs::light_list::{self, LightInput, LightProblem, PATH, SHAPE, fields},
    settings::LightEntry,
};

/// Converts a list of dicts or texts to lights; None is an empty list.
pub fn read(lights: &Bound<'_, PyAny>) -> PyResult<Vec<LightEntry>> {
    if lights.is_none() {
        return Ok(Vec::new());
    }
    if lights.is_instance_of::<PyString>() || lights.cast::<PyDict>().is_ok() {
        return Err(TressesError::new_err(format!("{PATH} must be a list of dicts, one for each light")));
    }
    lights.try_iter()?.enumerate().map(|(i, light)| one(i, &light?)).collect()
}

fn one(index: usize, light: &Bound<'_, PyAny>) -> PyResult<LightEntry> {
    let fail = |name: &str, problem: String| {
        TressesError::new_err(format!("{}: {problem}", light_list::label(index, name)))
    };
    if let Ok(text) = light.extract::<String>() {
        return light_list::one(&text).map_err(|problem| fail("", problem));
    }
    let dict = light
        .cast::<PyDict>()
        .map_err(|_| fail("", format!("a light is a dict or a str, not {}", light.get_type())))?;
    let mut values = Vec::new();
    for (key, value) in dict.iter() {
        let key =
            key.extract::<String>().map_err(|_| fail("", format!("{key:?} is not the name of a value")))?;
        // None means that the key is not given, as for no range.
        if !value.is_none() {
            values.push((key, input(&value)));
        }
    }
    let name = values.iter().find_map(|(key, value)| match value {
        LightInput::Text(name) if key == "name" => Some(name.as_str()),
        _ => None,
    });
    light_list::read(&values).map_err(|LightProblem { problem, .. }| fail(name.unwrap_or_default(), problem))
}

fn input(value: &Bound<'_, PyAny>) -> LightInput {
    // A bool is an int, so it comes first.
    if let Ok(on) = value.extract::<bool>() {
        LightInput::Toggle(on)
    } else if let Ok(number) = value.extract::<f64>() {
        LightInput::Number(number)
    } else if let Ok(text) = value.extract::<String>() {
        LightInput::Text(text)
    } else {
        let numbers = value.try_iter().and_then(|items| items.map(|item| item?.extract::<f64>()).collect());
        numbers.map_or(LightInput::Other("of another type"), LightInput::Numbers)
    }
}

/// Converts lights to a list of dicts with all values of their shapes.
pub fn show<'py>(py: Python<'py>, list: &[LightEntry]) -> PyResult<Bound<'py, PyList>> {
    let dict = |light: &LightEntry| {
        let dict = PyDict::new(py);
        dict.set_item(SHAPE, light.kind.name())?;
        for field in fields(light.kind) {
            match field.get(light) {
                Some(LightInput::Number(number)) => dict.set_item(field.key, number)?,
                Some(LightInput::Numbers(numbers)) => dict.set_item(field.key, numbers)?,
                Some(LightInput::Toggle(on)) => dict.set_item(field.key, on)?,
                Some(LightInput::Text(text)) => dict.set_item(field.key, text)?,
                Some(LightInput::Other(_)) | None => dict.set_item(field.key, py.None())?,
            }
        }
        PyResult::Ok(dict)
    };
    PyList::new(py, list.iter().map(dict).collect::<PyResult<Vec<_>>>()?)
}
