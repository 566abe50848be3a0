//! Compiles each compute kernel with the compiler of a GPU's driver, without the GPU.
//!
//! Mesa's RADV compiles for a chip that is not there. It reads the chip's name from the environment
//! (`RADV_FORCE_FAMILY`) when it is loaded, so each chip takes a process of its own.

use crate::roofline::instrument;
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use std::{env, path::PathBuf, process::Command};
use tresses::low_level::shaders;
use tresses_radv::{Compiler, ResourceKind};
use wgpu::naga::{self, AddressSpace, ImageClass, TypeInner, back::spv};

/// The kernels of a chip.
#[derive(Debug, Deserialize, Serialize)]
pub struct CompiledKernels {
    /// The chip and the driver.
    pub driver: String,
    /// The kernels.
    pub kernels: Vec<KernelStats>,
}

/// The compiler's statistics of a kernel.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct KernelStats {
    /// Module path.
    pub name: String,
    /// Threads per workgroup.
    pub threads: u32,
    /// Vector registers per thread.
    pub registers: u32,
    /// Vector registers that the compiler moved to memory.
    pub spilled: u32,
    /// Private memory per wave, bytes.
    pub scratch: u32,
    /// Workgroup memory, bytes.
    pub shared: u32,
    /// Waves that fit on a SIMD at once.
    pub waves: u32,
    /// Estimated cycles of one wave alone. A loop of unknown length counts 8 turns, in a loop 4, deeper 2.
    pub latency: u64,
    /// Estimated cycles of a SIMD per wave whose threads are all used, when enough waves hide latency.
    pub throughput: u64,
}

/// Returns the driver's description file, or `None` without RADV.
pub fn driver() -> Option<PathBuf> {
    if let Some(named) = env::var_os("TRESSES_RADV") {
        return Some(named.into());
    }
    let folder = PathBuf::from("/usr/share/vulkan/icd.d");
    let names = ["radeon_icd.x86_64.json", "radeon_icd.json", "radeon_icd.aarch64.json"];
    names.map(|name| folder.join(name)).into_iter().find(|path| path.is_file())
}

/// Compiles all kernels that GPUs use for `family`, a chip's name in RADV; `None` for a family that it does not know.
///
/// # Errors
/// Fails without RADV, and if a kernel does not compile.
pub fn compile(family: &str) -> Result<Option<CompiledKernels>> {
    let driver = driver().context("RADV is not installed")?;
    let runtime = env::temp_dir();
    let child = Command::new(env::current_exe()?)
        .args(["kernels", "--compile"])
        .envs([("VK_DRIVER_FILES", &driver), ("VK_ICD_FILENAMES", &driver), ("XDG_RUNTIME_DIR", &runtime)])
        .env("RADV_FORCE_FAMILY", family)
        .output()?;
    let message = String::from_utf8_lossy(&child.stderr);
    if message.contains("Unknown family") {
        return Ok(None);
    }
    ensure!(child.status.success(), "{family}: {}", message.trim());
    Ok(Some(serde_json::from_slice(&child.stdout)?))
}

/// Compiles all kernels with the driver that the environment names, and prints them as JSON.
pub fn print() -> Result<()> {
    let compiler = Compiler::open()?;
    let kernels = kernels().map(|(name, source)| {
        KernelStats::new(&compiler, name, &shaders::for_gpu(source)).with_context(|| name.to_owned())
    });
    let kernels = kernels.collect::<Result<_>>()?;
    println!("{}", serde_json::to_string(&CompiledKernels { driver: compiler.name.clone(), kernels })?);
    Ok(())
}

/// The compute kernels that a GPU runs: of the step, those in workgroup memory.
pub fn kernels() -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = shaders::all();
    let replaced = |name: &str| {
        let other = name.rsplit_once("::").map(|(module, variant)| format!("{module}::workgroup::{variant}"));
        other.is_some_and(|other| all.iter().any(|(name, _)| *name == other))
    };
    all.iter().copied().filter(move |(name, source)| source.contains("@compute") && !replaced(name))
}

impl KernelStats {
    /// Compiles the kernel `name`, as wgpu would.
    fn new(compiler: &Compiler, name: &str, source: &str) -> Result<Self> {
        let (module, info) = instrument::parse(source)?;
        let entry = module.entry_points.first().context("a kernel has an entry point")?;
        let options = spv::Options {
            zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
            ..Default::default()
        };
        let pipeline = spv::PipelineOptions {
            shader_stage: naga::ShaderStage::Compute,
            entry_point: entry.name.clone(),
        };
        let spirv = spv::write_vec(&module, &info, &options, Some(&pipeline))?;
        let resources = module.global_variables.iter().filter_map(|(_, variable)| {
            let at = variable.binding.as_ref()?;
            let kind = match (variable.space, &module.types[variable.ty].inner) {
                (AddressSpace::Uniform, _) => ResourceKind::Uniform,
                (AddressSpace::Storage { .. }, _) => ResourceKind::Storage,
                (_, TypeInner::Sampler { .. }) => ResourceKind::Sampler,
                (_, TypeInner::Image { class: ImageClass::Storage { .. }, .. }) => ResourceKind::Image,
                _ => ResourceKind::Texture,
            };
            Some((at.group, at.binding, kind))
        });
        let found = compiler.statistics(&spirv, &entry.name, &resources.collect::<Vec<_>>())?;
        let value = |key: &str| found.iter().find(|(name, _)| name == key).map_or(0, |(_, value)| *value);
        let small = |key: &str| u32::try_from(value(key)).unwrap_or(u32::MAX);
        ensure!(value("VGPRs") > 0, "the driver reports no registers");
        Ok(Self {
            name: name.into(),
            threads: entry.workgroup_size.iter().product(),
            registers: small("VGPRs"),
            spilled: small("Spilled VGPRs"),
            scratch: small("Scratch size"),
            shared: small("LDS size"),
            waves: small("Subgroups per SIMD"),
            latency: value("Latency"),
            throughput: value("Inverse Throughput"),
        })
    }
}
