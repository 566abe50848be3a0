//! Crowds: many characters that share a groom, each with its own position, motion phase and pigment.

use crate::{
    camera::{VERTICAL_FOV, Viewpoint},
    motion::Motion,
    scene::Scene,
};
use anyhow::{Result, ensure};
use tresses::{
    Character, CrowdBudget, Gesture, LodOptions, Pose, Timings,
    glam::{Quat, Vec3},
    groom::hash::pcg,
    light::{FiberMaterial, HairMaterial},
    low_level::{CrowdDetail, Drawing, Hair},
};

/// Distances of the first and the last row from the camera, meters.
pub const ROWS: [f32; 2] = [2.0, 40.0];
/// Minimum distance between the centers of two heads in a row, meters.
const MIN_SPACING: f32 = 0.62;
/// Height of the camera above the heads per meter of distance to the first row.
const ABOVE: f32 = 0.22;

/// Options of a crowd.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrowdOptions {
    /// Number of heads.
    pub heads: u32,
    /// Distances of the first and the last row from the camera, meters.
    pub rows: [f32; 2],
    /// Whether hair colors vary. Otherwise all hair has the material of the settings.
    pub pigments: bool,
}

/// One character of a crowd.
struct Head {
    character: Character,
    /// Transform from groom space, with the head facing forward, to its place in the world.
    pose: Pose,
    /// Phase offset, as a share of the motion's period.
    phase: f64,
}

/// Many instances of a scene's character, and the camera that sees them.
pub struct Crowd {
    heads: Vec<Head>,
    /// Viewpoint of the crowd.
    pub camera: Viewpoint,
    /// Cost budget, cost model, and the levels of detail of the last frame.
    pub budget: CrowdBudget,
}

impl Crowd {
    /// Instantiates the character of `scene` with its material, animation and levels of detail. Set the levels to
    /// [`levels`] before uploading the hair, because the upload measures the hair for them.
    ///
    /// # Errors
    /// Fails if the scene has colliders, which all heads would share, or if the adapter cannot allocate the instances.
    pub fn new(scene: &mut Scene, options: &CrowdOptions) -> Result<Self> {
        ensure!(options.heads > 0, "a crowd needs at least one head");
        ensure!(scene.character.props.is_empty(), "a crowd does not support colliders: remove them");
        let (lo, hi) = scene.subject();
        let center = 0.5 * (lo + hi);
        let rows = rows(options, scene.targets().size);
        let eye = Vec3::new(0.0, center.y + ABOVE * options.rows[0] + 0.5 * (hi.y - lo.y), center.z);
        // Aim between the first and the last row, so that both are in the frame.
        let down = |away: f32| ((eye.y - center.y) / away).atan();
        let pitch = 0.5 * (down(options.rows[0]) + down(options.rows[1]));
        let camera =
            Viewpoint { eye, target: eye + Vec3::new(0.0, -pitch.sin(), -pitch.cos()) * options.rows[0] };
        let materials = pigments(scene.character.hair().set.material, options.pigments);
        let mut heads = Vec::new();
        for (i, at) in rows.into_iter().enumerate() {
            let random = |k: u32| pcg(8 * i as u32 + k) as f32 / u32::MAX as f32;
            let mut character = scene.character.instance()?;
            character.set_material(materials[pcg(i as u32 + 31) as usize % materials.len()]);
            // Face the camera, up to 0.8 rad to either side.
            let yaw = (random(0) - 0.5) * 1.6 + (-at.x).atan2(-at.z);
            let rotation = Pose::about(center, Quat::from_rotation_y(yaw));
            let pose = Pose { translation: rotation.translation + at, ..rotation };
            heads.push(Head { character, pose, phase: f64::from(random(3)) });
        }
        Ok(Self { heads, camera, budget: CrowdBudget::default() })
    }

    /// Returns the number of heads.
    pub fn len(&self) -> usize {
        self.heads.len()
    }

    /// Returns whether the crowd is empty, which `new` prevents.
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Returns the levels chosen for the last frame, one per groom.
    pub fn detail(&self) -> &CrowdDetail {
        &self.budget.detail
    }

