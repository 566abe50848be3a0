//! Debug views of a whole frame: they do not affect other images, they differ, and the terms of the shading add up.

use crate::common;

use tresses::{
    Body, Camera, Context, HairOptions, Picture, SimulationParams, View, ViewOptions, Wind,
    glam::Vec3,
    groom::{BindOptions, bind},
    light::{Lights, Sphere},
    low_level::{
        DebugDisplay, DebugView, DebugViews, Drawing, Hair, HairFrame, Term, ViewContent,
        readback::blocking as readback, unpack_radiance,
    },
    renderer::{Renderer, ShadingModel},
};

/// A head of hair in wind, and all that draws it.
struct Setup {
    context: &'static Context,
    views: DebugViews,
    hair: Hair,
    body: Body,
    view: View,
    scene: Picture,
}

impl Setup {
    fn new() -> Option<Self> {
        let context = common::context()?;
        let groom = bind(&common::hanging(400, 16, 0.15), &BindOptions::default()).unwrap();
        let field = common::ball(0.085, 32);
        let options = HairOptions::default();
        let mut hair = common::hair(context, &groom, &options, Some(&field)).unwrap();
        let mut views = DebugViews::new(context, tresses::low_level::PICTURE_FORMAT).unwrap();
        views.set_head(Some(&field));
        let simulation = SimulationParams { wind: Wind::new(Vec3::X * 6.0), ..Default::default() };
        for _ in 0..6 {
            let frame = HairFrame { dt: 1.0 / 30.0, simulation: &simulation, ..Default::default() };
            common::advance(&mut hair, &frame);
        }
        let camera = Camera::look_at(Vec3::new(0.1, 0.05, 0.8), Vec3::ZERO, 0.45, [120, 96]);
        let focus = Sphere { center: Vec3::ZERO, radius: 0.3 };
        let scene = Picture { camera, focus, lights: Lights::around(0.3), ..Default::default() };
        let body = Body::new(context, &common::cube(0.05));
        let options =
            ViewOptions { shadow_resolution: 128, renderer: Renderer::masks(4), ..common::coarse() };
        let view = View::new(context, &options, [120, 96], 1).unwrap();
        Some(Self { views, hair, body, view, scene, context })
    }

    /// Renders a debug view, or hair without one. Returns the image and the colors of the strands.
    fn picture(&mut self, view: Option<DebugView>) -> (Vec<u8>, Vec<Vec3>) {
        let shown = view.map(DebugDisplay::new);
        let shows =
            shown.as_ref().map_or(ViewContent::Hair, |shown| ViewContent::Inside(&mut self.views, shown));
        let sight = Drawing { shows, ..Drawing::new(&self.scene) };
        common::submit(|recorder| recorder.draw(&[&self.hair], &[&self.body], &self.view, sight));
        let picture = pollster::block_on(self.view.targets().read()).unwrap();
        let shaded = self.view.shaded(&self.hair.set).unwrap();
        let shaded: Vec<u32> = readback::buffer(self.context, &shaded).unwrap();
        (picture, shaded.into_iter().map(unpack_radiance).collect())
    }

    /// Draws the last image with twice the pixels along each axis. Lights the hair again if `anew`, or reuses its
    /// light.
    fn finer(&mut self, anew: bool) -> Vec<u8> {
        self.view.resize([120, 96], 2).unwrap();
        let shows = if anew { ViewContent::Hair } else { ViewContent::Again };
        let sight = Drawing { shows, ..Drawing::new(&self.scene) };
        common::submit(|recorder| recorder.draw(&[&self.hair], &[&self.body], &self.view, sight));
        let picture = pollster::block_on(self.view.targets().read()).unwrap();
        self.view.resize([120, 96], 1).unwrap();
        picture
    }

    fn term(&mut self, term: Term) -> Vec<Vec3> {
        let view = DebugView::ALL.into_iter().find(|view| view.term() == Some(term)).unwrap();
        self.picture(Some(view)).1
    }
}

/// Returns the largest difference between two lists, relative to the largest value of the second.
fn off(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    let most = b.iter().fold(0.0f32, |most, c| most.max(c.abs().max_element()));
    let error = a.iter().zip(b).fold(0.0f32, |error, (a, b)| error.max((*a - *b).abs().max_element()));
    assert!(most > 0.05, "there is light: {most}");
    error / most
}

fn sum(lists: &[&[Vec3]]) -> Vec<Vec3> {
    (0..lists[0].len()).map(|i| lists.iter().map(|list| list[i]).sum()).collect()
}

#[test]
fn shading_terms_add_up() {
    let Some(mut stage) = Setup::new() else { return };
    for model in [ShadingModel::Fiber, ShadingModel::KajiyaKay] {
        let renderer = Renderer::masks(4).with_shading(model);
        let options = ViewOptions { renderer, ..*stage.view.options() };
        stage.view.set_options(&options).unwrap();
        let all = stage.picture(None).1;
        let terms = Term::ALL.map(|term| stage.term(term));
        let [reflection, transmission, inner, multiple, sky, direct, shadow] =
            terms.each_ref().map(Vec::as_slice);
        let whole = off(&sum(&[direct, sky]), &all);
        let parts = off(&sum(&[reflection, transmission, inner, multiple]), direct);
        println!("{model:?}: direct and sky off by {whole:.1e}, lobes by {parts:.1e}");
        assert!(whole < 4e-3 && parts < 4e-3, "{model:?}: {whole} {parts}");
        // A missing term is detected, whichever it is.
        for missing in 0..4 {
            let rest: Vec<_> = (0..4).filter(|i| *i != missing).map(|i| terms[i].as_slice()).collect();
            let error = off(&sum(&rest), direct);
            assert!(error > 1e-2, "{model:?} without term {missing}: {error}");
        }
        assert!(off(direct, &all) > 1e-2);
        assert!(shadow.iter().any(|c| *c != shadow[0]));
    }
}

#[test]
fn debug_views_differ_and_leave_no_trace() {
    let Some(mut stage) = Setup::new() else { return };
    let plain = stage.picture(None).0;
    let mut seen = vec![("nothing", plain.clone())];
    for view in DebugView::ALL {
        let (picture, _) = stage.picture(Some(view));
        for (name, other) in &seen {
            assert!(picture != *other, "{} looks like {name}", view.name());
        }
        seen.push((view.name(), picture));
    }
    assert_eq!(stage.picture(None).0, plain, "a picture after all views");
    for view in [DebugView::Guides, DebugView::Locks, DebugView::Distance, DebugView::Overdraw] {
        let again = stage.picture(Some(view)).0;
        let before = &seen.iter().find(|(name, _)| *name == view.name()).unwrap().1;
        assert!(again == *before, "{} twice", view.name());
    }
}

#[test]
fn lit_hair_can_be_redrawn_at_a_higher_resolution() {
    let Some(mut stage) = Setup::new() else { return };
    let coarse = stage.picture(None).0;
    let again = stage.finer(false);
    assert!(again != coarse, "more samples are seen");
    assert!(again == stage.finer(true), "it is the picture that is lit anew");
    // After a change of the lights, the reused light differs.
    stage.scene.lights = Lights::around(1.5);
    assert!(stage.finer(false) != stage.finer(true), "the comparer sees hair in another light");
}
