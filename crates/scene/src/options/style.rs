//! Growth of built-in styles, and restyling of grooms from files.

use crate::{
    companion_files::Maps,
    knobs::{self, CURLS},
    settings::{Curl, Settings},
};
use tresses::{
    FillOptions, Result,
    groom::{
        GuideCount, Restyle,
        grow::{Curls, Growth, ScalpPaint, StrandVariation},
        scalp::ScalpMap,
        styles::Style,
    },
};

const CLUMPS: [&str; 4] = ["style.clump", "style.clump_spacing", "style.clump_start", "style.clump_lock"];
const VARIATION: [&str; 3] = ["style.frizz", "style.strays", "style.flyaways"];

impl Settings {
    /// Returns the strand count if it is set.
    pub(super) fn strands(&self) -> Option<u32> {
        self.gives("style.strands").then_some(self.style.growth.strand_count).flatten()
    }

    /// Returns the guide count; `None` leaves it to the library.
    pub(super) fn guides(&self) -> Option<GuideCount> {
        match self.style.all_guides {
            true => Some(GuideCount::All),
            false => self.gives("style.guides").then_some(GuideCount::Count(self.style.guides)),
        }
    }

    /// Returns the options for filling in strands between the strands of a file.
    pub(super) fn growing(&self) -> FillOptions {
        let plain = FillOptions::default();
        FillOptions {
            strand_count: self.gives("style.grow").then_some(self.style.grow),
            parting: self.style.grow_parting,
            seed: if self.gives("style.seed") { self.style.growth.seed } else { plain.seed },
        }
    }

    /// Returns the growth options of a built-in style.
    ///
    /// # Errors
    /// Fails if curl parameters are out of range.
    pub fn growth(&self, style: &Style, maps: &Maps) -> Result<Growth> {
        let mut growth = Growth::for_style(style);
        if self.any_curls(maps) {
            let curls = self.curls(growth.curls.clone(), maps)?;
            growth = growth.with_curls(curls);
        }
        Ok(Growth { paint: self.paint(maps), ..self.over(growth) })
    }

    /// Returns the changes to a bound groom from files; `None` if there are none.
    ///
    /// # Errors
    /// Fails if curl parameters are out of range.
    pub fn restyle(&self, maps: &Maps) -> Result<Option<Restyle>> {
        let any = |paths: &[&str]| paths.iter().any(|path| self.gives(path));
        let plain = Growth::default();
        let curls = match self.any_curls(maps) {
            true => self.curls(Curls::default(), maps)?,
            false => Curls::default(),
        };
        let growth = self.over(Growth {
            clumps: if curls.any() { plain.clumps.curled(&curls) } else { plain.clumps },
            curls,
            // Strands from files already have flyaways and frizz, so add only what the settings request.
            variation: StrandVariation {
                frizz: 0.0,
                strays: 0.0,
                flyaways: 0.0,
                shorter: 0.0,
                ..plain.variation
            },
            diameter: None,
            width_variation: 0.0,
            seed: 1,
            ..plain
        });
        let restyle = Restyle {
            curls: growth.curls,
            curl_map: maps.paint.curl.clone(),
            clumps: any(&CLUMPS).then_some(growth.clumps),
            variation: any(&VARIATION).then_some(growth.variation),
            diameter: growth.diameter,
            width_variation: growth.width_variation,
            tip_width: any(&["style.tip_width"]).then_some(growth.tip_width),
            seed: growth.seed,
        };
        Ok(restyle.any().then_some(restyle))
    }

    /// Returns the painted maps, with the length map multiplied by the length setting.
    pub(super) fn paint(&self, maps: &Maps) -> ScalpPaint {
        let mut paint = maps.paint.clone();
        if self.style.length < 1.0 {
            let length = paint.length.take().unwrap_or_else(|| ScalpMap::from_fn(1, |_| 1.0));
            paint.length = Some(length.map(|length| length * self.style.length));
        }
        paint
    }

