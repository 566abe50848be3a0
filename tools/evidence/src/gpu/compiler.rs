//! Compiles each compute kernel with the compiler of a GPU's driver, without the GPU.
//!
//! Mesa's drivers compile for a chip that is not there when a library stands in for the kernel's driver (drm-shim).
//! `scripts/gpu-compilers` sets both up. Without it, an installed RADV before Mesa 26 does so alone. The chip is read
//! from the environment when a driver is loaded, so each takes a process of its own.

use self::ChipName::{Only, Variable};
use crate::roofline::instrument;
use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use std::{
    env,
    path::{Path, PathBuf},
    process::Command,
};
use tresses::low_level::shaders;
use tresses_drivers::{Compiler, ResourceKind};
use wgpu::naga::{self, AddressSpace, ImageClass, TypeInner, back::spv};

/// Folder of the drivers, unless `TRESSES_GPU_COMPILERS` names another.
const FOLDER: &str = "target/tools/gpu-compilers";

/// A driver of Mesa, and how it learns the chip.
struct Driver {
    /// The chips' maker, as chips are named here.
    maker: &'static str,
    /// Name of its description file.
    file: &'static str,
    /// Name of the library that replaces the device.
    shim: &'static str,
    chip: ChipName,
}

/// How a driver learns the chip.
enum ChipName {
    /// By a variable of the environment.
    Variable(&'static str),
    /// There is only this chip.
    Only(&'static str),
}

const DRIVERS: [Driver; 5] = [
    Driver { maker: "amd", file: "radeon", shim: "amdgpu", chip: Variable("AMDGPU_GPU_ID") },
    Driver { maker: "intel", file: "intel", shim: "intel", chip: Variable("INTEL_STUB_GPU_PLATFORM") },
    Driver { maker: "nvidia", file: "nouveau", shim: "nouveau", chip: Variable("NOUVEAU_CHIPSET") },
    Driver { maker: "qualcomm", file: "freedreno", shim: "freedreno", chip: Variable("FD_GPU_ID") },
    Driver { maker: "apple", file: "asahi", shim: "asahi", chip: Only("m1") },
];

/// The kernels of a chip.
#[derive(Debug, Default, Deserialize, Serialize)]
pub struct CompiledKernels {
    /// The chip: maker and name.
    #[serde(default)]
    pub chip: String,
    /// The device's name and the driver.
    pub driver: String,
    /// The kernels.
    pub kernels: Vec<KernelStats>,
}

/// The compiler's statistics of a kernel. Those that a driver does not report are 0.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct KernelStats {
    /// Module path.
    pub name: String,
    /// Threads per workgroup.
    pub threads: u32,
    /// Threads of a wave, which run in lockstep.
    #[serde(default)]
    pub lanes: u32,
    /// Vector registers of 32 bits per thread. Of Intel: as many as are needed at once, also those that spill.
    pub registers: u32,
    /// Vector registers that the compiler moved to memory. Of other makers than AMD: stores that do so.
    pub spilled: u32,
    /// Private memory per wave, bytes. Of Apple: per thread.
    pub scratch: u32,
    /// Workgroup memory, bytes.
    pub shared: u32,
    /// Waves that fit on a SIMD at once. Of NVIDIA and Qualcomm: on a multiprocessor or core.
    pub waves: u32,
    /// Estimated cycles of one wave alone. A loop of unknown length counts 8 turns, in a loop 4, deeper 2. (AMD)
    pub latency: u64,
    /// Estimated cycles of a SIMD per wave whose threads are all used, when enough waves hide latency. (AMD)
    pub throughput: u64,
}

/// Result of compiling for a chip.
pub enum Compilation {
    /// Its kernels.
    Kernels(CompiledKernels),
    /// The reason why there are none.
    Missing(String),
}

/// Returns the description file of an installed RADV.
fn installed_radv() -> Option<PathBuf> {
    if let Some(named) = env::var_os("TRESSES_RADV") {
        return Some(named.into());
    }
    let folder = PathBuf::from("/usr/share/vulkan/icd.d");
    let names = ["radeon_icd.x86_64.json", "radeon_icd.json", "radeon_icd.aarch64.json"];
    names.map(|name| folder.join(name)).into_iter().find(|path| path.is_file())
}

/// Returns the command that compiles for `name` of `driver`, or `None` without the driver.
fn command(driver: &Driver, name: &str) -> Result<Option<Command>> {
    let program = env::current_exe()?;
    let folder = env::var_os("TRESSES_GPU_COMPILERS").map_or_else(|| FOLDER.into(), PathBuf::from);
    let file = folder.join(format!("{}.json", driver.file));
    let shim = folder.join(format!("lib/lib{}_noop_drm_shim.so", driver.shim));
    let has_own_radv = driver.maker == "amd" && env::var_os("TRESSES_RADV").is_some();
    let mut command;
    if !has_own_radv && file.is_file() && shim.is_file() {
        // The drivers bring their own C library, with whose loader the program has to start.
        let folder = std::path::absolute(folder)?;
        command = Command::new(folder.join("ld.so"));
        command.arg("--library-path").arg(folder.join("lib"));
        command.arg("--preload").arg(std::path::absolute(shim)?).arg(program);
        match driver.chip {
            Variable(variable) => _ = command.env(variable, name),
            Only(only) => ensure!(name == only, "of {}, there is only {only}", driver.maker),
        }
        use_driver(&mut command, &std::path::absolute(file)?);
    } else if let Some(file) = (driver.maker == "amd").then(installed_radv).flatten() {
        command = Command::new(program);
        command.env("RADV_FORCE_FAMILY", name);
        use_driver(&mut command, &file);
    } else {
        return Ok(None);
    }
    command.args(["kernels", "--compile"]);
    Ok(Some(command))
}

/// Has the Vulkan loader of `command` use only the driver that `file` describes.
fn use_driver(command: &mut Command, file: &Path) {
    command.env("VK_DRIVER_FILES", file).env("VK_ICD_FILENAMES", file);
    command.env("XDG_RUNTIME_DIR", env::temp_dir());
}

/// Compiles all kernels that GPUs use for `chip`: `maker:name`, or the name of a chip of AMD.
///
/// # Errors
/// Fails if the maker is unknown or a kernel does not compile.
pub fn compile(chip: &str) -> Result<Compilation> {
    let (maker, name) = chip.split_once(':').unwrap_or(("amd", chip));
    let Some(driver) = DRIVERS.iter().find(|driver| driver.maker == maker) else {
        let makers = DRIVERS.map(|driver| driver.maker).join(", ");
        bail!("there is no maker {maker}; there are {makers}");
    };
    let chip = format!("{maker}:{name}");
    let Some(mut command) = command(driver, name)? else {
        return Ok(Compilation::Missing(format!("{chip}: no driver, see scripts/gpu-compilers")));
    };
    let child = command.output().with_context(|| format!("{chip}: its driver does not start"))?;
    let message = String::from_utf8_lossy(&child.stderr);
    let unknown = ["Unknown family", "Failed to find amdgpu GPU", "FORCE_FAMILY=<family> has been removed"];
    if unknown.iter().any(|text| message.contains(text)) {
        return Ok(Compilation::Missing(format!("{chip}: the driver does not know it")));
    }
    ensure!(child.status.success(), "{chip}: {}", message.trim());
    let mut compiled: CompiledKernels = serde_json::from_slice(&child.stdout)?;
    for kernel in &mut compiled.kernels {
        kernel.registers = of_32_bits(maker, kernel);
    }
    Ok(Compilation::Kernels(CompiledKernels { chip, ..compiled }))
}

/// Returns the registers of `kernel`, counted as its driver does, as registers of 32 bits per thread.
fn of_32_bits(maker: &str, kernel: &KernelStats) -> u32 {
    match maker {
        // 32 bytes that the lanes of a wave share; counted so for Xe2 too, whose registers have 64.
        "intel" => (kernel.registers * 8).div_ceil(kernel.lanes.max(1)),
        // Vectors of four.
        "qualcomm" => kernel.registers * 4,
        // Of 16 bits.
        "apple" => kernel.registers.div_ceil(2),
        _ => kernel.registers,
    }
}

/// Compiles all kernels with the driver that the environment names, and prints them as JSON.
pub fn print() -> Result<()> {
    let compiler = Compiler::open()?;
    let kernels = kernels().map(|(name, source)| {
        KernelStats::new(&compiler, name, &shaders::for_gpu(source)).with_context(|| name.to_owned())
    });
    let kernels = kernels.collect::<Result<_>>()?;
    let driver = compiler.name.clone();
    println!("{}", serde_json::to_string(&CompiledKernels { driver, kernels, ..Default::default() })?);
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
        let first = |keys: &[&str]| keys.iter().find_map(|key| found.get(key));
        let small = |keys: &[&str]| first(keys).map_or(0, |value| u32::try_from(value).unwrap_or(u32::MAX));
        let registers = small(&REGISTERS);
        ensure!(registers > 0, "the driver reports no registers");
        Ok(Self {
            name: name.into(),
            threads: entry.workgroup_size.iter().product(),
            lanes: found.lanes,
            registers,
            spilled: small(&SPILLED),
            scratch: small(&["Scratch size", "Scratch Memory Size", "Scratch"]),
            shared: small(&["LDS size", "Workgroup Memory Size", "SLM size"]),
            waves: small(&["Subgroups per SIMD", "Max warps/SM", "Max Waves Per Core"]),
            latency: first(&["Latency"]).unwrap_or(0),
            throughput: first(&["Inverse Throughput"]).unwrap_or(0),
        })
    }
}

/// Names of the number of registers: AMD, Intel, NVIDIA, Qualcomm, Apple.
const REGISTERS: [&str; 5] = ["VGPRs", "Max live registers", "Number of GPRs", "Registers used", "GPRs"];
/// Names of the number of spills: AMD, Intel and Apple, NVIDIA, Qualcomm.
const SPILLED: [&str; 4] = ["Spilled VGPRs", "Spills", "Spills to memory", "STP Count"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_are_counted_in_words_per_thread() {
        let kernel = |registers, lanes| KernelStats { registers, lanes, ..Default::default() };
        assert_eq!(of_32_bits("amd", &kernel(100, 64)), 100);
        assert_eq!(of_32_bits("intel", &kernel(100, 16)), 50);
        assert_eq!(of_32_bits("qualcomm", &kernel(48, 64)), 192);
        assert_eq!(of_32_bits("apple", &kernel(255, 32)), 128);
    }
}
