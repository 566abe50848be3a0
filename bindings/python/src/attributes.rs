//! Custom attributes of strands.

use crate::{
    TressesError,
    arrays::{array, given_floats},
};
use pyo3::{intern, prelude::*, types::PyDict};
use tresses::groom::{
    Strands,
    attribute::{MAX_WIDTH, StrandAttribute},
};

/// Converts arrays by name: [n] or [n, k] with a value per strand, or [all] or [all, k] with a value per vertex.
pub fn given(of: &Bound<'_, PyDict>, strands: &Strands) -> PyResult<Vec<StrandAttribute>> {
    let (count, vertices) = (strands.len(), strands.positions.len());
    let mut all = Vec::new();
    for (name, values) in of {
        let name: String = name.extract()?;
        let wrong = |why: String| TressesError::new_err(format!("attribute “{name}” {why}"));
        let (shape, numbers) = given_floats(&values, &format!("values of attribute “{name}”"))?;
        let width = match shape[..] {
            [_] => 1,
            [_, width] if (1..=MAX_WIDTH as usize).contains(&width) => width,
            _ => {
                return Err(wrong(format!(
                    "has the shape {shape:?}, but at most {MAX_WIDTH} numbers a value"
                )));
            }
        };
        let per_vertex = match shape[0] {
            n if n == count => false,
            n if n == vertices => true,
            n => return Err(wrong(format!("has {n} values for {count} strands and {vertices} vertices"))),
        };
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(wrong("has numbers that are not finite".into()));
        }
        let numpy = of.py().import(intern!(of.py(), "numpy"))?;
        let kind: String =
            numpy.call_method1("asarray", (&values,))?.getattr("dtype")?.getattr("kind")?.extract()?;
        let is_integer = kind != "f";
        all.push(StrandAttribute { name, per_vertex, is_integer, width: width as u32, numbers });
    }
    Ok(all)
}

/// Converts attributes to a dict of arrays.
pub fn dict<'py>(py: Python<'py>, all: &[StrandAttribute]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for attribute in all {
        let StrandAttribute { name, is_integer, width, numbers, .. } = attribute;
        let width = *width as usize;
        let shape = [numbers.len() / width, width];
        let shape = if width == 1 { &shape[..1] } else { &shape[..] };
        match is_integer {
            true => dict.set_item(name, integers(py, shape, numbers)?)?,
            false => dict.set_item(name, array(py, shape, numbers.clone())?)?,
        }
    }
    Ok(dict)
}

fn integers<'py>(
    py: Python<'py>,
    shape: &[usize],
    numbers: &[f32],
) -> PyResult<Bound<'py, numpy::PyArrayDyn<i32>>> {
    array(py, shape, numbers.iter().map(|number| *number as i32).collect())
}