    /// Returns `growth` with all explicit settings applied.
    fn over(&self, growth: Growth) -> Growth {
        let mut onto = self.clone();
        onto.style.growth = growth;
        knobs::section("style").for_each(|knob| knob.copy_value(&mut onto, self));
        onto.style.growth
    }

    fn any_curls(&self, maps: &Maps) -> bool {
        maps.curl.is_some() || self.gives("style.curl") || CURLS.iter().any(|path| self.gives(path))
    }

    fn curls(&self, base: Curls, maps: &Maps) -> Result<Curls> {
        // A wavelength without a radius still implies curls.
        let base = match self.gives("style.curl") {
            true => self.style.curl.curls(),
            false if base.any() => base,
            false => Curls::ringlets(),
        };
        let mut curls = self.over(Growth { curls: base, ..Growth::default() }).curls;
        curls.curve = maps.curl.clone();
        if let Some(curve) = &mut curls.curve {
            if self.style.curl_stretch {
                curve.stretched = true;
            } else if !self.gives("style.curl_wavelength") {
                curls.wavelength = curve.length_for(curls.radius).clamp(1e-3, 1.0);
            }
        }
        curls.check()?;
        Ok(curls)
    }

    pub(super) fn resolve_style(&self, style: Option<&Style>, into: &mut Self) {
        let maps = Maps::default();
        // Parameters that only the file defines.
        let mut unknown = Vec::new();
        let growth = match style {
            Some(style) => {
                let Ok(mut growth) = self.growth(style, &maps) else { return };
                if !self.gives("style.guides") {
                    into.style.guides = style.recipe().guides;
                }
                growth.diameter = Some(growth.diameter_for(growth.strand_count.unwrap_or_default() as usize));
                growth
            }
            None => {
                let Ok(restyle) = self.restyle(&maps) else { return };
                let restyle = restyle.unwrap_or_else(|| Restyle { seed: 1, ..Restyle::default() });
                unknown.extend([
                    "style.strands",
                    "style.grow",
                    "style.guides",
                    "style.width",
                    "style.tip_width",
                ]);
                unknown.extend(restyle.clumps.is_none().then_some(CLUMPS).into_iter().flatten());
                let plain = Growth::default();
                self.over(Growth {
                    curls: restyle.curls,
                    clumps: restyle.clumps.unwrap_or(plain.clumps),
                    // Strands from files already have flyaways and frizz; add none.
                    variation: StrandVariation { frizz: 0.0, strays: 0.0, flyaways: 0.0, ..plain.variation },
                    width_variation: restyle.width_variation,
                    seed: restyle.seed,
                    ..plain
                })
            }
        };
        if !self.gives("style.curl") {
            into.style.curl = if growth.curls.any() { Curl::Ringlets } else { Curl::None };
        }
        into.style.growth = growth;
        let known = knobs::section("style").map(|knob| knob.path).filter(|path| !unknown.contains(path));
        into.take_as_given(known);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Vec2;

    #[test]
    fn length_setting_multiplies_length_map() {
        let uncut = Settings::default().growth(&Style::default(), &Maps::default()).unwrap();
        assert!(uncut.paint.length.is_none());
        let mut settings = Settings::default();
        settings.set("style.length", 0.4).unwrap();
        let length = |map: Option<ScalpMap>| {
            let paint = ScalpPaint { length: map, ..ScalpPaint::default() };
            let maps = Maps { paint, ..Maps::default() };
            let cut = settings.growth(&Style::default(), &maps).unwrap().paint;
            assert_eq!(cut, settings.styling(None, &maps).unwrap().paint, "files are cut likewise");
            cut.length.unwrap().sample(Vec2::splat(0.5))
        };
        assert!((length(None) - 0.4).abs() < 1e-6);
        assert!((length(Some(ScalpMap::from_fn(4, |_| 0.5))) - 0.2).abs() < 1e-6);
    }
}
