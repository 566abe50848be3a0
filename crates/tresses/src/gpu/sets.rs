//! Pipeline sets of a context.

use super::{Context, Kernel, kernel::Job, pipeline::lock};
use std::{any::TypeId, sync::Arc};

/// Pipelines of one stage, created once per device at first use.
pub(crate) trait PipelineSet: wgpu::WasmNotSendSync + Sized + 'static {
    /// Creates the set for the device of `context` without compiling anything.
    fn new(context: &Context) -> Self;

    /// Kernels that [`Context::prepare`] compiles if the stage is requested.
    fn kernels(&self) -> Vec<&Kernel> {
        Vec::new()
    }
}

impl Context {
    /// Returns the pipeline set `T`, which all clones of this context share.
    pub(crate) fn pipelines<T: PipelineSet>(&self) -> Arc<T> {
        let slot = lock(&self.sets).entry(TypeId::of::<T>()).or_default().clone();
        // The map is unlocked here, because a set may request others.
        let set = slot.get_or_init(|| Box::new(Arc::new(T::new(self))));
        set.downcast_ref::<Arc<T>>().expect("the slot of a type holds that type").clone()
    }

    /// Returns jobs that compile the kernels of `T`.
    pub(crate) fn jobs<T: PipelineSet>(&self) -> Vec<Job<'static>> {
        let set = self.pipelines::<T>();
        let job = |i: usize| {
            let set = set.clone();
            Box::new(move || set.kernels()[i].compile()) as Job<'static>
        };
        (0..set.kernels().len()).map(job).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    struct Inner;
    #[derive(Debug)]
    struct Outer(Arc<Inner>);

    impl PipelineSet for Inner {
        fn new(_: &Context) -> Self {
            Self
        }
    }

    impl PipelineSet for Outer {
        fn new(context: &Context) -> Self {
            Self(context.pipelines())
        }
    }

    #[test]
    fn pipelines_are_shared_by_clones_only() {
        let first = crate::gpu::noop();
        let outer = first.clone().pipelines::<Outer>();
        assert!(Arc::ptr_eq(&outer, &first.pipelines()));
        assert!(Arc::ptr_eq(&outer.0, &first.pipelines()));
        assert!(!Arc::ptr_eq(&outer, &crate::gpu::noop().pipelines()));
    }
}
