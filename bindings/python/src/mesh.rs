//! Triangle meshes of heads and bodies.

use crate::{
    TressesError,
    arrays::{array, given_integers, given_points, given_points_for, points},
    files::{Orientation, paths},
    raised,
};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use std::path::PathBuf;
use tresses::{
    glam::Vec3,
    groom::{TriMesh, export::Writer, formats::ContentKind, import},
};

/// A triangle mesh, for example a head that hair grows on.
///
/// Coordinates are meters, right-handed, Y up, face toward +Z.
///
/// Parameters
/// ----------
/// positions : array [v, 3]
///     Vertices, meters.
/// triangles : array of int [t, 3]
///     Vertex indices, counter-clockwise seen from outside.
/// normals : array [v, 3], optional
///     Unit normals. By default they are computed from the adjacent triangles.
/// colors : array [v, 3] or [3], optional
///     Linear sRGB.
#[pyclass(frozen, module = "tresses")]
pub struct Mesh(pub TriMesh);

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (positions, triangles, normals=None, colors=None))]
    fn new(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (_, positions) = given_points(positions, "positions")?;
        let (shape, corners) = given_integers(triangles, "triangles")?;
        if shape.len() != 2 || shape[1] != 3 {
            return Err(TressesError::new_err(format!(
                "triangles have the shape {shape:?}, but must have [t, 3]"
            )));
        }
        let count = positions.len();
        let none = |i: i64| {
            TressesError::new_err(format!("a triangle refers to vertex {i}, but there are {count} vertices"))
        };
        let corners = corners.into_iter().map(|i| u32::try_from(i).map_err(|_| none(i)));
        let corners = corners.collect::<PyResult<Vec<_>>>()?;
        let mut mesh = TriMesh { positions, triangles: corners.as_chunks().0.to_vec(), ..Default::default() };
        if let Some(colors) = colors {
            mesh.colors = given_points_for(colors, "colors", count)?;
        }
        // Check the vertex indices, with placeholder normals, before computing normals from the triangles.
        mesh.normals = vec![Vec3::Y; count];
        mesh.validate().map_err(raised)?;
        match normals {
            Some(normals) => mesh.normals = given_points_for(normals, "normals", count)?,
            None => mesh.compute_normals(),
        }
        mesh.validate().map_err(raised)?;
        Ok(Self(mesh))
    }

    /// Read a head or body from one or more files and convert it to meters, Y up, face toward +Z.
    ///
    /// ``formats()["heads"]`` lists the file extensions. ``unit``, ``up``, ``front`` and ``mirror`` are known
    /// properties of the file; the importer guesses the others.
    #[staticmethod]
    #[pyo3(signature = (files, *, unit=None, up=None, front=None, mirror=None))]
    fn read(
        py: Python<'_>,
        files: &Bound<'_, PyAny>,
        unit: Option<String>,
        up: Option<String>,
        front: Option<String>,
        mirror: Option<bool>,
    ) -> PyResult<Self> {
        let files = paths(files)?;
        let orient_head = Orientation { unit, up, front, mirror }.choice()?;
        let options = import::ImportOptions { orient_head, ..Default::default() };
        py.detach(|| import::read_head(&files, &options)).map(|(mesh, _)| Self(mesh)).map_err(raised)
    }

    /// Write a file. Its extension selects the format, one of ``formats()["meshes_written"]``.
    fn write(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        py.detach(|| -> anyhow::Result<()> {
            std::fs::write(&file, Writer::holding(&file, ContentKind::Mesh)?.mesh(&self.0, None)?)
                .map_err(|error| anyhow::anyhow!("{}: {error}", file.display()))
        })
        .map_err(raised)
    }

    /// Vertices, meters: float32 [v, 3].
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.positions)
    }

    /// Unit normals: float32 [v, 3].
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        points(py, &self.0.normals)
    }

    /// Linear sRGB: float32 [v, 3], or None.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f32>>>> {
        (!self.0.colors.is_empty()).then(|| points(py, &self.0.colors)).transpose()
    }

    /// Vertex indices, counter-clockwise seen from outside: int32 [t, 3].
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<i32>>> {
        let corners = self.0.triangles.iter().flatten().map(|i| *i as i32).collect();
        array(py, &[self.0.triangles.len(), 3], corners)
    }

    fn __repr__(&self) -> String {
        format!("Mesh({} vertices, {} triangles)", self.0.positions.len(), self.0.triangles.len())
    }
}
