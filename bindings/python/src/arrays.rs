//! Conversion from and to NumPy arrays. Inputs may be anything that `numpy.asarray` accepts.

use crate::TressesError;
use bytemuck::Pod;
use numpy::{Element, IntoPyArray, PyArrayDyn, PyReadonlyArrayDyn, PyUntypedArrayMethods, ndarray::ArrayD};
use pyo3::{intern, prelude::*};
use tresses::glam::{Mat4, Vec2, Vec3};

/// Returns an array of `shape` that holds `values`.
pub fn array<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let wrong =
        |error: numpy::ndarray::ShapeError| TressesError::new_err(format!("cannot shape an array: {error}"));
    Ok(ArrayD::from_shape_vec(shape.to_vec(), values).map_err(wrong)?.into_pyarray(py))
}

/// Returns vectors or matrices as an array; `shape` includes their own axes.
pub fn floats<'py, T: Pod>(
    py: Python<'py>,
    shape: &[usize],
    values: &[T],
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    array(py, shape, bytemuck::cast_slice(values).to_vec())
}

/// Returns points as an array [n, 3].
pub fn points<'py>(py: Python<'py>, points: &[Vec3]) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    floats(py, &[points.len(), 3], points)
}

/// Returns the shape and the values of `of`, converted to `dtype` in C order. Errors call the argument `what`.
fn given<T: Element + Copy>(
    of: &Bound<'_, PyAny>,
    what: &str,
    dtype: &str,
) -> PyResult<(Vec<usize>, Vec<T>)> {
    let py = of.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let refuse = |error: PyErr| {
        if error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) {
            return error;
        }
        TressesError::new_err(format!("{what} are not an array of numbers: {}", error.value(py)))
    };
    let array = numpy.call_method1(intern!(py, "asarray"), (of, dtype, "C")).map_err(refuse)?;
    let array: PyReadonlyArrayDyn<'_, T> = array.extract()?;
    Ok((array.shape().to_vec(), array.as_array().iter().copied().collect()))
}

/// Returns the shape and the values of an array of single-precision numbers.
pub fn given_floats(of: &Bound<'_, PyAny>, what: &str) -> PyResult<(Vec<usize>, Vec<f32>)> {
    given(of, what, "float32")
}

/// Returns the shape and the values of an array of integers.
pub fn given_integers(of: &Bound<'_, PyAny>, what: &str) -> PyResult<(Vec<usize>, Vec<i64>)> {
    given(of, what, "int64")
}

/// Returns the points of an array [..., 3], and the lengths of the leading axes.
pub fn given_points(of: &Bound<'_, PyAny>, what: &str) -> PyResult<(Vec<usize>, Vec<Vec3>)> {
    let (mut shape, values) = given_floats(of, what)?;
    if shape.pop() != Some(3) {
        return Err(TressesError::new_err(format!("{what} must have 3 numbers along their last axis")));
    }
    Ok((shape, bytemuck::pod_collect_to_vec::<f32, Vec3>(&values)))
}

/// Returns `count` points, from an array of as many or from a single point that is repeated.
pub fn given_points_for(of: &Bound<'_, PyAny>, what: &str, count: usize) -> PyResult<Vec<Vec3>> {
    let (shape, points) = given_points(of, what)?;
    match points.len() {
        n if n == count && !shape.is_empty() => Ok(points),
        1 if shape.is_empty() => Ok(vec![points[0]; count]),
        n => Err(TressesError::new_err(format!("there are {n} {what}, but must be {count}, or one for all"))),
    }
}

/// Returns `count` numbers, from an array of as many or from a single number that is repeated.
pub fn given_numbers_for(of: &Bound<'_, PyAny>, what: &str, count: usize) -> PyResult<Vec<f32>> {
    let (shape, numbers) = given_floats(of, what)?;
    match numbers.len() {
        n if n == count && !shape.is_empty() => Ok(numbers),
        1 if shape.is_empty() => Ok(vec![numbers[0]; count]),
        n => Err(TressesError::new_err(format!("there are {n} {what}, but must be {count}, or one for all"))),
    }
}

/// Returns matrices for column vectors, from an array [n, 4, 4].
pub fn given_matrices(of: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Mat4>> {
    let (shape, values) = given_floats(of, what)?;
    if shape.len() != 3 || shape[1..] != [4, 4] {
        return Err(TressesError::new_err(format!(
            "{what} have the shape {shape:?}, but must have [n, 4, 4]"
        )));
    }
    Ok(values.as_chunks().0.iter().map(|rows: &[f32; 16]| Mat4::from_cols_array(rows).transpose()).collect())
}

/// Returns a matrix for column vectors, from an array [4, 4].
pub fn given_matrix(of: &Bound<'_, PyAny>, what: &str) -> PyResult<Mat4> {
    let (shape, values) = given_floats(of, what)?;
    let rows = <[f32; 16]>::try_from(values).ok().filter(|_| shape == [4, 4]);
    let rows = rows.ok_or_else(|| TressesError::new_err(format!("{what} must be a matrix [4, 4]")))?;
    Ok(Mat4::from_cols_array(&rows).transpose())
}

/// Returns up to three values per strand, from an array [n, k] of `count` rows with k from 1 to 3. The others are
/// `rest`.
pub fn given_triples<T: Copy>(
    (shape, values): (Vec<usize>, Vec<T>),
    what: &str,
    count: usize,
    rest: T,
) -> PyResult<Vec<[T; 3]>> {
    let each = match shape[..] {
        [n] if n == count => 1,
        [n, k @ 1..=3] if n == count => k,
        _ => {
            return Err(TressesError::new_err(format!(
                "{what} have the shape {shape:?}, but must have [{count}, k] with k from 1 to 3"
            )));
        }
    };
    let triple = |row: &[T]| std::array::from_fn(|i| row.get(i).copied().unwrap_or(rest));
    Ok(values.chunks(each).map(triple).collect())
}

/// Returns `count` pairs of numbers.
pub fn given_pairs(of: &Bound<'_, PyAny>, what: &str, count: usize) -> PyResult<Vec<Vec2>> {
    let (shape, values) = given_floats(of, what)?;
    if shape != [count, 2] {
        return Err(TressesError::new_err(format!(
            "{what} have the shape {shape:?}, but must have [{count}, 2]"
        )));
    }
    Ok(bytemuck::pod_collect_to_vec::<f32, Vec2>(&values))
}
