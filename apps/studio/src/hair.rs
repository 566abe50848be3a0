//! The hair that is shown, with its files, and the transitions between hairs.

use crate::{
    app::{Shown, Studio},
    files::Files,
    job::{Job, Order, Source},
};
use eframe::egui;
use tresses::groom::styles::Style;
use tresses_scene::{Companion, Companions, Settings, Shelf, preset, settings::HairColor};

/// The key of the colours painted on the scalp.
const COLORS: &str = "color_map";

/// Which hair, and the maps, obstacles and surroundings beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hair {
    /// Groom and head.
    pub source: Source,
    /// What stands beside them.
    pub companions: Companions,
}

impl Default for Hair {
    fn default() -> Self {
        Self { source: Source::Style(Style::default().name().into()), companions: Companions::default() }
    }
}

impl Hair {
    /// Whether `other` is the same hair in another light.
    pub fn is_lit_otherwise(&self, other: &Self) -> bool {
        self.source == other.source && !self.companions.differ_in_hair(&other.companions)
    }

    /// The settings under which one sees it: colours that were `painted` for it hide behind no other.
    fn seen_with(&self, settings: &Settings, painted: Option<&str>) -> Settings {
        let mut settings = settings.clone();
        if painted.is_some() && painted == self.companions.names().color_map.as_deref() {
            settings.shading.color = HairColor::File;
        }
        settings
    }

    /// What leads from `before` to this, a word or two.
    fn step_from(&self, before: &Self) -> String {
        if self.source != before.source {
            return format!("Hair: {}", self.source.name());
        }
        let name = |hair: &Self, companion: &Companion| hair.companions.name(companion);
        let mut turned =
            tresses_scene::companions::COMPANIONS.iter().filter(|c| name(self, c) != name(before, c));
        match (turned.next(), turned.next()) {
            (Some(one), None) => one.title.into(),
            _ => "Files".into(),
        }
    }

    /// As a preset names it; bytes of a browser have no place that could be named.
    pub fn named(&self) -> preset::Source {
        let mut source = self.companions.names().clone();
        match &self.source {
            Source::Style(name) => source.style = Some(name.clone()),
            Source::Files { files: Files::Disk { grooms, heads }, options } => {
                (source.grooms, source.heads) = (grooms.clone(), heads.clone());
                source.orientation = (**options).clone();
            }
            Source::Files { files: Files::Given(_), .. } => {}
        }
        source
    }
}

impl Studio {
    /// The hair that is shown, or will be when the work that is under way is done.
    pub(crate) fn wanted(&self) -> Hair {
        let coming = self.job.as_ref().map(|job| &job.hair);
        coming.or(self.shown.as_ref().map(|shown| &shown.hair)).cloned().unwrap_or_default()
    }

    /// Starts to make `source` ready, read anew; what is shown stays until then.
    pub(crate) fn open(&mut self, context: &egui::Context, source: Source) {
        let companions = self.wanted().companions;
        self.make(context, Hair { source, companions }, true);
    }

    /// Puts a file in its place beside the hair, or takes it away.
    pub(crate) fn put(
        &mut self,
        context: &egui::Context,
        companion: &Companion,
        name: Option<String>,
        files: &Shelf,
    ) {
        let Hair { source, companions } = self.wanted();
        if companion.key == COLORS {
            self.painted.clone_from(&name);
        }
        let hair = Hair { source, companions: companions.with(companion, name, files) };
        if companion.kind.is_of_hair() { self.make(context, hair, false) } else { self.light(context, hair) }
    }

    /// Goes to `hair`, if it is not there already.
    pub(crate) fn go_to(&mut self, context: &egui::Context, hair: Hair) {
        self.painted = None;
        if self.job.as_ref().is_some_and(|job| job.hair == hair) {
            return;
        }
        if self.shown.as_ref().is_some_and(|shown| shown.hair == hair) {
            // Whatever was on its way is wanted no longer, but for what settings have asked for.
            self.regrow |= self.job.take().is_some();
            return;
        }
        self.light(context, hair);
    }

