//! How strands are grown on a built-in style, or restyled on a groom from files.

use tresses::{
    Result,
    groom::{
        GuideCount, Restyle,
        grow::{Clumps, CurlCurve, Curls, Growth, Paint, ScalpMap, Unrest},
        styles::Style,
    },
    lod::LodLevel,
};

/// The curls that others are varied from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curl {
    /// Straight.
    None,
    /// [`Curls::waves`].
    Waves,
    /// [`Curls::ringlets`].
    Ringlets,
    /// [`Curls::coils`].
    Coils,
}

impl Curl {
    fn curls(self) -> Curls {
        match self {
            Self::None => Curls::default(),
            Self::Waves => Curls::waves(),
            Self::Ringlets => Curls::ringlets(),
            Self::Coils => Curls::coils(),
        }
    }
}

/// What comes from files beside the groom: maps on the scalp, and a drawn curl.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Maps that act before strands are made; the map of curls acts on imported grooms too.
    pub paint: Paint,
    /// Factors of the guides' stiffness.
    pub stiffness: Option<ScalpMap>,
    /// A drawn curl.
    pub curl: Option<CurlCurve>,
    /// Painted levels of detail.
    pub levels: Vec<LodLevel>,
}

/// Strands. What is `None` stays as the style or the file has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StyleSettings {
    /// How many strands are drawn, at most.
    pub strands: Option<u32>,
    /// How many are simulated, the others following them.
    pub guides: Option<u32>,
    /// Whether every strand is simulated, whatever `guides` says.
    pub all_guides: bool,
    /// The curls that the following vary.
    pub curl: Option<Curl>,
    /// Distance of curls from the path, metres.
    pub curl_radius: Option<f32>,
    /// Way along the path for one turn, metres.
    pub curl_wavelength: Option<f32>,
    /// 0 for a round helix, 1 for a wave in one plane.
    pub curl_flatness: Option<f32>,
    /// Fraction of the length at which curls begin.
    pub curl_start: Option<f32>,
    /// Radius at the tip against that at the root.
    pub curl_tip: Option<f32>,
    /// How far curls differ and wander, 0 to 1.
    pub curl_irregularity: Option<f32>,
    /// How far the strands of a lock turn together, 0 to 1.
    pub curl_coherence: Option<f32>,
    /// How far a lock turns with the locks around it, 0 to 1.
    pub curl_neighbours: Option<f32>,
    /// How much of the length that curls take is taken from the hairstyle, 0 to 1.
    pub curl_shrink: Option<f32>,
    /// Whether a drawn curl is stretched over the whole strand instead of repeated.
    pub curl_stretch: bool,
    /// How far strands run together at the tip, 0 to 1.
    pub clump: Option<f32>,
    /// Distance between clump centres on the scalp, metres.
    pub clump_spacing: Option<f32>,
    /// Fraction of the length at which strands begin to run together; below 0 where they grow together.
    pub clump_start: Option<f32>,
    /// How far strands are drawn to their heaviest guide at the tip, 0 to 1.
    pub clump_lock: Option<f32>,
    /// Amplitude of the fine waves that every strand has, metres.
    pub frizz: Option<f32>,
    /// Share of strands that stray a little.
    pub strays: Option<f32>,
    /// How far, metres.
    pub stray_reach: Option<f32>,
    /// Share of strands that stray a lot.
    pub flyaways: Option<f32>,
    /// How far, metres.
    pub flyaway_reach: Option<f32>,
    /// Usual diameter of a strand, metres; on a built-in style `None` is what covers the head.
    pub width: Option<f32>,
    /// Standard deviation of the diameter as a fraction.
    pub width_variation: Option<f32>,
    /// Width at the tip as a fraction.
    pub tip_width: Option<f32>,
    /// What every random choice of the strands follows from.
    pub seed: Option<u32>,
}

impl StyleSettings {
    /// How many strands are simulated; `None` for what is usual.
    pub fn guides(&self) -> Option<GuideCount> {
        if self.all_guides { Some(GuideCount::All) } else { self.guides.map(GuideCount::Count) }
    }

    /// The growth of a built-in style.
    ///
    /// # Errors
    /// Curls out of range.
    pub fn growth(&self, style: &Style, maps: &Maps) -> Result<Growth> {
        let mut growth = Growth::for_style(style);
        if let Some(count) = self.strands {
            growth = growth.with_strands(count);
        }
        if self.any_curls(maps) {
            let curls = self.curls(growth.curls.clone(), maps)?;
            growth = growth.with_curls(curls);
        }
        self.gather(&mut growth.clumps);
        self.disturb(&mut growth.unrest);
        growth.diameter = self.width.or(growth.diameter);
        growth.width_variation = self.width_variation.unwrap_or(growth.width_variation);
        growth.tip_width = self.tip_width.unwrap_or(growth.tip_width);
        growth.seed = self.seed.unwrap_or(growth.seed);
        growth.paint = maps.paint.clone();
        Ok(growth)
    }

