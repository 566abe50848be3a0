//! The `[source]` table of a preset: its keys, and file names relative to the preset.

use crate::source::{COMPANION_FILES, PresetSource};
use std::path::{Component, Path, PathBuf};
use tresses::groom::{
    orient::{Axis, LengthUnit},
    scalp::ScalpMap,
    styles::Style,
};

/// Key, getter and setter of a text value.
pub(super) type Text =
    (&'static str, fn(&PresetSource) -> Option<String>, fn(&mut PresetSource, &str) -> Result<(), String>);

/// Key and accessor of a list of files.
pub(super) type Files = (&'static str, fn(&mut PresetSource) -> &mut Vec<PathBuf>);

pub(super) const FILES: &[Files] = &[("groom", |s| &mut s.grooms), ("head", |s| &mut s.heads)];

macro_rules! file {
    ($key:ident) => {
        (
            stringify!($key),
            |source| source.$key.clone(),
            |source, text| {
                source.$key = Some(text.to_owned());
                Ok(())
            },
        )
    };
}

macro_rules! orientation {
    ($key:literal, $which:ident, $field:ident, $type:ty) => {
        (
            $key,
            |source| source.orientation.$which.$field.map(|value| value.name().to_string()),
            |source, text| {
                source.orientation.$which.$field =
                    Some(text.parse::<$type>().map_err(|error| error.to_string())?);
                Ok(())
            },
        )
    };
}

/// All text keys, in the order in which presets list them.
pub(super) const TEXTS: &[Text] = &[
    (
        "style",
        |source| source.style.clone(),
        |source, text| {
            let style: Style = text.parse().map_err(|error: tresses::groom::Error| error.to_string())?;
            source.style = Some(style.name().to_owned());
            Ok(())
        },
    ),
    orientation!("unit", orient, unit, LengthUnit),
    orientation!("up", orient, up, Axis),
    orientation!("front", orient, front, Axis),
    orientation!("head_unit", orient_head, unit, LengthUnit),
    orientation!("head_up", orient_head, up, Axis),
    orientation!("head_front", orient_head, front, Axis),
    file!(density_map),
    file!(thickness_map),
    file!(length_map),
    file!(curl_map),
    file!(stiffness_map),
    file!(color_map),
    file!(curl_curve),
    file!(lod_maps),
    file!(colliders),
    file!(ties),
    file!(environment),
];

/// The only Boolean key.
pub(super) const MIRROR: &str = "mirror";

impl PresetSource {
    /// Returns whether every field has its default.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// All keys of the table.
    pub(super) fn keys() -> impl Iterator<Item = &'static str> {
        FILES.iter().map(|file| file.0).chain(TEXTS.iter().map(|text| text.0)).chain([MIRROR])
    }

    /// Returns a copy whose file names, relative to `folder`, are made relative to the current directory.
    pub fn inside(&self, folder: &Path) -> Self {
        self.renamed(|path| Ok(folder.join(path))).unwrap_or_else(|_: std::io::Error| self.clone())
    }

    /// Returns a copy whose file names, relative to the current directory, are made relative to `folder`.
    pub(super) fn relative_to(&self, folder: &Path) -> std::io::Result<Self> {
        let from = std::path::absolute(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        self.renamed(|path| Ok(relative(&std::path::absolute(path)?, &from)))
    }

    fn renamed<E>(&self, rename: impl Fn(&Path) -> Result<PathBuf, E>) -> Result<Self, E> {
        let mut renamed = self.clone();
        for (_, files) in FILES {
            for path in files(&mut renamed) {
                *path = rename(path)?;
            }
        }
        for companion in &COMPANION_FILES {
            if let Some(name) = (companion.field)(&mut renamed)
                && !ScalpMap::NAMES.contains(&name.strip_prefix("not-").unwrap_or(name))
            {
                *name = slashes(&rename(Path::new(&name))?);
            }
        }
        Ok(renamed)
    }
}

/// Returns the path with forward slashes, which every platform reads.
pub(super) fn slashes(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

/// Returns the path from the folder `from` to `to`, both absolute. Returns `to` if they share only the root.
fn relative(to: &Path, from: &Path) -> PathBuf {
    let clean = |path: &Path| -> Vec<PathBuf> {
        let mut parts: Vec<PathBuf> = Vec::new();
        for part in path.components() {
            match part {
                Component::CurDir => {}
                Component::ParentDir => {
                    parts.pop();
                }
                part => parts.push(part.as_os_str().into()),
            }
        }
        parts
    };
    let (target, start) = (clean(to), clean(from));
    let common = target.iter().zip(&start).take_while(|(a, b)| a == b).count();
    // With only the root in common, a relative path would be longer than the absolute one.
    if common <= 1 {
        return to.to_owned();
    }
    let up = start[common..].iter().map(|_| PathBuf::from(".."));
    up.chain(target[common..].iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_convert_to_and_from_the_preset_folder() {
        let source = PresetSource {
            grooms: vec!["hair/a.tfx".into()],
            density_map: Some("maps/d.png:r".into()),
            curl_map: Some("not-front".into()),
            ..Default::default()
        };
        let inside = source.inside(Path::new("presets"));
        assert_eq!(inside.grooms, [PathBuf::from("presets/hair/a.tfx")]);
        assert_eq!(inside.density_map.as_deref(), Some("presets/maps/d.png:r"));
        assert_eq!(inside.curl_map.as_deref(), Some("not-front"), "no file");
        assert_eq!(inside.relative_to(Path::new("presets")).unwrap(), source);
        let above = source.relative_to(Path::new("presets/deep")).unwrap();
        assert_eq!(above.grooms, [PathBuf::from("../../hair/a.tfx")]);
        assert_eq!(source.relative_to(Path::new("")).unwrap(), source);
        let far = PresetSource { grooms: vec!["/far/a.tfx".into()], ..Default::default() };
        assert_eq!(far.inside(Path::new("presets")).grooms, far.grooms);
        assert_eq!(far.relative_to(Path::new("/near")).unwrap(), far);
        assert_eq!(far.relative_to(Path::new("/far/away")).unwrap().grooms, [PathBuf::from("../a.tfx")]);
    }
}
