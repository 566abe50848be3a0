//! Zones: parts of what a view sees that have shadow maps and a grid of ambient light of their own.
//!
//! One set of maps around one [focus](crate::view::Picture::focus) is right for a head, or a few beside each other. In maps
//! that hold a crowd of 40 m a head is two texels wide, and a cell of the grid is as large as ten of them. So each head has
//! a zone, a sphere around it, whose maps are as fine as the picture shows it ([`Zone::seen`]). Coarse maps are too dark,
//! for their texels smooth the front of the hair: by 1.6 % with 256² texels around a head, 5 with 128², 13 with 64². Coarse
//! cells are not, among a photographer's lights: 12³ and 8³ are as bright in the mean as 24³; by the sky alone a head
//! is up to 3.5 % brighter with 12³. What lies in two zones is lit in each by its own.
//!
//! ```text
//! zones ─► for each: shadow maps, ambient light (the same kernels, other buffers)
//! hair ──► shaded in the light of its zone      bodies ─► asked for (draw::soft) and drawn in theirs
//! ```
//!
//! **In turn.** Light from all sides of a far zone is made in every second or third picture, each zone's in another, and
//! kept in between ([`Zone::every`]) while the head has turned by less than a cell ([`Zone::pose`]); the grid goes with
//! the focus. Shadow maps are made in every picture: they know where each strand lies, and what has moved by a few texels
//! lies behind what was in front of it then, up to 28 % too dark.
//!
//! **Far.** A picture of one head, or of a few beside each other, that is small is lit as one zone with a quarter of the
//! texels and three fifths of the cells ([`View::fit_light`](crate::View::fit_light)): what maps and grid cost does not fall
//! with the pixels. Light is made in every picture there, so that a picture does not depend on those before it.
//!
//! Zones cast no shadow on each other: what stands in the light of a neighbour is lit all the same.
//!
//! **Why not cascades?** They share what is near and blur what is far, along the way from the eye; heads in a crowd are
//! small things with much air between them, and most of a cascade would be empty. **Why not one atlas?** Every lookup
//! would clamp to its tile, in every kernel of the stage; buffers of their own cost a few bind groups.

use super::{Sphere, State};
use crate::{Camera, Context, Pose};
use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU32, Ordering},
};

/// A part of what a view sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// What its shadow maps and its grid cover.
    pub focus: Sphere,
    /// Texels along each edge of a shadow map, brought into 4 to 2048.
    pub resolution: u32,
    /// Cells along each edge of the grid of ambient light, brought into 4 to 64.
    pub cells: u32,
    /// The grooms in it, by their places among those that are recorded.
    pub hair: Vec<usize>,
    /// The bodies in it, likewise.
    pub bodies: Vec<usize>,
    /// Where what is in it is and how it is turned. Let the focus go with it.
    pub pose: Pose,
    /// Its light from all sides is made anew in one of so many pictures, and whenever what is in it has changed, or has
    /// moved against the focus by a cell. 0 and 1 for each picture.
    pub every: u32,
}

/// The coarsest and finest maps and grids of [`Zone::seen`].
const RESOLUTIONS: [u32; 2] = [256, 1024];
const CELLS: [u32; 3] = [12, 16, 24];
/// The edge of a cell, pixels.
const CELL: f32 = 8.0;
/// How far anything in a zone may have moved against the focus since its light from all sides was made, cells.
const STRAY: f32 = 1.0;
/// Zones of so many pixels have new light from all sides in each picture; those of half of it in every second, smaller
/// ones in every third.
const EACH: f32 = 320.0;

/// Texels and cells of the only zone of a picture that is fewer pixels across than this: as with [`Zone::seen`], texels of
/// the hair's maps are smaller than two pixels. With 16 cells hair without a body is 3.3 % brighter by the sky alone.
const FAR: [u32; 2] = [512, 20];
const SMALL: f32 = 100.0;
/// Finer ones come back where it is so much larger.
const AGAIN: f32 = 1.1;

impl Zone {
    /// Around `focus`, as fine as `camera` sees it: texels of the hair's maps are no larger than two pixels, as long as there
    /// are enough of them, and cells about eight, of pictures `coarser` octaves coarser. In steps, so that a head that moves
    /// seldom gets others.
    pub fn seen(focus: Sphere, camera: &Camera, coarser: f32, hair: Vec<usize>, bodies: Vec<usize>) -> Self {
        let pixels = focus.pixels(camera) * (-coarser).exp2();
        // Three texels of a depth map are one of the hair's, which is smoothed over three.
        let octaves = (1.5 * pixels / RESOLUTIONS[0] as f32).max(1.0).log2().ceil();
        let resolution = (RESOLUTIONS[0] << (octaves as u32).min(16)).min(RESOLUTIONS[1]);
        let cells = CELLS.into_iter().rev().find(|cells| *cells as f32 * CELL <= pixels).unwrap_or(CELLS[0]);
        let every = if pixels >= EACH {
            1
        } else if pixels >= 0.5 * EACH {
            2
        } else {
            3
        };
        Self { focus, resolution, cells, hair, bodies, every, pose: Pose::IDENTITY }
    }

