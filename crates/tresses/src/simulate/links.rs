//! Hair–hair cohesion: springs between neighboring guides.
//!
//! Hair that stands out, as in an afro or a teased bun, is supported by its neighbors rather than by its own stiffness.
//! Hairs that lean together cannot slide along each other before the friction between them yields. When two parallel
//! hairs bend together, they must slide along each other by their distance times the angle; the resistance to that
//! carries the lock like a beam. Guides are therefore linked to nearby guides by springs along
//! the line between two vertices. Links preserve distances, so rotating hair as a whole has no effect, and no link
//! pulls at rest. Each link pulls equally at both ends, so links neither move nor turn hair as a whole.
//!
//! **Friction.** A link pulls with at most [`cohesion_limit`](crate::volume::HairHair::cohesion_limit). Beyond that
//! hair slides along hair, as in Coulomb's law for locks with a constant contact pressure (curls that hook into each
//! other, grease). Links have no memory of sliding: without the load, hair returns to its authored position. Beyond
//! twice the reach the pull fades out, so hands pass through.
//!
//! **Selection.** Each vertex looks for one vertex of another guide obliquely ahead and one obliquely behind, at 45° to
//! the strand and `cohesion_distance` away. The direction around the strand advances by the golden angle from vertex to
//! vertex. Links at right angles to the strands would not resist sliding. At most two other vertices may choose a
//! vertex, so it has at most [`LINKS`] links. Each link is stored at both ends, and no sum depends on the order of
//! threads.
//!
//! **Implicit.** A spring of rate `k` is evaluated at the end of the step of length `Δt`: `k (x + Δt w)`, where `w` is
//! the velocity at which the ends separate along the link. Each vertex solves for its own velocity and assumes that the
//! others yield as it does: `(1 + 2 Δt² Σ k n nᵀ) a = Σ n k (x + Δt w)`. This matrix bounds the matrix of the whole
//! system (a graph's Laplacian is at most twice its diagonal), so the step is stable at any stiffness. The effective
//! stiffness per vertex is at most `1 / 2Δt²` in total. A rigid motion has `w = 0`, so links add no inertia to it. The
//! damping `k Δt` follows from the same term. The strand's solve receives the result as an acceleration
//! ([`GuideBuffers::forces`]) and needs no knowledge of links.
//!
//! **Untried:** finding links again during motion, with anchors that slip.

use super::Pipelines;
use crate::{
    Context, Result,
    constants::{LINKS, VOLUME_WORKGROUP},
    gpu::{BindBuffer, Uniform},
    shaders::kernels::simulate as kernels,
    strands::{GuideBuffers, RestGuides, buffers::filled},
    volume::HairHair,
};
use bytemuck::{Pod, Zeroable};
#[cfg(test)]
use glam::Mat3;
use glam::{IVec3, Vec3};
use std::f32::consts::{FRAC_1_SQRT_2, TAU};
use std::sync::Arc;

/// Largest distance of linked vertices where hair is sparse, as a multiple of the reach.
const SPARSE: f32 = 2.0;

/// The golden angle, radians.
const GOLDEN: f32 = 2.399_963;

/// A link of a guide vertex to another.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct Link {
    /// Index of the other vertex in the guide buffers; the vertex's own index for no link.
    pub other: u32,
    /// Distance at rest, meters.
    pub length: f32,
}

/// Uniforms of the kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct LinkUniforms {
    /// Number of guide vertices.
    pub vertices: u32,
    /// Stiffness of a link, 1/s².
    pub stiffness: f32,
    /// Largest pull of a link, m/s².
    pub limit: f32,
    /// Elongation at which a link begins to fade, meters.
    pub fade_start: f32,
    /// Length of the step, s.
    pub span: f32,
    /// Unused.
    pub _pad: [u32; 3],
}

impl LinkUniforms {
    /// Returns the uniforms for `vertices` guide vertices and steps of `span` seconds.
    pub fn new(vertices: u32, params: &HairHair, span: f32) -> Self {
        Self {
            vertices,
            stiffness: params.cohesion,
            limit: params.cohesion_limit,
            fade_start: params.cohesion_distance,
            span,
            ..Self::zeroed()
        }
    }
}

/// Links of a groom on the GPU.
#[derive(Clone, Debug)]
pub(crate) struct LinkAsset {
    /// Distance at which vertices are linked, meters.
    pub distance: f32,
    /// [`Link`]s.
    links: wgpu::Buffer,
}

impl LinkAsset {
    /// Links guides that have the rest state `rest`.
    ///
    /// # Errors
    /// [`Error::Limit`](crate::Error::Limit).
    pub fn new(context: &Context, rest: &RestGuides, distance: f32) -> Result<Self> {
        Ok(Self { distance, links: filled(context, "links", bytemuck::cast_slice(&find(rest, distance)))? })
    }

