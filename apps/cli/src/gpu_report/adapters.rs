//! Adapters of all backends: description, limits and features.

use super::section::{Draft, cells};
use anyhow::Result;
use pollster::block_on;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use tresses::{Gpu, low_level::Tier};

/// Describes all adapters, opens a device of each, and describes the default adapter.
pub fn measure(draft: &mut Draft) -> Result<()> {
    let instance = Gpu::instance();
    let adapters = block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let names: Vec<String> =
        adapters.iter().enumerate().map(|(i, adapter)| name(i, &adapter.get_info())).collect();
    if adapters.is_empty() {
        draft.find("there is no adapter with Vulkan, Direct3D 12 or Metal");
    }
    for (name, adapter) in names.iter().zip(&adapters) {
        describe(draft, name, adapter);
        draft.keep();
    }
    limits(draft, &names, &adapters);
    features(draft, &names, &adapters);
    draft.keep();
    match block_on(Gpu::open()) {
        Ok(gpu) => {
            draft.note(format!("The other parts use {} ({:?}).", gpu.info.name, gpu.info.backend));
            if gpu.context.tier().software {
                draft.find(format!("the default adapter is a software driver: {}", gpu.info.name));
            }
        }
        Err(error) => draft.find(format!("no device: {error}")),
    }
    Ok(())
}

fn name(index: usize, info: &wgpu::AdapterInfo) -> String {
    format!("{index}: {} ({:?})", info.name, info.backend)
}

/// Adds the row of an adapter, and opens a device as the program does.
fn describe(draft: &mut Draft, name: &str, adapter: &wgpu::Adapter) {
    const COLUMNS: &[&str] = &[
        "adapter",
        "type",
        "driver",
        "vendor",
        "device",
        "bus",
        "subgroups",
        "timestamps",
        "samples",
        "device opens",
    ];
    let (info, tier) = (adapter.get_info(), Tier::of(adapter));
    let problem = block_on(Gpu::on(adapter.clone())).err().map(|error| error.to_string());
    if let Some(problem) = &problem {
        draft.find(format!("{name}: the device does not open: {problem}"));
    }
    if !tier.timestamps {
        draft.note(format!("{name} has no timestamps."));
    }
    let row = cells![
        name,
        format!("{:?}", info.device_type),
        format!("{} {}", info.driver, info.driver_info),
        format!("{:#06x}", info.vendor),
        format!("{:#06x}", info.device),
        info.device_pci_bus_id,
        format!("{} to {}", info.subgroup_min_size, info.subgroup_max_size),
        tier.timestamps,
        tier.max_samples,
        problem.is_none(),
    ];
    draft.row("Adapters", COLUMNS, row);
}

/// Adds a table of limits with a column for each adapter.
fn limits(draft: &mut Draft, names: &[String], adapters: &[wgpu::Adapter]) {
    let all: Vec<_> = adapters.iter().map(|adapter| fields(&format!("{:#?}", adapter.limits()))).collect();
    let rows: BTreeSet<_> = all.iter().flat_map(BTreeMap::keys).collect();
    for row in rows {
        let values = all.iter().map(|limits| limits.get(row).map_or(Value::Null, |value| json!(value)));
        draft.row("Limits", &columns("limit", names), std::iter::once(json!(row)).chain(values).collect());
    }
}

/// Adds a table of features with a column for each adapter.
fn features(draft: &mut Draft, names: &[String], adapters: &[wgpu::Adapter]) {
    let all: Vec<BTreeSet<_>> = adapters
        .iter()
        .map(|adapter| adapter.features().iter_names().map(|(name, _)| name).collect())
        .collect();
    let rows: BTreeSet<_> = all.iter().flatten().collect();
    for row in rows {
        let values = all.iter().map(|features| json!(features.contains(row)));
        draft.row(
            "Features",
            &columns("feature", names),
            std::iter::once(json!(row)).chain(values).collect(),
        );
    }
}

fn columns<'a>(first: &'a str, names: &'a [String]) -> Vec<&'a str> {
    std::iter::once(first).chain(names.iter().map(String::as_str)).collect()
}

/// Returns names and values of the fields of a structure that [`std::fmt::Debug`] printed, one field per line.
fn fields(debug: &str) -> BTreeMap<String, String> {
    let field = |line: &str| {
        let (name, value) = line.trim().trim_end_matches(',').split_once(": ")?;
        Some((name.to_owned(), value.to_owned()))
    };
    debug.lines().filter_map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_names_and_values() {
        let limits = fields(&format!("{:#?}", wgpu::Limits::default()));
        assert_eq!(limits["max_bind_groups"], "4");
        assert!(limits.len() > 30 && limits.values().all(|value| !value.contains('{')), "{limits:?}");
    }
}
