//! A window with hair that follows a turning head; the same program runs in a browser (`make web`).
//!
//! `cargo run --example minimal`

use std::sync::Arc;
use tresses::{
    Hair, HairRenderer, Pose, Result,
    collide::ColliderPoses,
    draw::{Body, DrawOptions, Scene, Targets, View},
    frame::{Frame, Recorder},
    glam::{Quat, Vec3},
    gpu::Gpu,
    groom::styles::{self, Style},
    light::Sphere,
    simulate::SimulationParams,
    wgpu::{self, CurrentSurfaceTexture as Shown},
};
use winit::{application::ApplicationHandler, event::WindowEvent, event_loop::*, window::*};

struct Show {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    config: wgpu::SurfaceConfiguration,
    renderer: HairRenderer,
    targets: Targets,
    hair: Hair,
    body: Body,
    neck: Vec3,
    time: f32,
}

impl Show {
    async fn new(window: Arc<Window>) -> Result<Self> {
        let instance = Gpu::instance();
        let surface = instance.create_surface(window.clone()).expect("a window can be drawn to");
        let gpu = Gpu::showing(&instance, Some(&surface)).await?;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let size = window.inner_size();
        let (width, height) = (size.width.max(1), size.height.max(1));
        let config = surface.get_default_config(&gpu.adapter, width, height).expect("it fits the surface");
        surface.configure(device, &config);
        // Once per device: the pipelines. Once per groom: its buffers.
        let renderer =
            HairRenderer::new(device, &DrawOptions { output: config.format, ..Default::default() });
        let style = Style::Long(Default::default());
        let made = styles::character(device, queue, &renderer.simulate, &style, Some(4000)).await?;
        let hair = Hair::new(device, queue, &renderer, &made.groom, &Default::default(), Some(&made.field))?;
        let body = Body::new(device, &renderer.draw, &made.mesh);
        let targets = Targets::new(device, width, height, 4, 1)?;
        window.request_redraw();
        Ok(Self { window, surface, gpu, config, renderer, targets, hair, body, neck: made.neck, time: 0.0 })
    }

    fn frame(&mut self) -> Result<()> {
        let (device, queue, size) = (&self.gpu.device, &self.gpu.queue, self.targets.size);
        let (Shown::Success(shown) | Shown::Suboptimal(shown)) = self.surface.get_current_texture() else {
            return Ok(());
        };
        self.time += 1.0 / 60.0;
        let head = Pose::about(self.neck, Quat::from_rotation_y(0.7 * (2.0 * self.time).sin()));
        let view = View::look_at(Vec3::new(0.2, 0.1, 0.9), Vec3::new(0.0, 0.04, 0.0), 0.5, size);
        let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
        let scene = Scene { view, focus, pose: head, ..Default::default() };
        let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut recorder =
            Recorder { renderer: &self.renderer, device, queue, encoder: &mut encoder, timings: None };
        recorder.advance(&mut self.hair, &Frame { dt: 1.0 / 60.0, head, colliders, simulation })?;
        let picture = shown.texture.create_view(&Default::default());
        recorder.draw(&self.hair, Some(&self.body), &scene, &self.targets, &picture);
        queue.submit([encoder.finish()]);
        queue.present(shown);
        self.window.request_redraw();
        Ok(())
    }

    fn resize(&mut self, width: u32, height: u32) -> Result<()> {
        (self.config.width, self.config.height) = (width.max(1), height.max(1));
        self.surface.configure(&self.gpu.device, &self.config);
        self.targets = Targets::new(&self.gpu.device, self.config.width, self.config.height, 4, 1)?;
        Ok(())
    }
}

struct App(EventLoopProxy<Result<Show>>, Option<Show>);

impl ApplicationHandler<Result<Show>> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let look = Window::default_attributes().with_title("Tresses");
        #[cfg(target_arch = "wasm32")]
        let look = winit::platform::web::WindowAttributesExtWebSys::with_append(look, true);
        let window = Arc::new(events.create_window(look).expect("a window"));
        let proxy = self.0.clone();
        let open = async move { drop(proxy.send_event(Show::new(window).await)) };
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(open);
        #[cfg(not(target_arch = "wasm32"))]
        pollster::block_on(open);
    }

    fn user_event(&mut self, _: &ActiveEventLoop, show: Result<Show>) {
        self.1 = Some(show.unwrap_or_else(|error| panic!("{error}")));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let done = match (event, &mut self.1) {
            (WindowEvent::CloseRequested, _) => return events.exit(),
            (WindowEvent::Resized(size), Some(show)) => show.resize(size.width, size.height),
            (WindowEvent::RedrawRequested, Some(show)) => show.frame(),
            _ => Ok(()),
        };
        done.unwrap_or_else(|error| panic!("{error}"));
    }
}

fn main() {
    #[cfg(target_arch = "wasm32")]
    console_error_panic_hook::set_once();
    let events = EventLoop::with_user_event().build().expect("an event loop");
    let app = App(events.create_proxy(), None);
    #[cfg(target_arch = "wasm32")]
    winit::platform::web::EventLoopExtWebSys::spawn_app(events, app);
    #[cfg(not(target_arch = "wasm32"))]
    events.run_app(&mut { app }).expect("a display");
}