    /// What all of `counts` grooms and bodies around `focus` are in where a `camera`, of pictures `coarser` octaves
    /// coarser, sees them from so far away that fewer texels and cells than the `finest` do. Nothing where they do not.
    /// `before` is what this was in the picture before: a head on the line keeps the light that it has.
    pub(crate) fn far(
        focus: Sphere,
        (camera, coarser): (&Camera, f32),
        finest: [u32; 2],
        before: Option<&Self>,
        counts: [usize; 2],
    ) -> Option<Self> {
        let sizes @ [resolution, cells] = [0, 1].map(|i| FAR[i].min(finest[i]));
        let had = before.is_some_and(|zone| [zone.resolution, zone.cells] == sizes);
        let line = if had { AGAIN * SMALL } else { SMALL };
        let is_far = focus.pixels(camera) * (-coarser).exp2() < line;
        let [hair, bodies] = counts.map(|count| (0..count).collect());
        let zone = Self { focus, resolution, cells, hair, bodies, every: 1, pose: Pose::IDENTITY };
        (is_far && sizes != finest).then_some(zone)
    }

    /// Whether light from all sides that was made for `then` is its light still.
    fn keeps(&self, then: &Self) -> bool {
        if (self.focus.radius, &self.hair, &self.bodies) != (then.focus.radius, &then.hair, &then.bodies) {
            return false;
        }
        let turn = self.pose.rotation * then.pose.rotation.conjugate();
        // Around an axis through the focus: twice the sine of half the angle, times the radius.
        let swing = 2.0 * self.focus.radius * turn.xyz().length();
        let middle =
            |zone: &Self| zone.pose.rotation.conjugate() * (zone.focus.center - zone.pose.translation);
        let cell = 2.0 * self.focus.radius / self.cells.max(1) as f32;
        swing + middle(self).distance(middle(then)) <= STRAY * cell
    }

    /// Bytes of GPU memory that its light takes.
    pub fn bytes(&self) -> u64 {
        State::bytes_of([self.resolution, self.cells])
    }
}

/// A zone with its light.
#[derive(Debug)]
struct Kept {
    zone: Zone,
    light: Arc<State>,
    /// What its light from all sides was made for; nothing where it must be made anew.
    made: Mutex<Option<Zone>>,
}

impl Kept {
    fn made(&self) -> MutexGuard<'_, Option<Zone>> {
        // What a panic leaves behind is whole.
        self.made.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The zones of a view, each with its light.
#[derive(Debug, Default)]
pub(crate) struct Zones {
    list: Vec<Kept>,
    /// In how many pictures light was made.
    pictures: AtomicU32,
}

impl Zones {
    /// These zones from here on, seen by `camera`; light that is as fine as one wants is kept.
    pub fn set(&mut self, context: &Context, camera: &wgpu::Buffer, zones: &[Zone]) {
        let mut before: Vec<_> = std::mem::take(&mut self.list).into_iter().map(Some).collect();
        let mut set = |(i, zone): (usize, &Zone)| {
            let sizes = [zone.resolution, zone.cells];
            let kept = before.get_mut(i).and_then(|old| old.take_if(|old| old.light.fits(sizes)));
            let Some(kept) = kept else {
                let light = Arc::new(State::new(context, sizes, 0, camera));
                return Kept { zone: zone.clone(), light, made: Mutex::default() };
            };
            // What was made may be another's.
            let made = kept.made().take().filter(|then| zone.keeps(then));
            Kept { zone: zone.clone(), light: kept.light, made: made.into() }
        };
        self.list = zones.iter().enumerate().map(&mut set).collect();
    }

    /// The first of them.
    pub fn first(&self) -> Option<&Zone> {
        self.list.first().map(|kept| &kept.zone)
    }

