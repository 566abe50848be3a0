//! A window with hair on a head that turns: `cargo run --example minimal`. In a browser it is a page.

use std::sync::Arc;
use tresses::wgpu::{self, CurrentSurfaceTexture as Shown};
use tresses::{Camera, Hair, Pipelines, Pose, Result, View, body::Body, collide::ColliderPoses, frame::*};
use tresses::{drape, glam::*, gpu::Gpu, groom::styles, light::Sphere, simulate::SimulationParams, view::*};
use winit::{application::ApplicationHandler, event::WindowEvent, event_loop::*, window::*};

struct Show {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    pipelines: Pipelines,
    view: View,
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
        let pipelines = Pipelines::new(device);
        let (size, output) = fit(&surface, &gpu, &window);
        let view = View::new(device, &pipelines, &ViewOptions { output, ..Default::default() }, size, 1)?;
        let style = styles::Style::Long(Default::default());
        let made = drape::character(device, queue, &pipelines.simulate, &style, Some(4000)).await?;
        let hair = Hair::new(device, queue, &pipelines, &made.groom, &Default::default(), Some(&made.field))?;
        let body = Body::new(device, &made.mesh);
        window.request_redraw();
        Ok(Self { window, surface, gpu, pipelines, view, hair, body, neck: made.neck, time: 0.0 })
    }

    fn frame(&mut self) -> Result<()> {
        self.window.request_redraw();
        let shown = self.surface.get_current_texture();
        let (Shown::Success(shown) | Shown::Suboptimal(shown)) = shown else { return Ok(()) };
        self.time += 1.0 / 60.0;
        let head = Pose::about(self.neck, Quat::from_rotation_y(0.7 * (2.0 * self.time).sin()));
        let size = self.view.targets().size;
        let camera = Camera::look_at(vec3(0.2, 0.1, 0.9), vec3(0.0, 0.04, 0.0), 0.5, size);
        let focus = Sphere::around(Vec3::splat(-0.25), Vec3::splat(0.25));
        let picture = Picture { camera, focus, ..Default::default() };
        self.body.pose = head;
        let (colliders, simulation) = (&ColliderPoses::default(), &SimulationParams::default());
        let (Gpu { device, queue, .. }, pipelines) = (&self.gpu, &self.pipelines);
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut recorder = Recorder { pipelines, device, queue, encoder: &mut encoder, timings: None };
        let frame = Frame { dt: 1.0 / 60.0, head, colliders, simulation, ..Default::default() };
        let output = &shown.texture.create_view(&Default::default());
        let sight = Sight { output: Some(output), ..Sight::new(&self.view, &picture) };
        recorder.record(&mut [(&mut self.hair, frame)], &[&self.body], vec![sight])?;
        queue.submit([encoder.finish()]);
        queue.present(shown);
        Ok(())
    }
}

fn fit(surface: &wgpu::Surface<'_>, gpu: &Gpu, window: &Window) -> ([u32; 2], wgpu::TextureFormat) {
    let [width, height] = <[u32; 2]>::from(window.inner_size()).map(|length| length.max(1));
    let config = surface.get_default_config(&gpu.adapter, width, height).expect("it fits the surface");
    surface.configure(&gpu.device, &config);
    ([width, height], config.format)
}

struct App(EventLoopProxy<Result<Show>>, Option<Show>);

impl ApplicationHandler<Result<Show>> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let look = Window::default_attributes().with_title("Tresses");
        #[cfg(target_arch = "wasm32")]
        let look = winit::platform::web::WindowAttributesExtWebSys::with_append(look, true);
        let (window, proxy) = (events.create_window(look).expect("a window"), self.0.clone());
        let open = async move { drop(proxy.send_event(Show::new(Arc::new(window)).await)) };
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(open);
        #[cfg(not(target_arch = "wasm32"))]
        pollster::block_on(open);
    }

    fn user_event(&mut self, _: &ActiveEventLoop, show: Result<Show>) {
        self.1 = Some(show.unwrap_or_else(|error| panic!("{error}")));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(show) = &mut self.1 else { return };
        let done = match event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::Resized(_) => {
                let (size, _) = fit(&show.surface, &show.gpu, &show.window);
                show.view.resize(&show.gpu.device, size, 1)
            }
            WindowEvent::RedrawRequested => show.frame(),
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
