//! The studio in somebody else's page: without panels, told what to do by name, and telling what has come of it.

use crate::{messages::Messages, renderer::Renderer, state::State};
use anyhow::{Context, Result, bail};
use tresses_scene::{
    Value,
    camera::Angle,
    knobs::{self, Knob},
    motion::NAMES,
};

/// Something that a host wants.
#[derive(Clone, Debug)]
pub enum Command {
    /// A parameter of the table.
    Set(&'static Knob, Value),
    /// Whether time goes by.
    Playing(bool),
    /// A built-in motion.
    Motion(&'static str),
    /// What a body that bends does: the name of an animation, or nothing.
    Animation(Option<String>),
    /// From where the head is seen.
    Camera(Angle),
}

impl Command {
    /// `name` is `playing`, `motion`, `animation`, `camera`, or the path of a parameter.
    ///
    /// # Errors
    /// One sentence, for a name or a value that does not exist.
    pub fn of(name: &str, value: &str) -> Result<Self> {
        Ok(match name {
            "playing" => match value {
                "true" => Self::Playing(true),
                "false" => Self::Playing(false),
                _ => bail!("playing is true or false, not “{value}”"),
            },
            "motion" => {
                let motion = NAMES.into_iter().find(|motion| *motion == value);
                Self::Motion(motion.with_context(|| {
                    format!("there is no motion “{value}”; there are {}", NAMES.join(", "))
                })?)
            }
            "animation" => Self::Animation((!value.is_empty()).then(|| value.into())),
            "camera" => {
                let names = Angle::ALL.map(|(_, name)| name).join(", ");
                let angle = Angle::ALL.into_iter().find(|(_, name)| *name == value);
                Self::Camera(
                    angle.with_context(|| format!("there is no camera “{value}”; there are {names}"))?.0,
                )
            }
            path => {
                let knob = knobs::named(path).map_err(anyhow::Error::msg)?;
                let value = knob.parse(value)?;
                knob.check(value)?;
                Self::Set(knob, value)
            }
        })
    }
}

/// What a host is called with after every frame of the window: how things are.
pub type Tell = Box<dyn Fn(&State)>;

/// The page around the studio, if there is one.
#[derive(Default)]
pub struct Host {
    /// Called after every frame of the window.
    pub tell: Option<Tell>,
    /// The animation that a body is to begin with, once it is there.
    pub animation: Option<Option<String>>,
}

impl Host {
    /// Does what was asked for of a body that is there now.
    pub fn animate(&mut self, renderer: &mut Renderer, messages: &mut Messages) {
        let Some(show) = &mut renderer.show else { return };
        let Some(name) = self.animation.take() else { return };
        let Some(living) = show.stage.character.rig_mut() else {
            messages.error = Some("this body has no animations".into());
            return;
        };
        if let Err(error) = living.set_animation(name.as_deref()) {
            messages.fail(error);
            return;
        }
        show.stage.character.seek(0.0);
        renderer.playback.play.playing |= name.is_some();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_is_understood_or_told_what_there_is() {
        assert!(matches!(Command::of("playing", "false").unwrap(), Command::Playing(false)));
        assert!(matches!(Command::of("camera", "side").unwrap(), Command::Camera(Angle::Side)));
        assert!(matches!(Command::of("animation", "").unwrap(), Command::Animation(None)));
        let Command::Set(knob, value) = Command::of("wind.speed", "3").unwrap() else {
            panic!("a parameter")
        };
        assert_eq!((knob.path, value), ("wind.speed", Value::Number(3.0)));
        for (name, value, said) in [
            ("playing", "1", "true or false"),
            ("motion", "fly", "shake"),
            ("camera", "top", "three-quarter"),
            ("wind.sped", "3", "wind.speed"),
            ("wind.speed", "fast", "fast"),
            ("wind.speed", "-3", "wind.speed"),
        ] {
            let error = format!("{:#}", Command::of(name, value).unwrap_err());
            assert!(error.contains(said), "{name}={value}: {error}");
        }
    }
}
