//! `tresses info`: reports the contents of a groom and its problems.

use std::path::{Path, PathBuf};

use anyhow::bail;
use serde_json::{Value, json};
use tresses::groom::{
    BindOptions, Look, TriMesh,
    import::{self, ImportReport},
    lint::{LintReport, Severity, Spread},
    orient::Placement,
    rig::Rig,
};
use tresses_scene::{
    Anatomy,
    anatomy::{BodyPart, Capsule, PartForm, capsule::STANDS_OUT},
};

use crate::orient_args::{MomentArgs, OrientArgs};

/// Report the contents of a groom, its orientation, and its problems.
#[derive(clap::Args)]
pub struct InfoArgs {
    #[arg(required = true, value_name = "FILE", help = crate::args::grooms_help("several are one groom"))]
    files: Vec<PathBuf>,
    #[arg(long, value_name = "MESH", help = crate::args::head_help("several are one head"))]
    head: Vec<PathBuf>,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    moment: MomentArgs,
    #[command(flatten)]
    orient: OrientArgs,
}

/// Runs the command.
pub fn run(args: InfoArgs) -> anyhow::Result<()> {
    let mut strict = args.orient.options();
    strict.moment = args.moment.moment();
    // First report numbers that are not finite as findings, then fail on them as other commands do.
    let mut options = strict.clone();
    options.allows_non_finite = true;
    options.skips_repair = true;
    let (strands, head, report) = import::read_complete(&args.files, &args.head, &options)?;
    // Errors in the strands are reported below.
    let of = |(rig, head): (&Rig, &TriMesh)| Anatomy::new(rig.clone(), head, strands.iter()).ok();
    let anatomy = report.rig.as_ref().zip(head.as_ref()).and_then(of);
    if args.json {
        println!("{}", serde_json::to_string_pretty(&as_json(&report, anatomy.as_ref()))?);
    } else {
        print!("{}", as_text(&report, anatomy.as_ref()));
    }
    if report.lint.findings.iter().any(|f| f.severity == Severity::Error) {
        import::read(&args.files, &strict)?;
        bail!("{}: the groom has errors and cannot be used", args.files[0].display());
    }
    Ok(())
}

fn as_json(report: &ImportReport, anatomy: Option<&Anatomy>) -> Value {
    let spread = |s: &Spread| json!({"min": s.min, "median": s.median, "p95": s.p95, "max": s.max});
    let placement = |p: &Placement| {
        json!({
            "meters_per_unit": p.unit.0, "up": p.up.name(), "front": p.front.name(),
            "mirrored": p.mirrored, "translation": p.translation.to_array(),
            "reasons": p.reasons, "doubts": p.doubts,
        })
    };
    let lint = &report.lint;
    json!({
        "files": report.files.iter().map(|f| json!({
            "path": f.path.display().to_string(), "format": f.format,
            "strands": f.strands, "vertices": f.vertices, "notes": f.notes,
        })).collect::<Vec<_>>(),
        "strands": lint.strands,
        "vertices": lint.vertices,
        "with_followers": (!report.followers.is_empty()).then(|| report.with_followers()),
        "vertices_per_strand": spread(&lint.per_strand),
        "length_m": spread(&lint.lengths),
        "radius_m": lint.radii.as_ref().map(spread),
        "has": {
            "widths": report.attributes.widths, "colors": report.attributes.colors,
            "root_uvs": report.attributes.root_uvs, "ids": report.attributes.ids,
            "guides": report.attributes.guides, "bound_to_guides": report.attributes.bound,
            "simulated": simulated(report), "attributes": report.attributes.custom,
        },
        "groups": report.groups.iter().map(|group| json!({
            "id": group.id, "name": group.name, "strands": group.strands, "guides": group.guides,
        })).collect::<Vec<_>>(),
        "bounds_m": lint.bounds.map(|(lo, hi)| [lo.to_array(), hi.to_array()]),
        "root_distance_m": lint.root_distance.as_ref().map(spread),
        "look": report.look.map(|look| json!({
            "melanin": [look.eumelanin, look.pheomelanin], "roughness": look.roughness,
            "cuticle_tilt": look.tilt, "ior": look.ior,
        })),
        "groom_placement": placement(&report.placement),
        "head_placement": report.head_placement.as_ref().map(placement),
        "body": report.rig.as_ref().map(|rig| json!({
            "joints": rig.joints.len(), "nodes": rig.nodes.len(),
            "animations": rig.animations.iter()
                .map(|it| json!({"name": it.name, "seconds": it.length})).collect::<Vec<_>>(),
            "shapes": rig.targets.iter().map(|target| &target.name).collect::<Vec<_>>(),
            "hair_goes_with": anatomy.map(|anatomy| anatomy.name(anatomy.head.node)),
            "parts": anatomy.map(|anatomy| {
                anatomy.parts.iter().map(|part| part_as_json(anatomy, part)).collect::<Vec<_>>()
            }),
        })),
        "findings": lint.findings.iter().map(|f| json!({
            "kind": f.kind.name(), "severity": f.severity.name(), "count": f.count,
            "first_strand": f.first_strand, "detail": f.detail, "action": f.action,
        })).collect::<Vec<_>>(),
    })
}

