//! The groom: facts, findings of the lint, and options that reimport it.

use crate::{
    document::Document, hair::HairSource, messages::Messages, panels::body, renderer::StudioRenderer, theme,
};
use eframe::egui::{self, ComboBox, Grid, RichText, ScrollArea, Ui};
use tresses::groom::{
    formats,
    import::{ImportOptions, ImportReport},
    lint::Severity,
    orient::{Axis, LengthUnit, OrientationOverride, Placement},
};
use tresses_scene::words::grouped;

/// Shows the page.
pub fn show(document: &mut Document, renderer: &mut StudioRenderer, messages: &mut Messages, ui: &mut Ui) {
    ScrollArea::vertical().id_salt("groom").auto_shrink(false).show(ui, |ui| {
        facts(renderer, ui);
        body::shapes(renderer, ui);
        let Some(shown) = &document.shown else { return };
        for note in &shown.notes {
            ui.separator();
            ui.label(RichText::new(note).color(theme::ACCENT));
        }
        let Some(report) = &shown.base.report else { return };
        ui.separator();
        findings(report, ui);
        ui.separator();
        let HairSource::Files { files, options } = &shown.hair.source else { return };
        // A cooked or edited groom is always in meters and upright.
        if report.files.iter().any(|file| formats::is_complete_groom(&file.path)) {
            return;
        }
        let mut changed = options.clone();
        orientation(&mut changed, report, ui);
        if changed != *options {
            let source = HairSource::Files { files: files.clone(), options: changed };
            document.open(source, messages);
        }
    });
}

fn facts(renderer: &StudioRenderer, ui: &mut Ui) {
    let Some(show) = &renderer.show else { return };
    let facts = show.facts();
    Grid::new("facts").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (name, value, help) in [
            ("Strands", grouped(facts.strands.into()), "Strands drawn at full detail"),
            (
                "Vertices per strand",
                facts.vertices_per_strand.to_string(),
                "Vertices of each drawn strand; files may have fewer",
            ),
            ("Triangles", grouped(facts.triangles), "Triangles in the current frame"),
            ("Guides", grouped(facts.guides.into()), "Simulated strands, which the others follow"),
            (
                "GPU memory",
                format!("{:.1} MB", facts.bytes as f64 / 1e6),
                "GPU memory of the groom, without render targets",
            ),
        ] {
            ui.label(RichText::new(name).color(theme::QUIET)).on_hover_text(help);
            ui.label(value);
            ui.end_row();
        }
    });
}

fn findings(report: &ImportReport, ui: &mut Ui) {
    for file in &report.files {
        ui.label(format!("{}, {} strands", file.format, grouped(file.strands as u64)));
    }
    if report.lint.findings.is_empty() {
        ui.label(RichText::new("No problems were found.").color(theme::QUIET));
    }
    for finding in &report.lint.findings {
        let color = match finding.severity {
            Severity::Error => theme::ALARM,
            Severity::Warning => theme::ACCENT,
            Severity::Note => theme::QUIET,
        };
        ui.label(
            RichText::new(format!("{} ({})", finding.kind.name(), grouped(finding.count as u64)))
                .color(color),
        );
        let more = format!("{}; {}", finding.detail, finding.action);
        ui.label(RichText::new(more).small().color(theme::QUIET));
    }
}

/// Shows unit and axes of the groom, and of the head if there is one.
fn orientation(options: &mut ImportOptions, report: &ImportReport, ui: &mut Ui) {
    placement("Groom", &mut options.orient, &report.placement, ui);
    if let Some(head) = &report.head_placement {
        ui.add_space(6.0);
        placement("Head", &mut options.orient_head, head, ui);
    }
}

fn placement(title: &str, choice: &mut OrientationOverride, found: &Placement, ui: &mut Ui) {
    ui.label(RichText::new(title).strong()).on_hover_text(found.reasons.join("\n"));
    Grid::new(("placement", title)).num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        ui.label(RichText::new("Unit").color(theme::QUIET));
        pick(
            ui,
            (title, "unit"),
            &mut choice.unit,
            found.unit,
            &LengthUnit::KNOWN.map(|known| LengthUnit(known.1)),
            |u| u.name(),
        );
        ui.end_row();
        ui.label(RichText::new("Up").color(theme::QUIET));
        pick(ui, (title, "up"), &mut choice.up, found.up, &Axis::ALL, |axis| axis.name().into());
        ui.end_row();
        ui.label(RichText::new("Front").color(theme::QUIET));
        pick(ui, (title, "front"), &mut choice.front, found.front, &Axis::ALL, |axis| axis.name().into());
        ui.end_row();
    });
}

/// Shows a choice with an automatic option.
fn pick<T: Copy + PartialEq>(
    ui: &mut Ui,
    id: (&str, &str),
    choice: &mut Option<T>,
    guess: T,
    all: &[T],
    name: impl Fn(T) -> String,
) {
    let text = match choice {
        Some(selected) => name(*selected),
        None => format!("{} (guessed)", name(guess)),
    };
    ComboBox::from_id_salt(id)
        .selected_text(text)
        .width(120.0)
        .show_ui(ui, |ui: &mut egui::Ui| {
            ui.selectable_value(choice, None, format!("Guess: {}", name(guess)));
            for each in all {
                ui.selectable_value(choice, Some(*each), name(*each));
            }
        })
        .response
        .on_hover_text("Reload the file with another choice");
}
