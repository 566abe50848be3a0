//! Custom attributes of strands: values that Tresses keeps by name and does not interpret.

use std::ops::Range;

/// Largest number of numbers per value.
pub const MAX_WIDTH: u32 = 4;

/// A custom attribute: a named value per strand or per vertex.
///
/// Blender calls it an attribute, USD a primvar, Alembic an arbitrary geometry parameter.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct StrandAttribute {
    /// Name in the file.
    pub name: String,
    /// Whether each vertex has a value; otherwise each strand has one.
    pub per_vertex: bool,
    /// Whether the values are integers. They are exact up to 2²⁴.
    pub is_integer: bool,
    /// Numbers per value, 1 to [`MAX_WIDTH`].
    pub width: u32,
    /// The numbers of all values, in the order of the strands or vertices.
    #[cfg_attr(feature = "cooked", serde(with = "crate::bulk"))]
    pub numbers: Vec<f32>,
}

impl StrandAttribute {
    /// Returns the attribute without values.
    pub(crate) fn emptied(&self) -> Self {
        let Self { per_vertex, is_integer, width, .. } = *self;
        Self { name: self.name.clone(), per_vertex, is_integer, width, numbers: Vec::new() }
    }

    /// Returns whether `other` can be joined to the attribute: name and kind of values are the same.
    pub(crate) fn joins(&self, other: &Self) -> bool {
        (&self.name, self.per_vertex, self.width) == (&other.name, other.per_vertex, other.width)
    }

    /// Appends the values of an attribute that [joins](Self::joins) it.
    pub(crate) fn append(&mut self, more: &Self) {
        self.is_integer &= more.is_integer;
        self.numbers.extend(&more.numbers);
    }

    /// Returns the numbers of the values in `range`.
    pub fn values(&self, range: Range<usize>) -> &[f32] {
        let width = self.width as usize;
        &self.numbers[range.start * width..range.end * width]
    }

    /// Appends the value at the fraction `t` between values `a` and `b` of `from`. Integers are taken from the nearer.
    pub(crate) fn push_between(&mut self, from: &Self, [a, b]: [usize; 2], t: f32) {
        let [a, b] = [a, b].map(|i| from.values(i..i + 1));
        let between = |(a, b): (&f32, &f32)| match (from.is_integer, t < 0.5) {
            (false, _) => a + (b - a) * t,
            (true, nearer_a) => *(if nearer_a { a } else { b }),
        };
        self.numbers.extend(a.iter().zip(b).map(between));
    }

    /// Returns whether the attribute has one value for each of `strands` strands or `vertices` vertices, all finite.
    pub(crate) fn fits(&self, strands: usize, vertices: usize) -> bool {
        let count = if self.per_vertex { vertices } else { strands };
        (1..=MAX_WIDTH).contains(&self.width)
            && self.numbers.len() == count * self.width as usize
            && self.numbers.iter().all(|number| number.is_finite())
    }
}
