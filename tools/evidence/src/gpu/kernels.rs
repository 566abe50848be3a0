//! The compute kernels as chips see them: registers, spills, waves. Fails when a kernel spills.

use super::compiler::{self, CompiledKernels};
use anyhow::{Result, ensure};
use tresses_cli::bench::table::table;

/// Chips: RDNA 3, RDNA 2, GCN 5. Mesa 22.3 knows RDNA 3 by another name, and gives it half of its registers.
pub const FAMILIES: [&str; 3] = ["navi31", "navi21", "vega10"];

/// Compiles all kernels for each family. Leaves out families that the driver does not know, and returns them.
///
/// # Errors
/// Fails if a kernel does not compile.
pub fn compile(families: &[String]) -> Result<(Vec<CompiledKernels>, Vec<String>)> {
    let (mut chips, mut missing) = (Vec::new(), Vec::new());
    for family in families {
        match compiler::compile(family)? {
            Some(compiled) => chips.push(compiled),
            None => missing.push(format!("not run: the driver does not know {family}")),
        }
    }
    Ok((chips, missing))
}

/// Fails if a kernel of `chips` spills.
pub fn check(chips: &[CompiledKernels]) -> Result<()> {
    let spilling = |chip: &CompiledKernels| {
        let kernels = chip.kernels.iter().filter(|kernel| kernel.spilled > 0);
        kernels.map(|kernel| format!("{} on {}", kernel.name, chip.driver)).collect::<Vec<_>>()
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
    let head =
        ["kernel", "threads", "registers", "spilled", "scratch", "shared", "waves", "latency", "throughput"];
    let mut rows = vec![head.map(String::from).to_vec()];
    rows.extend(kernels.iter().take(shown).map(|kernel| {
        let numbers =
            [kernel.threads, kernel.registers, kernel.spilled, kernel.scratch, kernel.shared, kernel.waves];
        let cycles = [kernel.latency, kernel.throughput].map(|cycles| cycles.to_string());
        std::iter::once(kernel.name.clone()).chain(numbers.map(|n| n.to_string())).chain(cycles).collect()
    }));
    let spill = kernels.iter().filter(|kernel| kernel.spilled > 0).count();
    format!("\n{}: {} kernels, {spill} spill\n{}", chip.driver, kernels.len(), table(&rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_names_the_kernels_that_spill() {
        let kernel =
            |name: &str, spilled| compiler::KernelStats { name: name.into(), spilled, ..Default::default() };
        let chip = |kernels| CompiledKernels { driver: "a chip".into(), kernels };
        assert!(check(&[chip(vec![kernel("a", 0), kernel("b", 0)])]).is_ok());
        let error = check(&[chip(vec![kernel("a", 0), kernel("b", 3)])]).unwrap_err().to_string();
        assert_eq!(error, "registers spill: b on a chip");
        assert!(text(&chip(vec![kernel("a", 0), kernel("b", 3)]), false).contains("2 kernels, 1 spill"));
    }
}
