//! The studio's theme: muted and dark, so that the hair is the brightest thing.

use eframe::egui::{self, Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Visuals, vec2};

/// Selected or highlighted items.
pub const ACCENT: Color32 = Color32::from_rgb(0xe2, 0xa8, 0x63);
/// Background of panels.
pub const PANEL: Color32 = Color32::from_rgb(0x1a, 0x1b, 0x1d);
/// Background of buttons and fields.
pub const WIDGET: Color32 = Color32::from_rgb(0x2a, 0x2c, 0x30);
/// Lines between panels.
pub const LINE: Color32 = Color32::from_rgb(0x2c, 0x2e, 0x32);
/// Secondary text.
pub const QUIET: Color32 = Color32::from_rgb(0x8e, 0x92, 0x99);
/// Text.
pub const TEXT: Color32 = Color32::from_rgb(0xd4, 0xd6, 0xda);
/// Errors.
pub const ALARM: Color32 = Color32::from_rgb(0xe5, 0x73, 0x5f);

/// Applies the theme to `context`.
pub fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    // No time limit for clicks: if a frame takes seconds, press and release are seen too far apart.
    context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
    let mut visuals = Visuals::dark();
    // The window is cleared in the panels' color.
    visuals.panel_fill = Color32::TRANSPARENT;
    visuals.window_fill = Color32::from_rgb(0x20, 0x21, 0x24);
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.extreme_bg_color = Color32::from_rgb(0x12, 0x13, 0x14);
    visuals.faint_bg_color = Color32::from_rgb(0x1f, 0x20, 0x23);
    visuals.selection.bg_fill = Color32::from_rgb(0x5e, 0x49, 0x2f);
    visuals.selection.stroke = Stroke::new(1.0, ACCENT);
    visuals.hyperlink_color = ACCENT;
    visuals.warn_fg_color = ACCENT;
    visuals.error_fg_color = ALARM;
    visuals.slider_trailing_fill = true;
    visuals.weak_text_color = Some(QUIET);
    let radius = CornerRadius::same(4);
    let widgets = &mut visuals.widgets;
    for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active, &mut widgets.open] {
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    widgets.inactive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.inactive.weak_bg_fill = WIDGET;
    widgets.inactive.bg_fill = WIDGET;
    widgets.hovered.weak_bg_fill = Color32::from_rgb(0x36, 0x39, 0x3e);
    widgets.hovered.bg_fill = Color32::from_rgb(0x40, 0x43, 0x49);
    widgets.hovered.bg_stroke = Stroke::NONE;
    widgets.active.weak_bg_fill = Color32::from_rgb(0x45, 0x3a, 0x2a);
    widgets.active.bg_fill = ACCENT;
    widgets.active.bg_stroke = Stroke::NONE;
    widgets.open.weak_bg_fill = Color32::from_rgb(0x30, 0x32, 0x36);
    context.set_visuals_of(egui::Theme::Dark, visuals);
    context.style_mut_of(egui::Theme::Dark, |style| {
        style.spacing.item_spacing = vec2(8.0, 6.0);
        style.spacing.button_padding = vec2(9.0, 4.0);
        style.spacing.interact_size.y = 22.0;
        style.spacing.slider_width = 110.0;
        style.spacing.slider_rail_height = 4.0;
        style.spacing.tooltip_width = 320.0;
        style.interaction.tooltip_delay = 0.35;
        style.interaction.selectable_labels = false;
        let font = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles.insert(TextStyle::Body, font(13.0));
        style.text_styles.insert(TextStyle::Button, font(13.0));
        style.text_styles.insert(TextStyle::Small, font(11.0));
        style.text_styles.insert(TextStyle::Heading, font(15.0));
        style.text_styles.insert(TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace));
    });
}

/// Returns a dark backdrop for controls over the viewport.
pub fn plate() -> egui::Frame {
    egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(0x16, 0x17, 0x19, 205))
        .corner_radius(6.0)
        .inner_margin(egui::Margin::symmetric(6, 6))
}