    /// Light from all sides of these parts has been made in a picture.
    pub fn made(&self, parts: &[Part<'_>]) {
        for part in parts.iter().filter(|part| part.fresh) {
            if let Some(kept) = (part.number as usize).checked_sub(1).and_then(|i| self.list.get(i)) {
                *kept.made() = Some(kept.zone.clone());
            }
        }
        self.pictures.fetch_add(1, Ordering::Relaxed);
    }

    /// What a picture of so many grooms and bodies is lit by: one part for each zone, and the view's own `light` around
    /// `focus` for those that are in none. Without zones, that alone.
    pub fn parts<'a>(
        zones: Option<&'a Self>,
        (light, focus): (&'a State, Sphere),
        [hair, bodies]: [usize; 2],
    ) -> Vec<Part<'a>> {
        let (all_hair, all_bodies) = ((0..hair).collect(), (0..bodies).collect());
        let all = Part { number: 0, light, focus, hair: all_hair, bodies: all_bodies, fresh: true };
        let Some(zones) = zones.filter(|zones| !zones.list.is_empty()) else { return vec![all] };
        let picture = zones.pictures.load(Ordering::Relaxed);
        let zones = &zones.list;
        let mut rest = [vec![true; hair], vec![true; bodies]];
        let mut parts = Vec::with_capacity(zones.len() + 1);
        for kept in zones {
            let Kept { zone, light, .. } = kept;
            // One that another zone has, or that is not there, is not this one's.
            let [own_hair, own_bodies] = [&zone.hair, &zone.bodies].map(|list| list.iter().copied());
            let own = |list: &mut dyn Iterator<Item = usize>, rest: &mut Vec<bool>| -> Vec<usize> {
                list.filter(|i| rest.get_mut(*i).is_some_and(std::mem::take)).collect()
            };
            let [of_hair, of_bodies] = &mut rest;
            let number = parts.len() as u32 + 1;
            // Each in its turn.
            let due = picture.wrapping_add(number).is_multiple_of(zone.every.max(1));
            parts.push(Part {
                number,
                fresh: due || kept.made().is_none(),
                light,
                focus: zone.focus,
                hair: own(&mut { own_hair }, of_hair),
                bodies: own(&mut { own_bodies }, of_bodies),
            });
        }
        let [hair, bodies] = rest.map(|rest| {
            rest.iter().enumerate().filter(|(_, rest)| **rest).map(|(i, _)| i).collect::<Vec<_>>()
        });
        if !hair.is_empty() || !bodies.is_empty() {
            parts.push(Part { number: parts.len() as u32 + 1, hair, bodies, ..all });
        }
        parts
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.list.iter().map(|Kept { light, .. }| light.shadow_bytes() + light.ambient_bytes()).sum()
    }
}

/// What is lit by the same maps in a picture.
#[derive(Clone, Debug)]
pub(crate) struct Part<'a> {
    /// From 1; 0 where there are no zones.
    pub number: u32,
    pub light: &'a State,
    pub focus: Sphere,
    pub hair: Vec<usize>,
    pub bodies: Vec<usize>,
    /// Whether its light from all sides is made anew in this picture.
    pub fresh: bool,
}

impl Part<'_> {
    /// Its own of all grooms or bodies.
    pub fn of<T: Copy>(list: &[usize], all: &[T]) -> Vec<T> {
        list.iter().filter_map(|i| all.get(*i).copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn zones_are_as_fine_as_they_are_seen() {
        let focus = Sphere { center: Vec3::ZERO, radius: 0.35 };
        let zone = |away: f32| {
            let camera =
                Camera::look_at(Vec3::Z * away, Vec3::ZERO, std::f32::consts::FRAC_PI_6, [1280, 720]);
            Zone::seen(focus, &camera, 0.0, vec![0], vec![])
        };
        let sizes = [1.0, 2.0, 5.0, 12.0, 20.0, 40.0].map(|away| [zone(away).resolution, zone(away).cells]);
        assert_eq!(sizes, [[1024, 24], [1024, 24], [512, 24], [256, 12], [256, 12], [256, 12]]);
        assert_eq!([1.0, 2.0, 5.0, 12.0].map(|away| zone(away).every), [1, 1, 2, 3]);
    }

    #[test]
    fn only_what_is_far_has_coarser_light() {
        let focus = Sphere { center: Vec3::ZERO, radius: 0.35 };
        let far = |away: f32, coarser: f32, finest: [u32; 2], before: Option<&Zone>| {
            let camera =
                Camera::look_at(Vec3::Z * away, Vec3::ZERO, std::f32::consts::FRAC_PI_6, [1280, 720]);
            Zone::far(focus, (&camera, coarser), finest, before, [2, 1])
        };
        let finest = [1024, 24];
        assert_eq!([0.6, 2.0, 9.2].map(|away| far(away, 0.0, finest, None)), [const { None }; 3]);
        let zone = far(15.0, 0.0, finest, None).unwrap();
        assert_eq!([zone.resolution, zone.cells, zone.every], [512, 20, 1]);
        assert_eq!((&zone.hair[..], &zone.bodies[..]), (&[0, 1][..], &[0][..]));
        // The line is at 9.4 m; who comes from afar crosses it at 8.5.
        assert_eq!(far(9.2, 0.0, finest, Some(&zone)).as_ref(), Some(&zone));
        assert_eq!(far(8.4, 0.0, finest, Some(&zone)), None);
        // Pictures that are half as fine, and light that is no finer.
        assert!(far(5.4, 1.0, finest, None).is_some());
        assert_eq!(far(15.0, 0.0, [512, 12], None).map(|zone| [zone.resolution, zone.cells]), None);
        assert_eq!(
            far(15.0, 0.0, [256, 24], None).map(|zone| [zone.resolution, zone.cells]),
            Some([256, 20])
        );
    }
}
