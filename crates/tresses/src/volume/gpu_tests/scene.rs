//! Test scene: guides, head pose and grid on the GPU.

use crate::{
    Context, Pose,
    clock::{Mode, Step, Steps},
    collide::{ColliderDescriptor, ColliderPoses, ColliderSet, Moments},
    gpu::{for_tests as context, readback::blocking as readback},
    simulate::{Forces, GuideTraits, RestOptions, SimulationParams, rest},
    strands::{Force, GuideBuffers, GuideForce, RestGuides, guide::pack_velocity},
    volume::{HairHair, Volume, VolumeAsset, VolumeOptions},
};
use glam::{Quat, Vec3};
use half::f16;

/// Vertices per guide of [`cube`].
pub(super) const N: usize = 8;

/// Evenly spaced guides that fill a cube of 24 cm. Guide `g` represents `1 + g % 5` strands; its vertex `i` is at
/// `g * N + i`.
pub(super) fn cube(across: usize) -> (Vec<Vec3>, Vec<GuideTraits>) {
    let mut positions = Vec::new();
    let mut traits = Vec::new();
    for g in 0..across * across {
        let (x, z) = (g % across, g / across);
        let at = |k: usize| 0.24 * (k as f32 + 0.5) / across as f32 - 0.12;
        for i in 0..N {
            positions.push(Vec3::new(at(x), 0.12 - 0.24 * i as f32 / (N - 1) as f32, at(z)));
        }
        traits.push(GuideTraits { strands: 1.0 + (g % 5) as f32, ..Default::default() });
    }
    (positions, traits)
}

pub(super) struct Setup {
    pub(super) context: &'static Context,
    pub(super) guides: GuideBuffers,
    pub(super) rest: RestGuides,
    pub(super) volume: Volume,
    pub(super) forces: Forces,
    pub(super) colliders: ColliderSet,
    /// Poses of the colliders in the world.
    pub(super) places: Vec<Pose>,
}

impl Setup {
    pub(super) fn new(
        (positions, traits): (Vec<Vec3>, Vec<GuideTraits>),
        options: &VolumeOptions,
    ) -> Option<Self> {
        Self::with(positions, traits, N, options, &Default::default())
    }

    pub(super) fn with(
        positions: Vec<Vec3>,
        traits: Vec<GuideTraits>,
        n: usize,
        options: &VolumeOptions,
        colliders: &ColliderDescriptor<'_>,
    ) -> Option<Self> {
        let context = context()?;
        let params = SimulationParams::default();
        let rest =
            rest::guides(&positions, n as u32, &traits, &params, &RestOptions::default(), None).unwrap();
        let guides = GuideBuffers::new(context, rest.info.len() as u32, n as u32, 2).unwrap();
        rest.upload(context, &guides).unwrap();
        let asset = VolumeAsset::new(context, &rest, options, None).unwrap();
        let volume = Volume::new(context, &asset, &guides).unwrap();
        let forces = Forces::new(context, &guides, &volume, None);
        let colliders = ColliderSet::new(context, colliders).unwrap();
        Some(Self { context, guides, rest, volume, forces, colliders, places: Vec::new() })
    }

    /// Returns the rest positions, transformed by `place`, vertex-major.
    pub(super) fn moved(&self, place: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        self.rest.rest.iter().map(|r| place(r.position)).collect()
    }

    pub(super) fn put(&self, current: &[Vec3], velocity: &[Vec3]) {
        let current: Vec<[f32; 4]> = current.iter().map(|v| v.extend(0.0).into()).collect();
        let velocity: Vec<[u32; 2]> = velocity.iter().map(|v| pack_velocity(*v)).collect();
        self.context.queue().write_buffer(&self.guides.current, 0, bytemuck::cast_slice(&current));
        self.context.queue().write_buffer(&self.guides.velocity, 0, bytemuck::cast_slice(&velocity));
    }

    pub(super) fn submit(&mut self, record: impl FnOnce(&mut Self, &mut crate::gpu::ComputePass<'_>)) {
        crate::gpu::compute(self.context, |pass| record(self, pass));
    }

    pub(super) fn prepare(&mut self, params: &HairHair, step: &Step) {
        let steps = [*step];
        let substeps = SimulationParams::default().substep_count;
        let moments = Moments { steps: &steps, substeps, step: H, head: step.end, alpha: 1.0 };
        let poses = ColliderPoses { head: None, colliders: self.places.clone() };
        self.colliders.advance(&poses, &moments).unwrap();
        let frame = Steps { steps: &steps, length: H, substeps };
        self.volume.prepare(params, &frame, &self.colliders);
    }

    /// Returns the integers after `splat` alone, then clears them.
    pub(super) fn splatted(&mut self, step: &Step) -> Vec<i32> {
        self.prepare(&HairHair::default(), step);
        self.submit(|scene, pass| {
            let workgroups = scene.volume.base.splat_workgroups();
            scene.volume.pipelines.splat.record(pass, &scene.volume.groups.splat, &[0], workgroups);
        });
        let cells = readback::buffer(self.context, &self.volume.cells).unwrap();
        self.submit(|scene, pass| scene.volume.grids(pass, 0));
        let clear: Vec<i32> = readback::buffer(self.context, &self.volume.cells).unwrap();
        assert!(clear.iter().all(|i| *i == 0), "a step leaves the integers at zero");
        cells
    }

    /// Returns the forces on all vertices when the head moves by `step`.
    pub(super) fn forces(&mut self, params: &HairHair, step: &Step) -> Vec<Force> {
        self.prepare(params, step);
        self.submit(|scene, pass| {
            scene.volume.record(pass, &scene.colliders, 0);
            scene.forces.record(pass, 0);
        });
        let forces: Vec<GuideForce> = readback::buffer(self.context, &self.guides.forces).unwrap();
        forces.iter().map(GuideForce::unpack).collect()
    }

    pub(super) fn texture(&self, texture: &wgpu::Texture) -> Vec<[f32; 4]> {
        let bytes = readback::texture(self.context, texture).unwrap();
        bytemuck::pod_collect_to_vec::<u8, [f16; 4]>(&bytes).iter().map(|t| t.map(f16::to_f32)).collect()
    }
}

/// Length of a step, s.
pub(super) const H: f32 = 1.0 / 60.0;

pub(super) fn still(pose: Pose) -> Step {
    Step { mode: Mode::Step, begin: pose, end: pose, from: 0.0, to: 1.0 }
}

pub(super) fn somewhere() -> Pose {
    Pose {
        rotation: Quat::from_rotation_y(0.7) * Quat::from_rotation_x(-0.4),
        translation: Vec3::new(3.0, 1.5, -2.0),
    }
}

pub(super) fn swirl(p: Vec3) -> Vec3 {
    Vec3::new(2.0 * p.z - 0.3, (20.0 * p.x).sin(), 5.0 * p.y)
}