    /// Sets the level of detail options of all heads.
    pub fn set_lod(&mut self, options: LodOptions) {
        self.heads.iter_mut().for_each(|head| head.character.set_lod(options));
    }

    /// Puts all hair at rest in the next frame.
    pub fn reset(&mut self) {
        self.heads.iter_mut().for_each(|head| head.character.reset());
    }

    /// Returns GPU memory, bytes: shared by all heads, owned by each, and held by the view.
    pub fn bytes(&self, scene: &Scene) -> [u64; 3] {
        let shared = self.heads.first().map_or(0, |head| head.character.shared_bytes());
        let own = self.heads.iter().map(|head| head.character.own_bytes());
        let view = &scene.view;
        let lit = view.shadow_bytes() + view.ambient_bytes() + view.zone_bytes() + view.shaded_bytes();
        [shared, own.sum(), lit + view.targets().bytes()]
    }

    /// Returns the GPU memory that the [budget](Self::budget) limits, bytes, after a frame: the hair of all heads, and
    /// the view's buffers for hair and its lighting.
    pub fn held(&self, scene: &Scene) -> u64 {
        let grooms = || self.heads.iter().flat_map(|head| head.character.grooms());
        let shared: u64 = self
            .heads
            .iter()
            .take(1)
            .flat_map(|head| head.character.grooms())
            .map(|hair| hair.shared_bytes())
            .sum();
        let own: u64 = grooms().map(|hair| hair.own_bytes()).sum();
        let view = &scene.view;
        shared + own + view.zone_bytes() + view.shaded_bytes() + view.targets().hair_bytes()
    }

    /// Records the motion of a frame that is `seconds` long and ends at `time` seconds of `motion`, and chooses levels
    /// of detail.
    ///
    /// # Errors
    /// Fails if the adapter cannot allocate what a level needs.
    pub fn record_advance(
        &mut self,
        scene: &mut Scene,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        motion: &Motion,
        (time, seconds): (f64, f32),
    ) -> Result<()> {
        scene.look_from(self.camera);
        let eye = [scene.eye(&self.camera)];
        let neck = scene.character.neck();
        for Head { character, pose, phase } in &mut self.heads {
            let time_offset = *phase * motion.duration();
            let gesture = motion.gesture(time + time_offset, neck);
            character.gesture = Gesture { body: pose.after(&gesture.body), ..gesture };
            // Offset body animations too.
            let period = character.rig().and_then(|rig| rig.duration()).unwrap_or_default();
            character.seek(time - f64::from(seconds) + *phase * f64::from(period));
        }
        let mut all: Vec<_> = self.heads.iter_mut().map(|head| &mut head.character).collect();
        let frame = scene.gpu.context.frame(encoder).timed(timings).with_cameras(&eye);
        Ok(frame.within(&mut self.budget).advance(&mut all, seconds)?)
    }

    /// Records drawing that frame into the view of `scene`.
    ///
    /// # Errors
    /// Fails if the adapter cannot allocate what the view needs.
    pub fn record_draw(
        &self,
        scene: &mut Scene,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
    ) -> Result<()> {
        let all: Vec<_> = self.heads.iter().map(|head| &head.character).collect();
        let mut frame = scene.gpu.context.frame(encoder).timed(timings);
        Ok(frame.draw_as(&mut scene.view, &all, Drawing::new(&scene.picture))?)
    }

    /// Iterates over the hair of each head.
    pub fn hair(&self) -> impl Iterator<Item = &Hair> {
        self.heads.iter().map(|head| head.character.hair())
    }

    /// Returns the distance of each head from the camera, meters.
    pub fn distances(&self) -> Vec<f32> {
        let of = |head: &Head| head.pose.point(head.character.neck()).distance(self.camera.eye);
        self.heads.iter().map(of).collect()
    }
}

