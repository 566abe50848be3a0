//! Rows of the tables in `docs/validation/motion.md`: printed, checked, and compared with that file.

use super::lab::{Lab, lab};
use std::{fs, path::PathBuf, sync::Mutex};

/// One comparison.
#[derive(Clone, Debug)]
pub struct Row {
    case: String,
    unit: &'static str,
    measured: f64,
    rule: Rule,
}

#[derive(Clone, Copy, Debug)]
enum Rule {
    /// Expected value, and relative tolerance.
    Near(f64, f64),
    /// Largest allowed magnitude.
    AtMost(f64),
}

/// Returns a row that holds if the measured value is within the relative `tolerance` of `expected`.
pub fn near(
    case: impl Into<String>,
    unit: &'static str,
    expected: f64,
    measured: impl Into<f64>,
    tolerance: f64,
) -> Row {
    Row { case: case.into(), unit, measured: measured.into(), rule: Rule::Near(expected, tolerance) }
}

/// Returns a row that holds if the measured value is at most `most`.
pub fn at_most(case: impl Into<String>, unit: &'static str, most: f64, measured: impl Into<f64>) -> Row {
    Row { case: case.into(), unit, measured: measured.into(), rule: Rule::AtMost(most) }
}

impl Row {
    fn holds(&self) -> bool {
        match self.rule {
            Rule::Near(expected, tolerance) => (self.measured / expected - 1.0).abs() <= tolerance,
            Rule::AtMost(most) => self.measured.abs() <= most,
        }
    }

    /// Returns by how much the value on another adapter may differ from the value in the docs.
    fn slack(&self) -> f64 {
        match self.rule {
            Rule::Near(expected, tolerance) => 0.25 * tolerance * expected.abs(),
            Rule::AtMost(most) => 0.25 * most,
        }
    }

    fn cells(&self) -> [String; 5] {
        let quantity = |x: f64| format!("{} {}", digits(x), self.unit).trim_end().to_owned();
        let (expected, error, tolerance) = match self.rule {
            Rule::Near(expected, tolerance) => (
                quantity(expected),
                format!("{:+.2} %", (self.measured / expected - 1.0) * 100.0),
                format!("{} %", digits(tolerance * 100.0)),
            ),
            Rule::AtMost(most) => ("0".into(), String::new(), format!("at most {}", quantity(most))),
        };
        [self.case.clone(), expected, quantity(self.measured), error, tolerance]
    }
}

/// Formats four significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let places = (3 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{x:.places$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn line(row: &Row) -> String {
    format!("| {} |", row.cells().join(" | "))
}

/// Runs an experiment, and runs it once more with a fault that must make it fail. Prints the rows and compares them
/// with the rows of `topic` in the docs. Does nothing without a GPU.
pub fn judge(topic: &str, experiment: impl Fn(&'static Lab, bool) -> Vec<Row>) {
    if let Some(lab) = lab() {
        docs(topic, &run(|fault| experiment(lab, fault)), true);
    }
}

/// Does the same for some of the rows of a topic.
pub fn judge_some(topic: &str, experiment: impl Fn(&'static Lab, bool) -> Vec<Row>) {
    if let Some(lab) = lab() {
        docs(topic, &run(|fault| experiment(lab, fault)), false);
    }
}

fn run(experiment: impl Fn(bool) -> Vec<Row>) -> Vec<Row> {
    let rows = experiment(false);
    for row in &rows {
        println!("{}", line(row));
    }
    for row in &rows {
        assert!(row.holds(), "{}", line(row));
    }
    for row in experiment(true) {
        assert!(!row.holds(), "a faulty experiment passes: {}", line(&row));
    }
    rows
}

/// Compares rows with the docs. With `TRESSES_PHYSICS=write`, writes them to the docs if `all` rows of the topic are
/// given.
fn docs(topic: &str, rows: &[Row], all: bool) {
    static FILE: Mutex<()> = Mutex::new(());
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/validation/motion.md");
    let _guard = FILE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let text = fs::read_to_string(&path).unwrap();
    let begin = format!("<!-- {topic} -->\n");
    let start = text.find(&begin).unwrap_or_else(|| panic!("docs/validation/motion.md has no rows {begin}"))
        + begin.len();
    let end = start + text[start..].find("<!-- end -->").expect("rows in docs/validation/motion.md end");
    if all && std::env::var_os("TRESSES_PHYSICS").is_some_and(|v| v == "write") {
        let mut table =
            String::from("| case | expected | measured | error | tolerance |\n|---|---|---|---|---|\n");
        for row in rows {
            table += &line(row);
            table.push('\n');
        }
        fs::write(&path, text[..start].to_owned() + &table + &text[end..]).unwrap();
        return;
    }
    let written: Vec<Vec<&str>> = text[start..end]
        .lines()
        .skip(2)
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect();
    let help = "docs/validation/motion.md is out of date: run TRESSES_PHYSICS=write make proof";
    // Rows of real grooms exist only if the assets exist.
    let complete = all && crate::common::sintel().is_some();
    assert!(rows.len() == written.len() || !complete && rows.len() < written.len(), "{topic}: {help}");
    for row in rows {
        let now = row.cells();
        let cells = written.iter().find(|cells| cells[0] == &*now[0]);
        let cells = cells.unwrap_or_else(|| panic!("{topic} has no row {}: {help}", now[0]));
        assert_eq!((cells[0], cells[1], cells[4]), (&*now[0], &*now[1], &*now[4]), "{help}");
        let measured: f64 = cells[2].split(' ').next().and_then(|v| v.parse().ok()).unwrap();
        assert!((measured - row.measured).abs() <= row.slack(), "{cells:?}, now {now:?}: {help}");
    }
}
