//! Findings of the lint.

use glam::Vec3;

use super::{MIN_SEGMENT, MIN_STRAND, Spread};
use crate::{MAX_STRAND_VERTICES, Strands, TriMesh, mesh::bvh::Bvh};

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The importer changes something, or the hair may look wrong.
    Warning,
    /// The groom cannot be used unchanged.
    Error,
}

impl Severity {
    /// Returns the name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// Kind of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub enum FindingKind {
    /// Numbers that are not finite.
    NotFinite,
    /// Strands of fewer than two vertices.
    SingleVertex,
    /// Strands without length.
    ZeroLengthStrand,
    /// Vertices that equal the one before them.
    DuplicateVertex,
    /// Segments too short to have a direction.
    ZeroLengthSegment,
    /// Strands of more vertices than can be drawn.
    ManyVertices,
    /// Strands whose tip is pinned, as the root is.
    BothEndsPinned,
    /// Roots that lie off the head.
    RootsOff,
    /// More strands or vertices than usual.
    Huge,
    /// Widths that are unusual for hair.
    OddWidth,
    /// Strands that lie exactly on another.
    DuplicateStrand,
}

impl FindingKind {
    /// Returns the name in messages and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotFinite => "numbers that are not finite",
            Self::SingleVertex => "strands of one vertex",
            Self::ZeroLengthStrand => "zero-length strands",
            Self::DuplicateVertex => "duplicate vertices",
            Self::ZeroLengthSegment => "zero-length segments",
            Self::ManyVertices => "strands of many vertices",
            Self::BothEndsPinned => "both ends pinned",
            Self::RootsOff => "roots off the mesh",
            Self::Huge => "huge counts",
            Self::OddWidth => "odd widths",
            Self::DuplicateStrand => "duplicate strands",
        }
    }
}

/// An unusual property of a groom.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct Finding {
    /// Kind of the finding.
    pub kind: FindingKind,
    /// Severity of the finding.
    pub severity: Severity,
    /// Number of occurrences.
    pub count: usize,
    /// Index of the first affected strand, if the finding is about strands.
    pub first_strand: Option<usize>,
    /// Meaning for this groom, one clause.
    pub detail: String,
    /// Action of the importer, one clause.
    pub action: String,
}

/// Statistics and findings of a groom.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cooked", derive(serde::Serialize, serde::Deserialize))]
pub struct LintReport {
    /// Number of strands.
    pub strands: usize,
    /// Number of vertices of all strands.
    pub vertices: usize,
    /// Vertices per strand.
    pub per_strand: Spread,
    /// Lengths of strands, meters.
    pub lengths: Spread,
    /// Minimum and maximum corner of all finite vertices, meters.
    pub bounds: Option<(Vec3, Vec3)>,
    /// Radii, meters, if the groom has widths.
    pub radii: Option<Spread>,
    /// Distances of the roots to the head, meters, if a head is given.
    pub root_distance: Option<Spread>,
    /// Findings, the most severe first.
    pub findings: Vec<Finding>,
}

impl LintReport {
    /// Returns the finding of a kind, if there is one.
    pub fn find(&self, kind: FindingKind) -> Option<&Finding> {
        self.findings.iter().find(|f| f.kind == kind)
    }
}

/// Distance from the head above which roots are reported, meters.
const ROOT_TOLERANCE: f32 = 0.005;
/// Bytes that WebGPU guarantees to bind at once; a drawn vertex takes 16.
const PROMISED_BINDING: usize = 128 << 20;

/// Counts occurrences and stores the first affected strand.
#[derive(Default)]
struct Tally {
    count: usize,
    first: Option<usize>,
}

impl Tally {
    fn add(&mut self, count: usize, strand: usize) {
        if count > 0 {
            self.count += count;
            self.first.get_or_insert(strand);
        }
    }
}

/// Checks a groom in meters and, if a head is given, the distance of its roots to the head. Changes nothing.
pub fn check(strands: &Strands, head: Option<&TriMesh>) -> LintReport {
    let mut report = LintReport {
        strands: strands.len(),
        vertices: strands.positions.len(),
        per_strand: Spread::of(strands.iter().map(|s| s.len() as f32)).unwrap_or_default(),
        lengths: Spread::of((0..strands.len()).map(|i| strands.length(i))).unwrap_or_default(),
        radii: Spread::of(strands.radii.iter().copied()),
        ..Default::default()
    };
    let finite = strands.positions.iter().filter(|p| p.is_finite());
    report.bounds = finite.fold(None, |b, p| {
        let (lo, hi) = b.unwrap_or((*p, *p));
        Some((lo.min(*p), hi.max(*p)))
    });
    shape(strands, &mut report);
    pins(strands, &mut report);
    widths(&mut report);
    size(&mut report);
    if let Some(head) = head {
        roots(strands, head, &mut report);
    }
    report.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    report
}

