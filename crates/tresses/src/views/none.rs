//! Types without values in place of the debug views, without the feature `debug-views`.

use crate::{Picture, Result, View, body::Body, gpu::Commands, hair::Hair, light::HairView};

/// See the feature `debug-views`.
#[derive(Debug)]
pub enum DebugDisplay {}

impl DebugDisplay {
    pub(crate) fn picture(&self, _: &Picture) -> Picture {
        match *self {}
    }

    pub(crate) fn hides_hair(&self) -> bool {
        match *self {}
    }
}

/// See the feature `debug-views`.
#[derive(Debug)]
pub enum DebugViews {}

impl DebugViews {
    pub(crate) fn shade(
        &self,
        _: &mut Commands<'_>,
        _: &DebugDisplay,
        _: &Picture,
        _: &[&Hair],
        _: &[HairView<'_>],
    ) -> Result<bool> {
        match *self {}
    }

    pub(crate) fn over(
        &mut self,
        _: &mut Commands<'_>,
        _: &DebugDisplay,
        _: &Picture,
        _: (&View, &wgpu::TextureView),
        _: (&[&Hair], &[HairView<'_>]),
        _: &[&Body],
    ) -> Result<()> {
        match *self {}
    }
}
