//! The results of `tresses bench`, as tables and as JSON.

use super::{
    adapter::Adapter,
    crowd, lod,
    results::{SceneResults, StrandPoint},
    statistics::line,
    strokes,
    table::{ms, table},
};
use serde::Serialize;
use tresses_scene::words::grouped;

/// All results.
#[derive(Debug, Default, Serialize)]
pub struct BenchReport {
    /// The adapter.
    pub adapter: Adapter,
    /// The scenes.
    pub groups: Vec<SceneResults>,
    /// Cost against distance.
    pub lod: Vec<lod::LodPoint>,
    /// Cost of a crowd.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<crowd::CrowdTimes>,
    /// Times of grooming.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strokes: Option<strokes::GroomTimes>,
    /// Cost against the strand count.
    pub line: Vec<StrandPoint>,
}

impl BenchReport {
    /// Formats the cost against the strand count as a table.
    pub fn line_text(&self) -> String {
        let points: Vec<_> = self.line.iter().map(|p| (f64::from(p.strands), p.frame.median)).collect();
        let (fixed, slope) = line(&points);
        let mut rows = vec![["strands", "frame", "p95", "GPU", "p95", "line"].map(String::from).to_vec()];
        for point in &self.line {
            let mut row = vec![grouped(point.strands.into())];
            row.extend([point.frame.median, point.frame.p95, point.gpu.median, point.gpu.p95].map(ms));
            row.push(ms(fixed + slope * f64::from(point.strands)));
            rows.push(row);
        }
        format!(
            "\nCost against strand count (style long in motion, 1280 × 720, 1 sample): \
             {} ms + {} ms per 1,000 strands\n{}",
            ms(fixed),
            ms(slope * 1000.0),
            table(&rows)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            results::{Run, StageTime},
            statistics::Summary,
        },
        *,
    };

    fn report() -> BenchReport {
        let time = |median| Summary { median, p95: median * 1.5 };
        let run = |state: &str, scale| Run {
            state: state.into(),
            recorded: Vec::new(),
            frames: 9,
            stages: vec![
                StageTime { name: "simulate".into(), time: time(0.25 * scale) },
                StageTime { name: "draw".into(), time: time(50.0 * scale) },
            ],
            gpu: time(50.25 * scale),
            frame: time(60.0 * scale),
        };
        BenchReport {
            groups: vec![SceneResults {
                name: "a scene".into(),
                samples: 4,
                size: [1920, 1200],
                triangles: 990_016,
                runs: vec![run("at rest", 1.0), run("in motion", 2.0)],
                ..SceneResults::default()
            }],
            line: vec![
                StrandPoint { strands: 1000, gpu: time(1.0), frame: time(3.0) },
                StrandPoint { strands: 100_000, gpu: time(100.0), frame: time(102.0) },
            ],
            ..BenchReport::default()
        }
    }

    #[test]
    fn tables_are_aligned() {
        let report = report();
        let text = report.groups[0].text() + &report.line_text();
        assert!(text.contains("990,016 triangles") && text.contains("1920 × 1200, 4×MSAA, 9 frames"));
        let line = |name: &str| text.lines().find(|l| l.trim_start().starts_with(name)).unwrap();
        assert_eq!(line("simulate").len(), line("whole frame").len());
        assert!(line("simulate").contains("0.250") && line("draw").contains("100.0"));
        assert!(text.contains("2.00 ms + 1.00 ms per 1,000 strands"), "{text}");
    }

    #[test]
    fn json_holds_the_numbers() {
        let value = serde_json::to_value(report()).unwrap();
        assert_eq!(value["groups"][0]["runs"][1]["stages"][1]["median"], 100.0);
        assert_eq!(value["line"][0]["strands"], 1000);
    }
}
