//! Commands that a frame records, by stage. They cost time on every driver.

use super::table::table;
use serde::Serialize;
use tresses::low_level::Counts;

/// Commands of one stage in one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StageCommands {
    /// Name of the stage, as in the table of times.
    pub stage: String,
    /// Compute and render passes.
    pub passes: u32,
    /// Dispatches, including indirect ones.
    pub dispatches: u32,
    /// Draws.
    pub draws: u32,
    /// Pipeline changes.
    pub pipelines: u32,
    /// Bind group changes.
    pub groups: u32,
    /// Copies and fills outside of passes.
    pub transfers: u32,
    /// Bytes moved by attachments and transfers.
    pub bytes: u64,
}

impl StageCommands {
    /// Names of [`numbers`](Self::numbers).
    pub const NAMES: [&'static str; 6] =
        ["passes", "dispatches", "draws", "pipelines", "bind groups", "transfers"];

    /// Returns the numbers of commands.
    pub fn numbers(&self) -> [u32; 6] {
        [self.passes, self.dispatches, self.draws, self.pipelines, self.groups, self.transfers]
    }
}

impl From<(&str, Counts)> for StageCommands {
    fn from((stage, counts): (&str, Counts)) -> Self {
        let Counts { passes, dispatches, draws, pipelines, groups, transfers, bytes, .. } = counts;
        Self { stage: stage.into(), passes, dispatches, draws, pipelines, groups, transfers, bytes }
    }
}

/// Returns the numbers of commands of all `stages`.
pub fn sums(stages: &[StageCommands]) -> [u32; 6] {
    std::array::from_fn(|i| stages.iter().map(|stage| stage.numbers()[i]).sum())
}

/// Formats a table with sums; empty without stages.
pub fn text(stages: &[StageCommands]) -> String {
    if stages.is_empty() {
        return String::new();
    }
    let line =
        |name: &str, cells: [String; 6]| std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>();
    let mut rows = vec![line("recorded", StageCommands::NAMES.map(String::from))];
    rows.extend(stages.iter().map(|stage| line(&stage.stage, stage.numbers().map(|n| n.to_string()))));
    rows.push(line("the frame", sums(stages).map(|n| n.to_string())));
    table(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_row_sums_all_stages() {
        let counts = Counts { passes: 2, dispatches: 3, groups: 40, ..Counts::default() };
        let stages = [
            StageCommands::from(("bins", counts)),
            StageCommands { draws: 7, ..StageCommands::from(("body", counts)) },
        ];
        let text = text(&stages);
        let words: Vec<_> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(words, ["the", "frame", "4", "6", "7", "0", "80", "0"]);
        assert!(super::text(&[]).is_empty());
    }
}