fn as_text(report: &ImportReport, anatomy: Option<&Anatomy>) -> String {
    let mut out = String::new();
    for file in &report.files {
        line(
            &mut out,
            &name(&file.path),
            format!("{}, {} strands, {} vertices", file.format, file.strands, file.vertices),
        );
        file.notes.iter().for_each(|n| line(&mut out, "", n.clone()));
    }
    measures(&mut out, &report.lint);
    attributes(&mut out, report);
    if let Some(look) = &report.look {
        let Look { eumelanin, pheomelanin, roughness: [along, around], tilt, ior } = look;
        let tilt = tilt.to_degrees();
        line(
            &mut out,
            "material",
            format!(
                "melanin {eumelanin}, {pheomelanin}; roughness {along}, {around}; cuticle angle {tilt:.1}°; IOR {ior}"
            ),
        );
    }
    if let Some(text) = followers(report) {
        line(&mut out, "interpolated", text);
        line(
            &mut out,
            "",
            "--grow 0 draws only the strands of the file, --grow N fills the groom to N strands".to_string(),
        );
    }
    if let Some(head) = &report.head_placement {
        orientation(&mut out, "head", head);
    }
    if let Some(rig) = &report.rig {
        bends(&mut out, rig);
        anatomy.iter().for_each(|anatomy| parts(&mut out, anatomy));
    }
    orientation(&mut out, "groom", &report.placement);
    let findings = &report.lint.findings;
    let certain = report.head_placement.iter().chain([&report.placement]).all(|p| p.doubts.is_empty());
    out += &match findings.len() {
        0 if certain => "\nNo problems were found.\n".to_string(),
        0 => "\nThe strands have no problems. Unit or axes are uncertain, see above.\n".to_string(),
        1 => "\n1 finding\n".to_string(),
        n => format!("\n{n} findings\n"),
    };
    for f in findings {
        let first = f.first_strand.map(|s| format!(" (first in strand {s})")).unwrap_or_default();
        out += &format!("  {:7}  {}: {} {}{first}\n", f.severity.name(), f.kind.name(), f.count, f.detail);
        out += &format!("           → {}\n", f.action);
    }
    out
}

/// Adds the attributes of the strands.
fn attributes(out: &mut String, report: &ImportReport) {
    let has = &report.attributes;
    let all = [
        ("widths", has.widths),
        ("colors", has.colors),
        ("scalp coordinates", has.root_uvs),
        ("strand IDs", has.ids),
    ];
    let list = |present: bool| {
        let some: Vec<_> = all.iter().filter(|(_, has)| *has == present).map(|(name, _)| *name).collect();
        if some.is_empty() { "none".into() } else { some.join(", ") }
    };
    line(out, "has", format!("{} (missing: {})", list(true), list(false)));
    if !has.custom.is_empty() {
        line(out, "attributes", has.custom.join(", "));
    }
    let bound = match has.bound {
        0 => String::new(),
        count => format!("; {count} strands name the guide they follow"),
    };
    let text = match has.guides {
        0 => format!(
            "none marked in the file: {} of the strands are simulated (set with --guides or --grow)",
            simulated(report)
        ),
        marked => format!("{marked} of the strands{bound}"),
    };
    line(out, "guides", text);
    for (i, group) in report.groups.iter().enumerate() {
        // A file may have as many groups as strands.
        if i == MAX_GROUPS {
            line(out, "", format!("and {} more", report.groups.len() - i));
            break;
        }
        let label = if i == 0 { "groups" } else { "" };
        let guides =
            if group.guides > 0 { format!(", {} of them guides", group.guides) } else { String::new() };
        let name = if group.name.is_empty() { String::new() } else { format!(" {}", group.name) };
        line(out, label, format!("{}{name}: {} strands{guides}", group.id, group.strands));
    }
}

/// Returns the number of strands that are simulated with default options.
fn simulated(report: &ImportReport) -> usize {
    match report.attributes.guides {
        0 => {
            let given = report.lint.strands;
            BindOptions::default().guides.among(given.max(report.with_followers() as usize)).min(given)
        }
        marked => marked,
    }
}

/// Most groups that are listed.
const MAX_GROUPS: usize = 12;