    pub fn bytes(&self) -> u64 {
        self.links.size()
    }
}

/// The links of one head on the GPU.
#[derive(Debug)]
pub(crate) struct Links {
    pipelines: Arc<Pipelines>,
    uniforms: Uniform,
    pub(crate) asset: LinkAsset,
    group: wgpu::BindGroup,
    vertices: u32,
}

impl Links {
    /// Binds the links to the guides of one head.
    pub(crate) fn new(context: &Context, guides: &GuideBuffers, asset: LinkAsset) -> Self {
        let pipelines: Arc<Pipelines> = context.pipelines();
        let uniforms = context.device.storage_uniform(size_of::<LinkUniforms>());
        let group = pipelines.links.bind(&kernels::Links {
            u: uniforms.entire(),
            list: asset.links.entire(),
            current: guides.current.entire(),
            velocity: guides.velocity.entire(),
            forces: guides.forces.entire(),
        });
        Self { pipelines, uniforms, asset, group, vertices: guides.count * guides.vertex_count }
    }

    /// Writes the uniforms of a frame with steps of `span` seconds.
    pub fn prepare(&self, params: &HairHair, span: f32) {
        let uniforms = LinkUniforms::new(self.vertices, params, span);
        self.uniforms.write(0, bytemuck::bytes_of(&uniforms));
    }

    /// Records one step, after [`Forces`](super::Forces) has written its forces.
    pub fn record(&self, pass: &mut crate::gpu::ComputePass<'_>) {
        self.pipelines.links.record(pass, &self.group, &[], self.vertices.div_ceil(VOLUME_WORKGROUP));
    }

    /// Bytes of GPU memory of this head alone.
    pub(crate) fn own_bytes(&self) -> u64 {
        self.uniforms.size()
    }
}

/// CPU reference of the kernel: the acceleration, m/s², of a vertex at `x` with velocity `v`. Each link is its length
/// at rest, and position and velocity of its other end.
#[cfg(test)]
fn pull(u: &LinkUniforms, x: Vec3, v: Vec3, links: &[(f32, Vec3, Vec3)]) -> Vec3 {
    let (mut pull, mut m) = (Vec3::ZERO, Mat3::IDENTITY);
    for (length, at, velocity) in links {
        let offset = *at - x;
        let unit = offset / offset.length().max(1e-6);
        let longer = offset.length() - length;
        let near = (2.0 - longer / u.fade_start).clamp(0.0, 1.0);
        let stiffness = near * u.stiffness.min(u.limit / longer.abs().max(1e-9));
        let rate = stiffness * u.span;
        pull += unit * (stiffness * longer + rate * unit.dot(*velocity - v));
        m += Mat3::from_cols(unit * unit.x, unit * unit.y, unit * unit.z) * (2.0 * rate * u.span);
    }
    (m.as_dmat3().inverse() * pull.as_dvec3()).as_vec3()
}

/// Returns the links of all vertices; the `k`th link of vertex `at` is at `k * vertices + at`.
pub(crate) fn find(rest: &RestGuides, distance: f32) -> Vec<Link> {
    let (count, all) = (rest.info.len(), rest.rest.len());
    let position = |at: usize| rest.rest[at].position;
    let none = |at: usize| Link { other: at as u32, length: 0.0 };
    let mut links: Vec<_> = (0..LINKS as usize * all).map(|slot| none(slot % all)).collect();
    let near = CellIndex::new(rest, distance);
    // The first half of a vertex's links are those that it chose; the others were chosen by other vertices.
    let own = LINKS as usize / 2;
    let mut found = vec![0u8; all];
    for at in 2 * count..all {
        let (guide, i) = (at % count, at / count);
        let before = position(at - count);
        let after = if at + count < all { position(at + count) } else { position(at) };
        let Some(t) = (after - before).try_normalize() else { continue };
        let side = t.any_orthonormal_vector();
        // Search farther where hair is sparse.
        let foreign = |other: usize| other % count != guide;
        let Some(closest) = near.nearest(position(at), SPARSE * distance, foreign) else { continue };
        let local_distance = distance.max(1.5 * position(at).distance(position(closest)));
        let (sine, cosine) = ((guide as f32 * 0.618_034).fract() * TAU + i as f32 * GOLDEN).sin_cos();
        let around = side * cosine + t.cross(side) * sine;
        for (k, oblique) in [t + around, -t - around].into_iter().enumerate() {
            let free = |other: usize| {
                other % count != guide
                    && (other < 2 * count || usize::from(found[other]) < LINKS as usize - own)
            };
            let offset = oblique * (local_distance * FRAC_1_SQRT_2);
            let mirrored = offset - 2.0 * (offset - t * offset.dot(t));
            let target = [offset, mirrored]
                .into_iter()
                .find_map(|offset| near.nearest(position(at) + offset, 0.5 * local_distance, free));
            let Some(other) = target else { continue };
            let length = position(at).distance(position(other));
            links[k * all + at] = Link { other: other as u32, length };
            // Roots need no link back: they follow the head.
            if other >= 2 * count {
                let slot = own + usize::from(found[other]);
                links[slot * all + other] = Link { other: at as u32, length };
                found[other] += 1;
            }
        }
    }
    links
}

