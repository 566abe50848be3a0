//! The studio embedded in a host page: no panels; the page sends commands by name and receives the state.

use crate::{messages::Messages, renderer::StudioRenderer, state::State};
use anyhow::{Context, Result, bail};
use tresses_scene::{camera::Angle, knobs::ParsedSetting, motion::NAMES};

/// A command of the host.
#[derive(Clone, Debug)]
pub enum Command {
    /// Sets a parameter.
    Set(ParsedSetting),
    /// Plays or pauses.
    Playing(bool),
    /// Chooses a built-in motion.
    Motion(&'static str),
    /// Chooses an animation of a skinned character, or none.
    Animation(Option<String>),
    /// Moves the camera to a named view.
    Camera(Angle),
}

impl Command {
    /// Parses a command. `name` is `playing`, `motion`, `animation`, `camera`, or the path of a parameter
    /// or of the list of lights.
    ///
    /// # Errors
    /// Fails with one sentence for an unknown name or an invalid value.
    pub fn of(name: &str, value: &str) -> Result<Self> {
        Ok(match name {
            "playing" => match value {
                "true" => Self::Playing(true),
                "false" => Self::Playing(false),
                _ => bail!("playing is “{value}”, but must be true or false"),
            },
            "motion" => {
                let motion = NAMES.into_iter().find(|motion| *motion == value);
                Self::Motion(
                    motion.with_context(|| {
                        format!("there is no motion “{value}”; choose {}", NAMES.join(", "))
                    })?,
                )
            }
            "animation" => Self::Animation((!value.is_empty()).then(|| value.into())),
            "camera" => {
                let names = Angle::ALL.map(|(_, name)| name).join(", ");
                let angle = Angle::ALL.into_iter().find(|(_, name)| *name == value);
                Self::Camera(
                    angle.with_context(|| format!("there is no camera “{value}”; choose {names}"))?.0,
                )
            }
            path => Self::Set(ParsedSetting::parse(path, value).map_err(anyhow::Error::msg)?),
        })
    }
}

/// Callback of the host, called with the state after every frame of the window.
pub type Tell = Box<dyn Fn(&State)>;

/// The host page, if there is one.
#[derive(Default)]
pub struct Host {
    /// Called after every frame of the window.
    pub tell: Option<Tell>,
    /// Animation to start once a character is loaded; `Some(None)` stops the current one.
    pub animation: Option<Option<String>>,
}

impl Host {
    /// Starts the requested animation on the current character.
    pub fn animate(&mut self, renderer: &mut StudioRenderer, messages: &mut Messages) {
        let Some(show) = &mut renderer.show else { return };
        let Some(name) = self.animation.take() else { return };
        let Some(living) = show.stage.character.rig_mut() else {
            messages.error = Some("this character has no animations".into());
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
    fn commands_parse_or_list_valid_names() {
        assert!(matches!(Command::of("playing", "false").unwrap(), Command::Playing(false)));
        assert!(matches!(Command::of("camera", "side").unwrap(), Command::Camera(Angle::Side)));
        assert!(matches!(Command::of("animation", "").unwrap(), Command::Animation(None)));
        for (path, value) in [("wind.speed", "3"), ("lights.list", "point position=0,0.2,0.4")] {
            let Command::Set(setting) = Command::of(path, value).unwrap() else { panic!("a parameter") };
            assert_eq!(setting, ParsedSetting::parse(path, value).unwrap());
        }
        for (name, value, said) in [
            ("playing", "1", "true or false"),
            ("motion", "fly", "shake"),
            ("camera", "top", "three-quarter"),
            ("wind.sped", "3", "wind.speed"),
            ("wind.speed", "fast", "fast"),
            ("wind.speed", "-3", "wind.speed"),
            ("lights.list", "spot", "light 1 of lights.list"),
        ] {
            let error = format!("{:#}", Command::of(name, value).unwrap_err());
            assert!(error.contains(said), "{name}={value}: {error}");
        }
    }
}
