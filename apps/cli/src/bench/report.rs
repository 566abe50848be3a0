//! The results, as tables and as JSON.

use super::{
    appearance::Look,
    costs::Costs,
    crowd, lod,
    results::{Group, Point, Run, measured},
    roofline::Roofline,
    statistics::line,
    table::{ms, table},
};
use serde::Serialize;
use tresses::gpu::Gpu;
use tresses_scene::words::grouped;

/// Everything `tresses bench` found.
#[derive(Debug, Default, Serialize)]
pub struct Report {
    /// Name, driver and abilities.
    pub adapter: Adapter,
    /// The scenes.
    pub groups: Vec<Group>,
    /// The parts of the simulation against each other.
    pub costs: Costs,
    /// The ways to light, shade and draw hair.
    pub looks: Vec<Look>,
    /// Cost against distance.
    pub lod: Vec<lod::Point>,
    /// What a crowd costs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowd: Option<crowd::Times>,
    /// What stages must cost at least.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roofline: Option<Roofline>,
    /// Cost against the number of strands.
    pub line: Vec<Point>,
}

/// On what it was measured.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Adapter {
    /// As the driver calls it.
    pub name: String,
    /// Vulkan, Metal, Dx12 or Gl.
    pub backend: String,
    /// Name and version.
    pub driver: String,
    /// Whether it runs on the CPU.
    pub software: bool,
    /// Whether it can time its passes.
    pub timestamps: bool,
    /// Whether all times are the processor's, of all threads.
    pub processor_time: bool,
    /// The most samples per pixel.
    pub max_samples: u32,
}

impl Adapter {
    /// The adapter of `gpu`.
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
}

impl Adapter {
    /// What it is, and how it was timed.
    pub fn text(&self) -> String {
        let kind = if self.software { ", on the CPU" } else { "" };
        let timed = match self {
            Self { processor_time: true, .. } => {
                "Each stage submitted alone; times are the processor's, of all threads: elapsed time is less."
            }
            Self { software: true, .. } => {
                "Each stage submitted alone and timed by wall clock: this driver's timestamps are not comparable."
            }
            Self { timestamps: false, .. } => "This adapter cannot time its passes: whole frames only.",
            _ => "Stages by GPU timestamps, whole frames by wall clock.",
        };
        format!(
            "{} ({}, {}{kind})\n{timed}\nMilliseconds: medians and 95th percentiles.\n",
            self.name, self.backend, self.driver
        )
    }
}

impl Report {
    /// The parts of the simulation, as tables.
    pub fn costs_text(&self) -> String {
        let costs = &self.costs;
        let mut rows = vec![["", "median", "p95"].map(String::from).to_vec()];
        rows.extend(
            costs.parts.iter().map(|part| vec![part.name.clone(), ms(part.time.median), ms(part.time.p95)]),
        );
        let text = format!(
            "\nSimulation costs (style long in motion, {} guides × {} vertices, {} strands, one fixed step, {})\n{}",
            grouped(costs.guides.into()),
            costs.guide_vertices,
            grouped(costs.strands.into()),
            measured(std::iter::once(costs.frames)),
            table(&rows)
        );
        let mut rows = vec![["ratio of medians", "measured", "at most"].map(String::from).to_vec()];
        rows.extend(
            costs
                .limits
                .iter()
                .map(|l| vec![l.what.clone(), format!("{:.2}", l.ratio), format!("{:.2}", l.most)]),
        );
        text + &table(&rows)
    }