    /// What changes on a groom from files after it is bound; `None` for nothing.
    ///
    /// # Errors
    /// Curls out of range.
    pub fn restyle(&self, maps: &Maps) -> Result<Option<Restyle>> {
        let plain = Growth::default();
        let mut restyle = Restyle { seed: self.seed.unwrap_or(1), ..Restyle::default() };
        if self.any_curls(maps) {
            restyle.curls = self.curls(Curls::default(), maps)?;
        }
        let clumps = [self.clump, self.clump_spacing, self.clump_start, self.clump_lock];
        if clumps.iter().any(Option::is_some) {
            let mut clumps = match restyle.curls.any() {
                true => plain.clumps.curled(&restyle.curls),
                false => plain.clumps,
            };
            self.gather(&mut clumps);
            restyle.clumps = Some(clumps);
        }
        if self.frizz.is_some() || self.strays.is_some() || self.flyaways.is_some() {
            // Only what is asked for: the file's strands stray by themselves.
            let mut unrest = Unrest { frizz: 0.0, strays: 0.0, flyaways: 0.0, shorter: 0.0, ..plain.unrest };
            self.disturb(&mut unrest);
            restyle.unrest = Some(unrest);
        }
        restyle.diameter = self.width;
        restyle.width_variation = self.width_variation.unwrap_or(0.0);
        restyle.tip_width = self.tip_width;
        restyle.curl_map = maps.paint.curl.clone();
        Ok(restyle.any().then_some(restyle))
    }

    fn any_curls(&self, maps: &Maps) -> bool {
        let own = [
            self.curl_radius,
            self.curl_wavelength,
            self.curl_flatness,
            self.curl_start,
            self.curl_tip,
            self.curl_irregularity,
            self.curl_coherence,
            self.curl_neighbours,
            self.curl_shrink,
        ];
        self.curl.is_some() || maps.curl.is_some() || own.iter().any(Option::is_some)
    }

    fn curls(&self, base: Curls, maps: &Maps) -> Result<Curls> {
        // Whoever gives a wavelength but no radius wants curls nevertheless.
        let base = match self.curl {
            Some(curl) => curl.curls(),
            None if base.any() => base,
            None => Curls::ringlets(),
        };
        let mut curls = Curls {
            radius: self.curl_radius.unwrap_or(base.radius),
            wavelength: self.curl_wavelength.unwrap_or(base.wavelength),
            flatness: self.curl_flatness.unwrap_or(base.flatness),
            start: self.curl_start.unwrap_or(base.start),
            tip: self.curl_tip.unwrap_or(base.tip),
            irregularity: self.curl_irregularity.unwrap_or(base.irregularity),
            coherence: self.curl_coherence.unwrap_or(base.coherence),
            neighbours: self.curl_neighbours.unwrap_or(base.neighbours),
            shrink: self.curl_shrink.unwrap_or(base.shrink),
            curve: maps.curl.clone(),
        };
        if let Some(curve) = &mut curls.curve {
            if self.curl_stretch {
                curve.stretched = true;
            } else if self.curl_wavelength.is_none() {
                curls.wavelength = curve.length_for(curls.radius).clamp(1e-3, 1.0);
            }
        }
        curls.check()?;
        Ok(curls)
    }

    fn gather(&self, clumps: &mut Clumps) {
        clumps.strength = self.clump.unwrap_or(clumps.strength);
        clumps.spacing = self.clump_spacing.unwrap_or(clumps.spacing);
        clumps.start = self.clump_start.unwrap_or(clumps.start);
        clumps.lock = self.clump_lock.unwrap_or(clumps.lock);
    }

    fn disturb(&self, unrest: &mut Unrest) {
        unrest.frizz = self.frizz.unwrap_or(unrest.frizz);
        unrest.strays = self.strays.unwrap_or(unrest.strays);
        unrest.stray = self.stray_reach.unwrap_or(unrest.stray);
        unrest.flyaways = self.flyaways.unwrap_or(unrest.flyaways);
        unrest.flyaway = self.flyaway_reach.unwrap_or(unrest.flyaway);
    }

    pub(super) fn resolve(&self, style: Option<&Style>, into: &mut Self) {
        let maps = Maps::default();
        let (curls, clumps, unrest) = match style {
            Some(style) => {
                let Ok(growth) = self.growth(style, &maps) else { return };
                into.strands = growth.strand_count;
                into.guides = self.guides.or(Some(style.recipe().guides));
                into.seed = Some(growth.seed);
                let count = growth.strand_count.unwrap_or_default() as usize;
                into.width = Some(growth.diameter_for(count));
                into.width_variation = Some(growth.width_variation);
                into.tip_width = Some(growth.tip_width);
                (growth.curls, Some(growth.clumps), Some(growth.unrest))
            }
            None => {
                let Ok(restyle) = self.restyle(&maps) else { return };
                let restyle = restyle.unwrap_or_default();
                into.seed = self.seed.or(Some(1));
                into.width_variation = Some(restyle.width_variation);
                (restyle.curls, restyle.clumps, restyle.unrest)
            }
        };
        into.curl = self.curl.or(Some(if curls.any() { Curl::Ringlets } else { Curl::None }));
        into.curl_radius = Some(curls.radius);
        into.curl_wavelength = Some(curls.wavelength);
        into.curl_flatness = Some(curls.flatness);
        into.curl_start = Some(curls.start);
        into.curl_tip = Some(curls.tip);
        into.curl_irregularity = Some(curls.irregularity);
        into.curl_coherence = Some(curls.coherence);
        into.curl_neighbours = Some(curls.neighbours);
        into.curl_shrink = Some(curls.shrink);
        if let Some(clumps) = clumps {
            into.clump = Some(clumps.strength);
            into.clump_spacing = Some(clumps.spacing);
            into.clump_start = Some(clumps.start);
            into.clump_lock = Some(clumps.lock);
        }
        // A file's strands stray by themselves; nothing is added.
        into.frizz = Some(unrest.map_or(0.0, |unrest| unrest.frizz));
        into.strays = Some(unrest.map_or(0.0, |unrest| unrest.strays));
        into.flyaways = Some(unrest.map_or(0.0, |unrest| unrest.flyaways));
        let usual = unrest.unwrap_or(Growth::default().unrest);
        into.stray_reach = Some(usual.stray);
        into.flyaway_reach = Some(usual.flyaway);
    }
}