    /// Starts to make `hair` ready: only its light where nothing else is another.
    fn light(&mut self, context: &egui::Context, hair: Hair) {
        let same = self.shown.as_ref().is_some_and(|shown| shown.hair.is_lit_otherwise(&hair));
        if same && self.job.as_ref().is_none_or(Job::is_light) {
            (self.error, self.said) = (None, None);
            self.job = Some(Job::light(context, hair));
        } else {
            self.make(context, hair, false);
        }
    }

    /// Starts to make `hair` ready; `fresh`: its files are read although they are those that are shown.
    pub(crate) fn make(&mut self, context: &egui::Context, hair: Hair, fresh: bool) {
        let shown = self.shown.as_ref().filter(|shown| !fresh && shown.hair.source == hair.source);
        let base = shown.map(|shown| shown.base.clone());
        // Light stays if it is the same file.
        let same_light = |shown: &&Shown| {
            let light = |hair: &Hair| hair.companions.names().environment.clone();
            light(&shown.hair) == light(&hair) && !shown.hair.companions.files_differ(&hair.companions)
        };
        let surroundings = shown.filter(same_light).and_then(|shown| shown.surroundings.clone());
        let pipelines = self.pipelines.clone();
        (self.regrow, self.rebuild) = (false, false);
        let settings = self.settings.now().clone();
        let keep = base.is_some();
        self.start(context, Order { hair, base, surroundings, pipelines, settings, keep });
    }

    /// `hair` is shown from here on, which is a step that can be undone. Colours that were painted for it are
    /// seen at once, whatever colour it had: that belongs to the same step.
    pub(crate) fn arrived(&mut self, context: &egui::Context, hair: &Hair) {
        let painted = self.painted.take();
        if self.shown.is_none() {
            // The first is where one begins.
            self.settings.set_hair(hair.clone());
            return;
        }
        let label = hair.step_from(self.settings.hair());
        let before = self.settings.now().clone();
        self.settings.change_both(hair.seen_with(&before, painted.as_deref()), hair.clone(), &label);
        self.follow(context, &before);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses_scene::companions::companion;

    #[test]
    fn what_changed_is_named() {
        let bob = Hair { source: Source::Style("bob".into()), ..Hair::default() };
        let with = |hair: &Hair, key: &str| {
            let name = Some("front".into());
            let companions = hair.companions.with(companion(key).unwrap(), name, &Shelf::default());
            Hair { companions, ..hair.clone() }
        };
        let (sparse, lit) = (with(&bob, "density_map"), with(&bob, "environment"));
        assert_eq!(bob.step_from(&Hair::default()), "Hair: bob");
        assert_eq!((sparse.step_from(&bob), lit.step_from(&bob)), ("Density".into(), "Surroundings".into()));
        assert_eq!(lit.step_from(&sparse), "Files");
        assert!(lit.is_lit_otherwise(&bob) && !sparse.is_lit_otherwise(&bob));
        assert!(!bob.is_lit_otherwise(&Hair::default()));
        assert_eq!(sparse.named().style.as_deref(), Some("bob"));
        assert_eq!(sparse.named().density_map.as_deref(), Some("front"));
    }

    #[test]
    fn painted_colours_are_seen() {
        let name = || Some("colours.png".to_owned());
        let companions = Companions::default().with(companion(COLORS).unwrap(), name(), &Shelf::default());
        let hair = Hair { companions, ..Hair::default() };
        let mut brown = Settings::default();
        brown.shading.color = HairColor::Brown;
        let color =
            |hair: &Hair, painted: Option<String>| hair.seen_with(&brown, painted.as_deref()).shading.color;
        assert_eq!(color(&hair, name()), HairColor::File);
        // Those of a preset that says brown, and of hair that came in their place, are not.
        assert_eq!(color(&hair, None), HairColor::Brown);
        assert_eq!(color(&Hair::default(), name()), HairColor::Brown);
    }
}
