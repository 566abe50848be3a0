//! One part in its own process.

use super::{
    adapters,
    args::{GpuArgs, Part},
    checks, device, frames, images, rates,
    section::{Draft, PartState, ReportSection},
    shaders, suite,
};
use anyhow::{Result, anyhow};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `part` and prints its section. Errors and panics become findings.
pub fn run(part: Part, args: &GpuArgs) {
    let section =
        ReportSection { name: part.name().into(), about: part.about().into(), ..ReportSection::default() };
    let mut draft = Draft { section };
    // wgpu panics where it cannot return an error, for example after the device is lost.
    let caught = catch_unwind(AssertUnwindSafe(|| measure(part, args.quick, &mut draft)));
    match caught.unwrap_or_else(|panic| Err(anyhow!("{}", message(&*panic)))) {
        Ok(()) => draft.section.state = PartState::Complete,
        Err(error) => {
            draft.section.state = PartState::Failed;
            draft.find(format!("ended early: {error:#}"));
        }
    }
    if let Some(loss) = device::take_loss() {
        draft.section.state = PartState::Failed;
        draft.find(format!("the device was lost: {loss}"));
    }
    draft.keep();
}

fn measure(part: Part, quick: bool, draft: &mut Draft) -> Result<()> {
    match part {
        Part::Adapters => adapters::measure(draft),
        Part::Shaders => shaders::measure(draft, quick),
        Part::Checks => checks::measure(draft),
        Part::Images => images::measure(draft, quick),
        Part::Rates => rates::measure(draft),
        Part::Frames => frames::measure(draft, quick),
        Part::Tests => suite::measure(draft),
    }
}

/// Returns the message of a panic.
fn message(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("panic without a message")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_panics_are_kept() {
        for panic in [catch_unwind(|| panic!("lost")), catch_unwind(|| panic!("{}", "lost"))] {
            assert_eq!(message(&*panic.unwrap_err()), "lost");
        }
    }
}
