//! The compute kernels as chips see them: registers, spills, waves. Fails when a kernel spills more than is known.

use super::compiler::{self, Compilation, CompiledKernels, KernelStats};
use anyhow::{Result, ensure};
use tresses_cli::bench::table::table;

/// Chips: RDNA 4, RDNA 3, RDNA 2, GCN 5; Xe2, Arc A, Xe; Ampere; Adreno; M1. Mesa 22.3 knows RDNA 3 by another name,
/// and gives it half of its registers.
pub const CHIPS: [&str; 11] = [
    "amd:gfx1201",
    "amd:navi31",
    "amd:navi21",
    "amd:vega10",
    "intel:bmg",
    "intel:dg2",
    "intel:tgl",
    "nvidia:172",
    "qualcomm:740",
    "qualcomm:630",
    "apple:m1",
];

/// Most spills of the kernels whose name begins with the second word, on chips of the maker. On all others none may
/// spill. docs/research/gpu-compilers.md has the reasons.
const KNOWN: [(&str, &str, u32); 22] = [
    ("intel", "simulate::step::", 80),
    ("intel", "simulate::twist::", 310),
    ("intel", "draw::tiles::", 90),
    // Near lights.
    ("intel", "light::shading_samples::2", 140),
    ("intel", "light::shading_samples::", 70),
    ("intel", "light::shade::2", 80),
    ("intel", "light::shade::3", 100),
    ("intel", "light::ambient::gather_unmapped", 35),
    ("intel", "wind::smooth_", 120),
    // A debug view.
    ("intel", "views::terms", 390),
    // A stack in private memory.
    ("intel", "collide::build::measure", 65),
    ("nvidia", "simulate::twist::", 15),
    ("qualcomm", "simulate::twist::", 15),
    ("qualcomm", "views::terms", 20),
    ("apple", "simulate::step::", 1000),
    ("apple", "simulate::twist::", 800),
    ("apple", "draw::tiles::", 90),
    // Near lights.
    ("apple", "light::shading_samples::2", 155),
    ("apple", "light::shading_samples::", 15),
    ("apple", "light::shade::2", 290),
    ("apple", "light::shade::3", 310),
    ("apple", "views::terms", 1040),
];

/// Returns the most spills that are known of `kernel` on `chip`.
fn known(chip: &CompiledKernels, kernel: &KernelStats) -> u32 {
    let maker = chip.chip.split(':').next();
    let found = KNOWN.iter().find(|(of, name, _)| maker == Some(of) && kernel.name.starts_with(name));
    found.map_or(0, |(.., max_spills)| *max_spills)
}

/// Compiles all kernels for each chip. Leaves out those without a driver that knows them, and returns the reasons.
///
/// # Errors
/// Fails if a kernel does not compile.
pub fn compile(names: &[String]) -> Result<(Vec<CompiledKernels>, Vec<String>)> {
    let (mut chips, mut missing) = (Vec::new(), Vec::new());
    for name in names {
        match compiler::compile(name)? {
            Compilation::Kernels(compiled) => chips.push(compiled),
            Compilation::Missing(why) => missing.push(format!("not run: {why}")),
        }
    }
    Ok((chips, missing))
}

/// Fails if a kernel of `chips` spills more than is known.
pub fn check(chips: &[CompiledKernels]) -> Result<()> {
    let spilling = |chip: &CompiledKernels| {
        let kernels = chip.kernels.iter().filter(|kernel| kernel.spilled > known(chip, kernel));
        let line = |kernel: &KernelStats| format!("{} on {} ({})", kernel.name, chip.chip, kernel.spilled);
        kernels.map(line).collect::<Vec<_>>()
    };
    let spilling: Vec<_> = chips.iter().flat_map(spilling).collect();
    ensure!(spilling.is_empty(), "registers spill: {}", spilling.join(", "));
    Ok(())
}

/// Formats the kernels of a chip with the most registers, and a summary.
pub fn text(chip: &CompiledKernels, all: bool) -> String {
    let mut kernels: Vec<_> = chip.kernels.iter().collect();
    kernels.sort_by_key(|kernel| {
        (std::cmp::Reverse((kernel.spilled, kernel.registers)), std::cmp::Reverse(kernel.latency))
    });
    let shown = if all { kernels.len() } else { 12 };
    let head = [
        "kernel",
        "threads",
        "lanes",
        "registers",
        "spilled",
        "scratch",
        "shared",
        "waves",
        "latency",
        "throughput",
    ];
    let mut rows = vec![head.map(String::from).to_vec()];
    rows.extend(kernels.iter().take(shown).map(|kernel| {
        let numbers = [kernel.threads, kernel.lanes, kernel.registers, kernel.spilled, kernel.scratch];
        let numbers = numbers.into_iter().chain([kernel.shared, kernel.waves]);
        let cycles = [kernel.latency, kernel.throughput].map(|cycles| cycles.to_string());
        std::iter::once(kernel.name.clone()).chain(numbers.map(|n| n.to_string())).chain(cycles).collect()
    }));
    let spill = kernels.iter().filter(|kernel| kernel.spilled > 0).count();
    let CompiledKernels { chip: name, driver, .. } = chip;
    format!("\n{name}, {driver}: {} kernels, {spill} spill\n{}", kernels.len(), table(&rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_names_the_kernels_that_spill() {
        let kernel = |name: &str, spilled| KernelStats { name: name.into(), spilled, ..Default::default() };
        let chip = |chip: &str, kernels| CompiledKernels { chip: chip.into(), kernels, ..Default::default() };
        let ab = |spilled| vec![kernel("a", 0), kernel("b", spilled)];
        assert!(check(&[chip("amd:x", ab(0))]).is_ok());
        let error = check(&[chip("amd:x", ab(3))]).unwrap_err().to_string();
        assert_eq!(error, "registers spill: b on amd:x (3)");
        assert!(text(&chip("amd:x", ab(3)), false).contains("2 kernels, 1 spill"));
    }

    #[test]
    fn check_allows_known_spills_on_chips_of_their_maker() {
        let (maker, name, max_spills) = KNOWN[0];
        let chip = |maker: &str, spilled| CompiledKernels {
            chip: format!("{maker}:x"),
            kernels: vec![KernelStats { name: format!("{name}8"), spilled, ..Default::default() }],
            ..Default::default()
        };
        assert!(check(&[chip(maker, max_spills)]).is_ok());
        assert!(check(&[chip(maker, max_spills + 1)]).is_err());
        assert!(check(&[chip("amd", 1)]).is_err());
    }
}