    /// The ways to draw, as a table; empty without any.
    pub fn looks_text(&self) -> String {
        let Some(first) = self.looks.first() else { return String::new() };
        // What moves the hair is the same for all.
        let drawing = |run: &Run| {
            let from = run.stages.iter().position(|stage| stage.name == "shadow").unwrap_or(0);
            run.stages[from..].iter().map(|stage| (stage.name.clone(), stage.time.median)).collect::<Vec<_>>()
        };
        let mut names: Vec<String> = Vec::new();
        for look in &self.looks {
            // One that only some have goes behind the one that it follows there.
            let mut at = 0;
            for (name, _) in drawing(&look.run) {
                match names.iter().position(|known| *known == name) {
                    Some(known) => at = known + 1,
                    None => {
                        names.insert(at, name);
                        at += 1;
                    }
                }
            }
        }
        let head = [String::new()].into_iter().chain(names.iter().cloned());
        let mut rows = vec![head.chain(["sum".into(), "bytes per pixel".into()]).collect::<Vec<_>>()];
        let mut topic = "";
        for look in &self.looks {
            if look.topic != topic {
                topic = &look.topic;
                rows.push(vec![format!("{topic}:")]);
            }
            let times = drawing(&look.run);
            let time = |name: &String| times.iter().find(|(known, _)| known == name).map(|(_, ms)| *ms);
            let mut row = vec![format!("  {}", look.name)];
            row.extend(names.iter().map(|name| time(name).map_or("-".into(), ms)));
            row.push(ms(times.iter().map(|(_, ms)| ms).sum()));
            row.push(format!("{:.0}", look.bytes_per_pixel));
            rows.push(row);
        }
        let most = self.adapter.max_samples;
        format!(
            "\nDrawing (style long in motion, {} strands, {} × {}{}; 4×MSAA where nothing else is said{}), \
             medians of {}\n{}",
            grouped(first.strands.into()),
            first.size[0],
            first.size[1],
            if self.adapter.software { ", less than on a GPU" } else { "" },
            if most < 8 { format!(", no more than {most} on this adapter") } else { String::new() },
            measured(self.looks.iter().map(|look| look.run.frames)),
            table(&rows)
        )
    }

    /// Cost against the number of strands, as a table.
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
            "\nCost against the number of strands (style long in motion, 1280 × 720, 1 sample): \
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
            costs::{Limit, Part},
            results::StageTime,
            statistics::Summary,
        },
        *,
    };

    fn report() -> Report {
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
        Report {
            groups: vec![Group {
                name: "a scene".into(),
                samples: 4,
                size: [1920, 1200],
                triangles: 990_016,
                runs: vec![run("at rest", 1.0), run("in motion", 2.0)],
                ..Group::default()
            }],
            line: vec![
                Point { strands: 1000, gpu: time(1.0), frame: time(3.0) },
                Point { strands: 100_000, gpu: time(100.0), frame: time(102.0) },
            ],
            costs: Costs {
                guides: 1000,
                parts: vec![Part { name: "solve".into(), time: time(4.0) }],
                limits: vec![Limit { what: "density / solve".into(), ratio: 0.25, most: 1.0 }],
                ..Costs::default()
            },
            ..Report::default()
        }
    }

    #[test]
    fn tables_are_aligned() {
        let report = report();
        let text = report.groups[0].text() + &report.costs_text() + &report.line_text();
        assert!(text.contains("990,016 triangles") && text.contains("1920 × 1200, 4×MSAA, 9 frames"));
        let line = |name: &str| text.lines().find(|l| l.trim_start().starts_with(name)).unwrap();
        assert_eq!(line("simulate").len(), line("whole frame").len());
        assert!(line("simulate").contains("0.250") && line("draw").contains("100.0"));
        assert!(line("solve").contains("4.00") && line("density / solve").contains("0.25"), "{text}");
        assert!(text.contains("2.00 ms + 1.00 ms per 1,000 strands"), "{text}");
    }

    #[test]
    fn json_holds_the_numbers() {
        let value = serde_json::to_value(report()).unwrap();
        assert_eq!(value["groups"][0]["runs"][1]["stages"][1]["median"], 100.0);
        assert_eq!(value["line"][0]["strands"], 1000);
        assert_eq!(value["costs"]["parts"][0]["median"], 4.0);
        assert_eq!(value["costs"]["limits"][0]["ratio"], 0.25);
    }
}