/// Guide vertices sorted by grid cell.
struct CellIndex<'a> {
    rest: &'a RestGuides,
    cell: f32,
    sorted: Vec<(IVec3, u32)>,
}

impl<'a> CellIndex<'a> {
    /// Sorts the vertices of `rest` into cells of a few vertices each, but no smaller than an eighth of `distance`.
    fn new(rest: &'a RestGuides, distance: f32) -> Self {
        let mut corners = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for r in &rest.rest {
            corners = (corners.0.min(r.position), corners.1.max(r.position));
        }
        let volume = (corners.1 - corners.0).max(Vec3::splat(distance)).element_product();
        let cell = (4.0 * volume / rest.rest.len().max(1) as f32).cbrt().clamp(distance / 8.0, distance);
        let cells = rest.rest.iter().enumerate();
        let mut sorted: Vec<_> =
            cells.map(|(i, r)| ((r.position / cell).floor().as_ivec3(), i as u32)).collect();
        sorted.sort_unstable_by_key(|(cell, i)| (cell.to_array(), *i));
        Self { rest, cell, sorted }
    }

    /// Returns the `free` vertex nearest to `x`, no farther than `max_distance`.
    fn nearest(&self, x: Vec3, max_distance: f32, free: impl Fn(usize) -> bool) -> Option<usize> {
        let center = (x / self.cell).floor().as_ivec3();
        let mut best = (max_distance * max_distance, None);
        // Shell by shell of cells, until no farther shell can be nearer.
        for shell in 0..=(max_distance / self.cell).ceil() as i32 {
            let within = (shell - 1).max(0) as f32 * self.cell;
            if within * within > best.0 {
                break;
            }
            for dx in -shell..=shell {
                for dy in -shell..=shell {
                    let inner = dx.abs() < shell && dy.abs() < shell;
                    let sides =
                        if inner { vec![(-shell, -shell), (shell, shell)] } else { vec![(-shell, shell)] };
                    for (from, to) in sides {
                        self.row(center + IVec3::new(dx, dy, from), center.z + to, |at| {
                            let far = self.rest.rest[at].position.distance_squared(x);
                            if far < best.0 && free(at) {
                                best = (far, Some(at));
                            }
                        });
                        if shell == 0 {
                            break;
                        }
                    }
                }
            }
        }
        best.1
    }

    /// Calls `each` for the vertices of the cells along z from `low` to `last`, which are contiguous in the order.
    fn row(&self, low: IVec3, last: i32, mut each: impl FnMut(usize)) {
        let high = IVec3 { z: last, ..low }.to_array();
        let begin = self.sorted.partition_point(|(cell, _)| cell.to_array() < low.to_array());
        let row = self.sorted[begin..].iter().take_while(|(cell, _)| cell.to_array() <= high);
        row.for_each(|(_, vertex)| each(*vertex as usize));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        gpu::{for_tests as context, readback::blocking as readback},
        simulate::{GuideTraits, RestOptions, SimulationParams, rest},
        strands::{
            Force, GuideForce,
            guide::{pack_velocity, unpack_velocity},
        },
    };

    /// Upright hairs 1 cm apart, six by six.
    fn lawn(n: usize) -> RestGuides {
        let at = |g: usize, i: usize| Vec3::new((g % 6) as f32, i as f32, (g / 6) as f32) * 0.01;
        let positions: Vec<_> = (0..36).flat_map(|g| (0..n).map(move |i| at(g, i))).collect();
        let traits = [GuideTraits::default(); 36];
        let params = SimulationParams::default();
        rest::guides(&positions, n as u32, &traits, &params, &RestOptions::default(), None).unwrap()
    }

    /// Returns a pseudorandom number between -1 and 1.
    fn some(i: usize, k: usize) -> f32 {
        ((i * 3 + k) as f32 * 0.618_034).fract() * 2.0 - 1.0
    }

