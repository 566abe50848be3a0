//! The adapter of the measurements.

use serde::Serialize;
use tresses::Gpu;

/// The adapter of the measurements.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Adapter {
    /// Name, as the driver reports it.
    pub name: String,
    /// Vulkan, Metal, Dx12 or Gl.
    pub backend: String,
    /// Driver name and version.
    pub driver: String,
    /// Whether it runs on the CPU.
    pub software: bool,
    /// Whether it has timestamps.
    pub timestamps: bool,
    /// Whether times are processor time of all threads.
    pub processor_time: bool,
    /// Maximum samples per pixel.
    pub max_samples: u32,
}

impl Adapter {
    /// Describes the adapter of `gpu`.
    pub fn of(gpu: &Gpu) -> Self {
        let info = &gpu.info;
        Self {
            name: info.name.clone(),
            backend: format!("{:?}", info.backend),
            driver: [info.driver.as_str(), info.driver_info.as_str()].join(" ").trim().to_owned(),
            software: gpu.context.tier().software,
            timestamps: gpu.context.tier().timestamps,
            processor_time: false,
            max_samples: gpu.context.tier().max_samples,
        }
    }

    /// Formats the adapter and the method of timing.
    pub fn text(&self) -> String {
        let kind = if self.software { ", on the CPU" } else { "" };
        let timed = match self {
            Self { processor_time: true, .. } => {
                "Each stage is submitted alone; times are CPU time of all threads, so elapsed time is shorter."
            }
            Self { software: true, .. } => {
                "Each stage is submitted alone and timed by wall clock: this driver's timestamps are not comparable."
            }
            Self { timestamps: false, .. } => "This adapter has no timestamps: whole frames only.",
            _ => "Stages by GPU timestamps, whole frames by wall clock.",
        };
        format!(
            "{} ({}, {}{kind})\n{timed}\nMilliseconds: medians and 95th percentiles.\n",
            self.name, self.backend, self.driver
        )
    }
}