/// Returns the level of detail options of a head in a crowd: options that have their defaults get the crowd's defaults.
pub fn levels(own: LodOptions) -> LodOptions {
    fn or_crowd_default<T: PartialEq>(own: T, one: T, many: T) -> T {
        if own == one { many } else { own }
    }
    let (one, many) = (LodOptions::default(), LodOptions::CROWD);
    LodOptions {
        mode: own.mode,
        bias: own.bias,
        strand_width: or_crowd_default(own.strand_width, one.strand_width, many.strand_width),
        curve_error: or_crowd_default(own.curve_error, one.curve_error, many.curve_error),
        slowest: or_crowd_default(own.slowest, one.slowest, many.slowest),
        slow_pixel: or_crowd_default(own.slow_pixel, one.slow_pixel, many.slow_pixel),
        guides: or_crowd_default(own.guides, one.guides, many.guides),
        substep_pixel: or_crowd_default(own.substep_pixel, one.substep_pixel, many.substep_pixel),
        collision_pixel: or_crowd_default(own.collision_pixel, one.collision_pixel, many.collision_pixel),
        can_sleep: own.can_sleep || many.can_sleep,
    }
}

/// Returns the offsets of the heads from a head directly below the camera, meters. Rows are equally spaced, and at most
/// as wide as the frame at their distance.
fn rows(options: &CrowdOptions, [width, height]: [u32; 2]) -> Vec<Vec3> {
    let count = options.heads.max(1);
    let rows = (f64::from(count).sqrt().ceil() as u32).max(1);
    let [near, far] = options.rows;
    let aspect = width as f32 / height.max(1) as f32;
    let mut heads = Vec::new();
    for row in 0..rows {
        let left = count - heads.len() as u32;
        let away = near + (far - near) * if rows > 1 { row as f32 / (rows - 1) as f32 } else { 0.0 };
        let wide = 1.9 * away * (0.5 * VERTICAL_FOV).tan() * aspect;
        let fits = ((wide / MIN_SPACING) as u32).max(1);
        let own = left.div_ceil(rows - row).min(if row + 1 == rows { left } else { fits });
        let spacing = (wide / own.max(1) as f32).clamp(MIN_SPACING, 2.5 * MIN_SPACING + 0.04 * away);
        for i in 0..own {
            let random = |k: u32| pcg(4 * heads.len() as u32 + k) as f32 / u32::MAX as f32 - 0.5;
            // Jitter, so that heads do not form a grid.
            let lateral_offset =
                (i as f32 - 0.5 * (own - 1) as f32) * spacing + 0.25 * (spacing - MIN_SPACING) * random(0);
            let back = if row == 0 { 0.0 } else { 0.5 * random(1) };
            heads.push(Vec3::new(lateral_offset, 0.12 * random(2), -away + back));
        }
    }
    heads
}

/// Returns the materials of a crowd's hair. The first is the settings' material.
fn pigments(own: HairMaterial, several: bool) -> Vec<HairMaterial> {
    let mut all = vec![own];
    if several {
        let named =
            [HairMaterial::black(), HairMaterial::brown(), HairMaterial::blond(), HairMaterial::red()];
        // Keep the fiber and the minimum width of the settings.
        all.extend(named.map(|other| {
            let HairMaterial { uses_file_colors: file_colors, min_width, .. } = own;
            let mut material = HairMaterial { uses_file_colors: file_colors, min_width, ..other };
            material.fiber = FiberMaterial {
                root_absorption: other.fiber.root_absorption,
                tip_absorption: other.fiber.tip_absorption,
                ..own.fiber
            };
            material
        }));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_heads_apart() {
        for heads in [1, 2, 25, 100, 300] {
            let options = CrowdOptions { heads, rows: ROWS, pigments: true };
            let places = rows(&options, [1280, 720]);
            assert_eq!(places.len() as u32, heads);
            let far = |p: &Vec3| -p.z;
            assert!(places.iter().all(|p| (1.9..=41.0).contains(&far(p))));
            let apart = |a: &Vec3, b: &Vec3| Vec3::new(a.x - b.x, 0.0, a.z - b.z).length();
            for (i, a) in places.iter().enumerate() {
                assert!(places[..i].iter().all(|b| apart(a, b) > 0.4), "{heads}: {a} stands in another");
            }
        }
    }
}
