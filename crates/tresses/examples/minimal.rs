//! A window that shows a turning head with hair: the built-in character, or `cargo run --example minimal -- groom.abc
//! head.obj`. In a browser it is a page.

use std::{cell::RefCell, rc::Rc, sync::Arc};
use tresses::wgpu::{self, CurrentSurfaceTexture};
use tresses::{
    Camera, Character, Gpu, Pose, Result,
    glam::{Quat, Vec3},
};
use tresses::{Picture, View, ViewOptions};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};
use winit::{application::ApplicationHandler, event::WindowEvent};

struct Show {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    gpu: Gpu,
    view: View,
    ann: Character,
}

impl Show {
    async fn new(window: Arc<Window>) -> Result<Self> {
        let instance = Gpu::instance();
        let surface = instance.create_surface(window.clone()).expect("the window has a surface");
        let gpu = Gpu::showing(&instance, Some(&surface)).await?;
        let (size, format) = configure(&surface, &gpu, &window);
        let view = View::new(&gpu.context, &ViewOptions::for_target(format), size, 1)?;
        let files: Vec<_> = std::env::args().skip(1).collect();
        let ann = match &files[..] {
            [] => Character::built_in(&gpu.context, "long").await?,
            files => Character::load(&gpu.context, files).await?,
        };
        window.request_redraw();
        Ok(Self { window, surface, gpu, view, ann })
    }

    fn frame(&mut self) -> Result<()> {
        self.window.request_redraw();
        let target = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(target) | CurrentSurfaceTexture::Suboptimal(target) => target,
            _ => return Ok(()),
        };
        // Turn the head on its neck.
        let rotation = Quat::from_rotation_y(0.7 * (2.0 * self.ann.time() as f32).sin());
        self.ann.gesture.head = Pose::about(self.ann.neck(), rotation);
        let camera = Camera::framing(self.ann.subject(), Vec3::Z, 0.5, self.view.targets().size);
        // Simulate 1/60 s of hair, then draw it.
        let tresses = &self.gpu.context;
        let mut encoder = tresses.device().create_command_encoder(&Default::default());
        let mut frame = tresses.frame(&mut encoder);
        frame.advance(&mut [&mut self.ann], 1.0 / 60.0)?;
        let output = target.texture.create_view(&Default::default());
        frame.draw(&mut self.view, &[&self.ann], &Picture { camera, ..Default::default() }, &output)?;
        tresses.queue().submit([encoder.finish()]);
        tresses.queue().present(target);
        Ok(())
    }
}

/// Resizes the surface to the window. Returns its size and format.
fn configure(surface: &wgpu::Surface<'_>, gpu: &Gpu, window: &Window) -> ([u32; 2], wgpu::TextureFormat) {
    let [width, height] = <[u32; 2]>::from(window.inner_size()).map(|length| length.max(1));
    let config = surface.get_default_config(&gpu.adapter, width, height).expect("a supported surface");
    surface.configure(gpu.context.device(), &config);
    ([width, height], config.format)
}

#[derive(Default)]
struct App(Rc<RefCell<Option<Show>>>);

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let attributes = Window::default_attributes().with_title("Tresses");
        #[cfg(target_arch = "wasm32")]
        let attributes = winit::platform::web::WindowAttributesExtWebSys::with_append(attributes, true);
        let window = Arc::new(events.create_window(attributes).expect("a window"));
        let show = self.0.clone();
        let open = async move { show.replace(Some(Show::new(window).await.expect("a GPU"))) };
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(async { drop(open.await) });
        #[cfg(not(target_arch = "wasm32"))]
        pollster::block_on(open);
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(show) = &mut *self.0.borrow_mut() else { return };
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(_) => {
                let (size, _) = configure(&show.surface, &show.gpu, &show.window);
                show.view.resize(size, 1).expect("targets of this size");
            }
            WindowEvent::RedrawRequested => show.frame().expect("a frame"),
            _ => {}
        }
    }
}

fn main() {
    #[cfg(target_arch = "wasm32")]
    console_error_panic_hook::set_once();
    let events = EventLoop::new().expect("an event loop");
    #[cfg(target_arch = "wasm32")]
    winit::platform::web::EventLoopExtWebSys::spawn_app(events, App::default());
    #[cfg(not(target_arch = "wasm32"))]
    events.run_app(&mut App::default()).expect("a display");
}
