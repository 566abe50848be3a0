//! Serde adapter that stores long arrays of plain values as their bytes in memory, at the speed of a copy.

use bytemuck::Pod;
use serde::{
    Deserializer, Serializer,
    de::{Error, Visitor},
};
use std::marker::PhantomData;

// All targets of wgpu are little-endian, so files are portable.
const _: () = assert!(cfg!(target_endian = "little"));

pub fn serialize<T: Pod, S: Serializer>(values: &[T], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_bytes(bytemuck::cast_slice(values))
}

pub fn deserialize<'a, T: Pod, D: Deserializer<'a>>(from: D) -> Result<Vec<T>, D::Error> {
    struct Bytes<T>(PhantomData<T>);

    impl<T: Pod> Visitor<'_> for Bytes<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            write!(f, "values of {} bytes", size_of::<T>())
        }

        fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<T>, E> {
            if !bytes.len().is_multiple_of(size_of::<T>()) {
                return Err(E::invalid_length(bytes.len(), &self));
            }
            Ok(bytemuck::pod_collect_to_vec(bytes))
        }
    }

    from.deserialize_bytes(Bytes(PhantomData))
}