/// Describes the interpolated strands that the files request, if any.
fn followers(report: &ImportReport) -> Option<String> {
    let all = &report.followers;
    let max_count = all.iter().map(|f| f.count).max().filter(|count| *count > 0)?;
    let min_count = all.iter().map(|f| f.count).min().unwrap_or(max_count);
    let count =
        if min_count == max_count { max_count.to_string() } else { format!("{min_count} to {max_count}") };
    let radius = all.iter().filter_map(|f| f.radius).reduce(f32::max);
    let within = radius.map_or(String::new(), |radius| format!(" within {:.2} mm", 1e3 * radius));
    Some(format!("{count} around each strand{within}: {} strands are drawn", report.with_followers()))
}

fn measures(out: &mut String, lint: &LintReport) {
    let three = |s: &Spread, scale: f32, digits: usize| {
        let [a, b, c] = [s.min, s.median, s.max].map(|v| format!("{:.digits$}", v * scale));
        format!("{a} / {b} / {c}")
    };
    line(out, "strands", lint.strands.to_string());
    line(out, "vertices", lint.vertices.to_string());
    line(out, "per strand", format!("{} (min / median / max)", three(&lint.per_strand, 1.0, 0)));
    line(out, "length", format!("{} cm", three(&lint.lengths, 100.0, 2)));
    if let Some(radii) = &lint.radii {
        line(out, "radius", format!("{} mm", three(radii, 1000.0, 4)));
    }
    if let Some((lo, hi)) = lint.bounds {
        line(out, "bounds", format!("{lo:.3} to {hi:.3} m"));
    }
    if let Some(d) = &lint.root_distance {
        let values = [d.median, d.p95, d.max].map(|v| format!("{:.2}", v * 1e3)).join(" / ");
        line(out, "root to scalp", format!("{values} mm (median / 95 % / max)"));
    }
}

/// Adds joints, animations and morph targets of the body, by the names that `--animation` and `--morph` take.
fn bends(out: &mut String, rig: &Rig) {
    line(out, "body", format!("{} joints, {} nodes", rig.joints.len(), rig.nodes.len()));
    for animation in &rig.animations {
        line(out, "", format!("animation {}, {:.2} s", animation.name, animation.length));
    }
    rig.targets.iter().for_each(|target| line(out, "", format!("blend shape {}", target.name)));
}

/// Adds the colliders of the body, by the names that a collider file takes.
fn parts(out: &mut String, anatomy: &Anatomy) {
    let head = anatomy.name(anatomy.head.node);
    line(out, "colliders", format!("{head}: distance field of the head, which carries the hair"));
    for part in &anatomy.parts {
        let form = match part.form {
            PartForm::Field => "field",
            PartForm::Capsule(_) => "capsule",
            PartForm::Nothing => "none",
        };
        let name = anatomy.name(part.node);
        line(out, "", format!("{name}: {form}, {} vertices{}", part.vertices, fitted(part)));
    }
}

/// Describes the capsule that fits a part best, and its error.
fn fitted(part: &BodyPart) -> String {
    let Some(fitted) = part.fitted else { return "; no capsule fits".into() };
    let Capsule { ends: [a, b], radius } = fitted.capsule;
    let (off, missed, out) = (1e3 * fitted.off, 1e2 * fitted.missed, 1e3 * STANDS_OUT);
    format!(
        "; best capsule: {a:.3} to {b:.3} m, radius {:.1} mm, error {off:.1} mm, {missed:.0} % outside by more than {out} mm",
        1e3 * radius
    )
}

fn part_as_json(anatomy: &Anatomy, part: &BodyPart) -> Value {
    let capsule = |capsule: Capsule| {
        let [from, to] = capsule.ends.map(|end| end.to_array());
        json!({"capsule": {"from": from, "to": to, "radius": capsule.radius}})
    };
    json!({
        "joint": anatomy.name(part.node),
        "shape": match part.form {
            PartForm::Field => json!("field"),
            PartForm::Capsule(shape) => capsule(shape),
            PartForm::Nothing => json!("none"),
        },
        "vertices": part.vertices,
        "fit": part.fitted.map(|fitted| json!({
            "shape": capsule(fitted.capsule), "off_m": fitted.off, "missed": fitted.missed,
        })),
    })
}

fn orientation(out: &mut String, what: &str, p: &Placement) {
    let mirrored = if p.mirrored { ", mirrored" } else { "" };
    line(
        out,
        what,
        format!("{} m per unit, up {}, face {}{mirrored}", p.unit.0, p.up.name(), p.front.name()),
    );
    p.reasons.iter().for_each(|r| line(out, "", r.clone()));
    p.doubts.iter().for_each(|d| line(out, "", format!("uncertain: {d}")));
}

fn line(out: &mut String, label: &str, value: String) {
    *out += &format!("{label:14} {value}\n");
}

fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}
