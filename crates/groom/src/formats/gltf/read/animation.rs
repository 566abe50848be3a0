//! Animations: keys of node properties.

use glam::Quat;
use gltf::json::{self, validation::Checked};

use super::{PlacedNode, file::File, morph::Shapes};
use crate::{
    error::Result,
    rig::{Animation, Channel, Curve, Interpolation, Property},
};

/// Reads the animations that affect the scene.
pub(super) fn read(
    file: &File,
    placed: &[PlacedNode],
    scene_indices: &[Option<u32>],
    shapes: &Shapes,
) -> Result<Vec<Animation>> {
    let mut all = Vec::new();
    for (i, animation) in file.document.as_json().animations.iter().enumerate() {
        let mut read = Animation { name: animation.name.clone().unwrap_or_default(), ..Default::default() };
        for channel in &animation.channels {
            // Nodes outside the scene have no effect; paths that only extensions define are not supported.
            let scene_index = scene_indices.get(channel.target.node.value()).copied().flatten();
            let (Some(node), Checked::Valid(path)) = (scene_index, channel.target.path) else { continue };
            let Some(sampler) = animation.samplers.get(channel.sampler.value()) else { continue };
            let property = property(file, path, i, &placed[node as usize], shapes)?;
            let curve = curve(file, sampler, &property, i)?;
            read.length = curve.times.last().map_or(read.length, |t| read.length.max(*t));
            read.channels.push(Channel { node, property, curve });
        }
        if !read.channels.is_empty() {
            all.push(read);
        }
    }
    Ok(all)
}

fn property(
    file: &File,
    path: json::animation::Property,
    animation: usize,
    placed: &PlacedNode,
    shapes: &Shapes,
) -> Result<Property> {
    use json::animation::Property as Named;
    Ok(match path {
        Named::Translation => Property::Translation,
        Named::Rotation => Property::Rotation,
        Named::Scale => Property::Scale,
        Named::MorphTargetWeights => {
            let targets = placed.node.mesh().map_or(&[][..], |mesh| shapes.of(mesh.index()));
            if targets.is_empty() {
                let node = placed.node.index();
                let problem =
                    format!("animation {animation} sets blend shapes of node {node}, which has none");
                return Err(file.problem(problem));
            }
            file.spend(targets.len(), size_of::<u32>())?;
            Property::Weights(targets.to_vec())
        }
    })
}

fn curve(
    file: &File,
    sampler: &json::animation::Sampler,
    property: &Property,
    animation: usize,
) -> Result<Curve> {
    let interpolation = match sampler.interpolation {
        Checked::Valid(json::animation::Interpolation::Step) => Interpolation::Step,
        Checked::Valid(json::animation::Interpolation::CubicSpline) => Interpolation::CubicSpline,
        _ => Interpolation::Linear,
    };
    // The `gltf` crate has validated both indices.
    let accessor = |index: json::Index<json::Accessor>| file.document.accessors().nth(index.value());
    let (Some(input), Some(output)) = (accessor(sampler.input), accessor(sampler.output)) else {
        return Err(file.problem(format!("animation {animation} has no keys")));
    };
    let times = file.numbers(&input, 1)?;
    if times.first().is_some_and(|t| *t < 0.0) || times.windows(2).any(|t| t[0] >= t[1]) {
        return Err(
            file.problem(format!("the key times of animation {animation} are negative or not ascending"))
        );
    }
    let (components, items) = match property {
        Property::Translation | Property::Scale => (3, 1),
        Property::Rotation => (4, 1),
        Property::Weights(targets) => (1, targets.len()),
    };
    let mut values = file.numbers(&output, components)?;
    let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let need = (times.len() as u64) * (components * items * parts) as u64;
    if values.len() as u64 != need {
        let (have, keys) = (values.len(), times.len());
        let problem = format!("animation {animation} has {have} numbers for {keys} keys, which need {need}");
        return Err(file.problem(problem));
    }
    if *property == Property::Rotation {
        // A spline key has three quaternions: in-tangent, rotation and out-tangent.
        let keys = values.as_chunks_mut::<4>().0.iter_mut().skip(parts / 2).step_by(parts);
        for key in keys {
            let unit = Quat::from_array(*key).normalize();
            if !unit.is_finite() {
                return Err(file.problem(format!("animation {animation} has a rotation of length zero")));
            }
            *key = unit.to_array();
        }
    }
    Ok(Curve { interpolation, times, values })
}
