//! Converts values of any type to numbers or texts.

use bytemuck::cast_slice;
use glam::{DMat4, DQuat};
use openusd::{gf::f16, sdf::Value};

/// A type that converts to a number.
trait Number: Copy {
    fn number(self) -> f64;
}

macro_rules! numbers {
    ($($kind:ty),*) => { $(impl Number for $kind {
        fn number(self) -> f64 {
            self as f64
        }
    })* };
}
numbers!(f32, f64, i32, u32, i64, u64, u8);

impl Number for f16 {
    fn number(self) -> f64 {
        self.to_f64()
    }
}

impl Number for bool {
    fn number(self) -> f64 {
        f64::from(u8::from(self))
    }
}

/// Returns all numbers of a value, flattened, and how many form one element; `None` if it has no numbers.
pub(super) fn row<T>(value: &Value, of: fn(f64) -> T) -> Option<(Vec<T>, usize)> {
    fn all<N: Number, T>(numbers: &[N], of: fn(f64) -> T) -> Vec<T> {
        numbers.iter().map(|n| of(n.number())).collect()
    }
    macro_rules! rows {
        ($($one:ident $many:ident $kind:ty, $width:literal;)*) => {
            match value {
                Value::Bool(v) => Some((vec![of(v.number())], 1)),
                Value::BoolVec(v) => Some((all(v, of), 1)),
                $(Value::$one(v) => Some((all(cast_slice::<_, $kind>(std::slice::from_ref(v)), of), $width)),
                Value::$many(v) => Some((all(cast_slice::<_, $kind>(v), of), $width)),)*
                _ => None,
            }
        };
    }
    rows! {
        Uchar UcharVec u8, 1;
        Int IntVec i32, 1;
        Uint UintVec u32, 1;
        Int64 Int64Vec i64, 1;
        Uint64 Uint64Vec u64, 1;
        Half HalfVec f16, 1;
        Float FloatVec f32, 1;
        Double DoubleVec f64, 1;
        Vec2h Vec2hVec f16, 2;
        Vec2f Vec2fVec f32, 2;
        Vec2d Vec2dVec f64, 2;
        Vec2i Vec2iVec i32, 2;
        Vec3h Vec3hVec f16, 3;
        Vec3f Vec3fVec f32, 3;
        Vec3d Vec3dVec f64, 3;
        Vec3i Vec3iVec i32, 3;
        Vec4h Vec4hVec f16, 4;
        Vec4f Vec4fVec f32, 4;
        Vec4d Vec4dVec f64, 4;
        Vec4i Vec4iVec i32, 4;
        Matrix4d Matrix4dVec f64, 16;
    }
}

/// Returns whether a value is of integers or Booleans.
pub(super) fn is_integer(value: &Value) -> bool {
    macro_rules! any {
        ($($kind:ident)*) => { matches!(value, $(Value::$kind(_))|*) };
    }
    any!(Bool BoolVec Uchar UcharVec Int IntVec Uint UintVec Int64 Int64Vec Uint64 Uint64Vec
        Vec2i Vec2iVec Vec3i Vec3iVec Vec4i Vec4iVec)
}

/// Returns the first number of a value.
pub(super) fn number(value: &Value) -> Option<f64> {
    row(value, |number| number)?.0.first().copied()
}

/// Returns the texts of a value, one or many.
pub(super) fn texts(value: &Value) -> Vec<String> {
    match value {
        Value::String(text) => vec![text.clone()],
        Value::StringVec(all) => all.clone(),
        Value::Token(token) => vec![token.as_str().to_owned()],
        Value::TokenVec(all) => all.iter().map(|token| token.as_str().to_owned()).collect(),
        _ => Vec::new(),
    }
}

/// Returns the first text of a value.
pub(super) fn text(value: &Value) -> Option<String> {
    texts(value).into_iter().next()
}

/// Returns a rotation as x, y, z and w.
pub(super) fn rotation(value: &Value) -> Option<[f64; 4]> {
    match value {
        Value::Quath(q) => Some([q.x, q.y, q.z, q.w].map(f16::to_f64)),
        Value::Quatf(q) => Some([q.x, q.y, q.z, q.w].map(f64::from)),
        Value::Quatd(q) => Some([q.x, q.y, q.z, q.w]),
        _ => None,
    }
}

/// Normalizes a quaternion; zero becomes the identity.
pub(super) fn normalized_quaternion(xyzw: [f64; 4]) -> DQuat {
    let quaternion = DQuat::from_array(xyzw);
    if quaternion.length() > 0.0 { quaternion.normalize() } else { DQuat::IDENTITY }
}

/// Returns rotations as x, y, z and w.
pub(super) fn rotations(value: &Value) -> Vec<[f64; 4]> {
    match value {
        Value::QuathVec(all) => all.iter().map(|q| [q.x, q.y, q.z, q.w].map(f16::to_f64)).collect(),
        Value::QuatfVec(all) => all.iter().map(|q| [q.x, q.y, q.z, q.w].map(f64::from)).collect(),
        Value::QuatdVec(all) => all.iter().map(|q| [q.x, q.y, q.z, q.w]).collect(),
        one => rotation(one).into_iter().collect(),
    }
}

/// Returns matrices, one or many. USD's multiply row vectors: their rows are the columns of `DMat4`.
pub(super) fn matrices(value: &Value) -> Vec<DMat4> {
    let row = row(value, |number| number).filter(|(_, width)| *width == 16);
    row.unwrap_or_default().0.as_chunks::<16>().0.iter().map(DMat4::from_cols_array).collect()
}