fn shape(strands: &Strands, report: &mut LintReport) {
    let [mut nan, mut single, mut flat, mut same, mut short, mut many] = [(); 6].map(|()| Tally::default());
    for (i, s) in strands.iter().enumerate() {
        nan.add(s.iter().filter(|p| !p.is_finite()).count(), i);
        many.add((s.len() > MAX_STRAND_VERTICES as usize) as usize, i);
        if s.len() < 2 {
            single.add(1, i);
            continue;
        }
        if strands.length(i) < MIN_STRAND {
            flat.add(1, i);
            continue;
        }
        for w in s.windows(2) {
            let d = w[0].distance(w[1]);
            same.add((d == 0.0) as usize, i);
            short.add((d > 0.0 && d < MIN_SEGMENT) as usize, i);
        }
    }
    let mut add = |kind, severity, tally: Tally, detail: &str, action: &str| {
        if tally.count > 0 {
            let (detail, action) = (detail.into(), action.into());
            let (count, first_strand) = (tally.count, tally.first);
            report.findings.push(Finding { kind, severity, count, first_strand, detail, action });
        }
    };
    use Severity::{Error, Note, Warning};
    add(FindingKind::NotFinite, Error, nan, "vertices whose position is not finite", "the file is rejected");
    add(
        FindingKind::SingleVertex,
        Warning,
        single,
        "strands of one vertex; a strand needs two",
        "these strands are dropped",
    );
    add(
        FindingKind::ZeroLengthStrand,
        Warning,
        flat,
        "strands shorter than 0.1 mm",
        "these strands are dropped",
    );
    let merged = "each is merged with its neighbor; roots and tips stay in place";
    add(FindingKind::DuplicateVertex, Note, same, "vertices that equal the one before them", merged);
    add(FindingKind::ZeroLengthSegment, Note, short, "segments shorter than 0.01 mm", merged);
    let detail = format!("strands of more than {MAX_STRAND_VERTICES} vertices");
    let action = format!("they are resampled to {MAX_STRAND_VERTICES} evenly spaced vertices");
    add(FindingKind::ManyVertices, Warning, many, &detail, &action);
    let copies = copies(strands);
    add(
        FindingKind::DuplicateStrand,
        Note,
        copies,
        "strands that equal an earlier one",
        "they are kept and drawn twice",
    );
}

/// Counts strands that equal an earlier one in root, middle vertex, tip and number of vertices.
fn copies(strands: &Strands) -> Tally {
    let mut tally = Tally::default();
    let mut known = std::collections::HashSet::with_capacity(strands.len());
    for (i, s) in strands.iter().enumerate() {
        if let (Some(root), Some(tip)) = (s.first(), s.last()) {
            let bits = |p: &Vec3| p.to_array().map(f32::to_bits);
            tally.add((!known.insert((bits(root), bits(tip), bits(&s[s.len() / 2]), s.len()))) as usize, i);
        }
    }
    tally
}

fn pins(strands: &Strands, report: &mut LintReport) {
    let count = strands.tip_pinned.iter().filter(|p| **p).count();
    if count > 0 {
        report.findings.push(Finding {
            kind: FindingKind::BothEndsPinned,
            severity: Severity::Note,
            count,
            first_strand: strands.tip_pinned.iter().position(|p| *p),
            detail: "strands whose tip is fixed, as if tied into a band".into(),
            action: "root and tip both follow the head; the vertices between them are simulated".into(),
        });
    }
}

fn widths(report: &mut LintReport) {
    let Some(radii) = report.radii else { return };
    let odd = radii.min < 0.0 || radii.max == 0.0;
    if odd || radii.median > 3e-4 || radii.median < 5e-6 {
        report.findings.push(Finding {
            kind: FindingKind::OddWidth,
            severity: Severity::Note,
            count: report.vertices,
            first_strand: None,
            detail: format!(
                "widths with a median radius of {:.4} mm; a human hair has 0.03 to 0.05 mm",
                radii.median * 1e3
            ),
            action: if odd { "the file's widths are ignored" } else { "the file's widths are kept" }.into(),
        });
    }
}

fn size(report: &mut LintReport) {
    let bytes = report.vertices.saturating_mul(16);
    if report.strands > 500_000 || bytes > PROMISED_BINDING {
        report.findings.push(Finding {
            kind: FindingKind::Huge,
            severity: Severity::Warning,
            count: report.strands,
            first_strand: None,
            detail: format!("strands, whose vertices take {} MiB when drawn", bytes >> 20),
            action:
                "drawn in full if the adapter supports bindings of that size (WebGPU guarantees 128 MiB), otherwise rejected"
                    .into(),
        });
    }
}

fn roots(strands: &Strands, head: &TriMesh, report: &mut LintReport) {
    let bvh = Bvh::new(head);
    let distances: Vec<f32> = strands
        .iter()
        .map(|s| {
            s.first()
                .filter(|p| p.is_finite())
                .and_then(|p| bvh.closest_point(*p))
                .map_or(f32::NAN, |c| c.distance)
        })
        .collect();
    report.root_distance = Spread::of(distances.iter().copied());
    let off = |d: &&f32| **d > ROOT_TOLERANCE;
    let count = distances.iter().filter(off).count();
    if let (Some(spread), true) = (report.root_distance, count > 0) {
        let bad = 4 * count > strands.len();
        let mut action = "they are kept where they are and move with the head".to_string();
        if bad {
            action += "; if the hair is misplaced, set unit, axes or mirroring";
        }
        report.findings.push(Finding {
            kind: FindingKind::RootsOff,
            severity: if bad { Severity::Warning } else { Severity::Note },
            count,
            first_strand: distances.iter().position(|d| *d > ROOT_TOLERANCE),
            detail: format!(
                "roots more than 5 mm from the mesh, the farthest {:.0} mm (hair tied into a band has its roots there)",
                spread.max * 1e3
            ),
            action,
        });
    }
}