    /// Returns the largest difference of kernel and reference, m/s², for hair displaced by centimeters. The limit of
    /// the reference is `false_limit` times the kernel's.
    fn compare(context: &Context, false_limit: f32) -> f32 {
        let Context { queue, .. } = context;
        let rest = lawn(12);
        let (count, all) = (rest.info.len(), rest.rest.len());
        let guides = GuideBuffers::new(context, count as u32, 12, 2).unwrap();
        rest.upload(context, &guides).unwrap();
        let vector = |i: usize| Vec3::new(some(i, 0), some(i, 1), some(i, 2));
        let places: Vec<_> = (0..all).map(|i| rest.rest[i].position + vector(i) * 0.01).collect();
        let words: Vec<[f32; 4]> = places.iter().map(|p| p.extend(0.0).to_array()).collect();
        queue.write_buffer(&guides.current, 0, bytemuck::cast_slice(&words));
        let velocities: Vec<_> = (0..all).map(|i| pack_velocity(vector(i + 7))).collect();
        queue.write_buffer(&guides.velocity, 0, bytemuck::cast_slice(&velocities));
        let before = Force { acceleration: Vec3::X, rate: 3.0, tangent: Vec3::Y, along: 2.0 };
        let forces = vec![GuideForce::pack(&before); all];
        queue.write_buffer(&guides.forces, 0, bytemuck::cast_slice(&forces));
        let params =
            HairHair { cohesion: 900.0, cohesion_limit: 5.0, cohesion_distance: 0.02, ..Default::default() };
        let asset = LinkAsset::new(context, &rest, params.cohesion_distance).unwrap();
        let links = Links::new(context, &guides, asset);
        links.prepare(&params, 1.0 / 60.0);
        crate::gpu::compute(context, |pass| links.record(pass));
        let found: Vec<GuideForce> = readback::buffer(context, &guides.forces).unwrap();
        let list = find(&rest, params.cohesion_distance);
        let mut u = LinkUniforms::new(all as u32, &params, 1.0 / 60.0);
        u.limit *= false_limit;
        let mut worst = 0f32;
        for at in 0..all {
            let own: Vec<_> = (0..LINKS as usize)
                .map(|k| list[k * all + at])
                .map(|l| (l.length, places[l.other as usize], unpack_velocity(velocities[l.other as usize])))
                .collect();
            let expected = pull(&u, places[at], unpack_velocity(velocities[at]), &own) + before.acceleration;
            let force = found[at].unpack();
            assert_eq!((force.rate, force.along), (3.0, 2.0));
            worst = worst.max(force.acceleration.distance(expected));
        }
        worst
    }

    #[test]
    fn kernel_matches_reference() {
        let Some(context) = context() else { return };
        let (right, wrong) = (compare(context, 1.0), compare(context, 1.1));
        println!("differ by {right} m/s², with a wrong limit by {wrong}");
        assert!(right < 0.02 && wrong > 0.1);
    }

    #[test]
    fn links_are_mutual_and_oblique() {
        let rest = lawn(12);
        let (count, all) = (rest.info.len(), rest.rest.len());
        let links = find(&rest, 0.02);
        let of = |at: usize| (0..LINKS as usize).map(move |k| k * all + at);
        let mut some = 0;
        for at in 0..all {
            for link in of(at).map(|slot| links[slot]).filter(|link| link.other != at as u32) {
                let other = link.other as usize;
                assert!(at >= 2 * count, "a root is linked");
                assert_ne!(at % count, other % count, "a guide is linked to itself");
                let back = of(other).any(|slot| links[slot].other == at as u32);
                assert!(back || other < 2 * count, "{at} to {other}, not back");
                let way = rest.rest[other].position - rest.rest[at].position;
                assert!((way.length() - link.length).abs() < 1e-6);
                some += usize::from(way.y.abs() > 0.3 * link.length);
            }
        }
        let ends = links.iter().enumerate().filter(|(slot, link)| link.other as usize != slot % all).count();
        assert!(some * 10 > ends * 9, "{some} of {ends} are oblique");
        assert!(ends > 2 * (all - 2 * count), "only {ends}");
    }

    #[test]
    fn links_ignore_rigid_motion_and_do_not_overshoot() {
        let u = LinkUniforms {
            stiffness: 1e6,
            limit: 1e9,
            fade_start: 0.02,
            span: 1.0 / 60.0,
            ..Zeroable::zeroed()
        };
        let to = |way: Vec3, v: Vec3| (0.01, way, v);
        let ways = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::ONE.normalize()].map(|way| way * 0.01);
        let together = ways.map(|way| to(way, Vec3::ONE));
        assert!(pull(&u, Vec3::ZERO, Vec3::ONE, &together).length() < 1.0);
        // Two hairs that approach each other at 1 m/s: neither reverses within the step.
        let a = pull(&u, Vec3::ZERO, Vec3::X * 0.5, &[to(Vec3::X * 0.01, Vec3::X * -0.5)]);
        assert!(a.x < 0.0 && a.x * u.span > -0.51, "{a}");
    }
}
