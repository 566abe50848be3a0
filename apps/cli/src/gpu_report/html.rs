//! The report as one HTML file without links to others.

use super::{
    report::{HostInfo, Report},
    section::{PartState, ReportFigure, ReportSection, Table},
};
use crate::bench::Machine;
use serde_json::Value;

/// Style of the page.
const STYLE: &str = "
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem; max-width: 75rem; color: #222; background: #fff }
table { border-collapse: collapse; margin: .5rem 0 1rem; font-size: 13px; display: block; overflow-x: auto }
th, td { border: 1px solid #ccc; padding: .1rem .5rem; text-align: left; vertical-align: top }
td.number { text-align: right; font-variant-numeric: tabular-nums }
figure { display: inline-block; margin: .5rem 1rem .5rem 0; font-size: 13px }
figure span { display: inline-block; margin-right: .3rem }
img { display: block; image-rendering: pixelated }
.finding { color: #a00000; font-weight: bold }
pre { background: #f4f4f4; padding: .5rem; overflow-x: auto; font-size: 12px }
";

/// Returns the page of `report`. Its first line is the verdict.
pub fn page(report: &Report) -> String {
    let HostInfo { version, machine, environment } = &report.host;
    let Machine { system, processor, cores, build, commit, is_changed, date } = machine;
    let changed = if *is_changed { " with local changes" } else { "" };
    let facts = [
        format!("tresses {version}, {build} build"),
        format!("{commit}{changed}"),
        format!("{system}, {cores} cores"),
        processor.clone(),
        date.clone(),
        environment.join(" "),
    ];
    let facts: Vec<_> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
    let sections: String = report.sections.iter().map(section).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>tresses gpu</title>\
         <style>{STYLE}</style></head><body>\n<p><strong>{}</strong></p>\n<p>{}</p>\n{sections}</body></html>\n",
        escaped(&report.verdict),
        escaped(&facts.join("; ")),
    )
}

fn section(section: &ReportSection) -> String {
    let state = match section.state {
        PartState::Running => " (not finished)",
        PartState::Complete => "",
        PartState::Failed => " (failed)",
    };
    let paragraph = |class: &str, text: &String| format!("<p{class}>{}</p>\n", escaped(text));
    let mut page = format!("<h2>{}{state}</h2>\n", escaped(&section.about));
    page.extend(section.findings.iter().map(|text| paragraph(" class=\"finding\"", text)));
    page.extend(section.notes.iter().map(|text| paragraph("", text)));
    page.extend(section.tables.iter().map(table));
    page.extend(section.figures.iter().map(figure));
    if !section.messages.is_empty() {
        page += &format!(
            "<details><summary>Messages</summary><pre>{}</pre></details>\n",
            escaped(&section.messages)
        );
    }
    page + &format!("<p>{:.1} s</p>\n", section.seconds)
}

fn table(table: &Table) -> String {
    let head: String = table.columns.iter().map(|column| format!("<th>{}</th>", escaped(column))).collect();
    let row = |row: &Vec<Value>| format!("<tr>{}</tr>\n", row.iter().map(cell).collect::<String>());
    let rows: String = table.rows.iter().map(row).collect();
    let (title, is_long) = (escaped(&table.title), table.rows.len() > 40);
    let body = format!("<table><tr>{head}</tr>\n{rows}</table>");
    if is_long {
        format!("<details><summary>{title}, {} rows</summary>{body}</details>\n", table.rows.len())
    } else {
        format!("<h3>{title}</h3>{body}\n")
    }
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => "<td></td>".into(),
        Value::Bool(yes) => format!("<td>{}</td>", if *yes { "yes" } else { "no" }),
        Value::Number(number) => {
            let text = match number.as_f64().filter(|_| number.is_f64()) {
                Some(value) => significant(value),
                None => number.to_string(),
            };
            format!("<td class=\"number\">{text}</td>")
        }
        Value::String(text) => format!("<td>{}</td>", escaped(text)),
        other => format!("<td>{}</td>", escaped(&other.to_string())),
    }
}

fn figure(figure: &ReportFigure) -> String {
    let image = |(label, png): &(String, String)| {
        format!(
            "<span>{0}<img alt=\"{0}\" src=\"data:image/png;base64,{1}\"></span>",
            escaped(label),
            escaped(png)
        )
    };
    let images: String = figure.images.iter().map(image).collect();
    format!("<figure><figcaption>{}</figcaption>{images}</figure>\n", escaped(&figure.caption))
}

/// Formats a number with about four significant digits.
fn significant(value: f64) -> String {
    let digits = match value.abs() {
        0.0..1.0 => 4,
        1.0..10.0 => 3,
        10.0..100.0 => 2,
        100.0..1000.0 => 1,
        _ => 0,
    };
    format!("{value:.digits$}")
}

/// Escapes text for HTML, also inside quoted attributes.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(escaped("<b a=\"'&'\">"), "&lt;b a=&quot;&#39;&amp;&#39;&quot;&gt;");
        assert_eq!(escaped("plain é"), "plain é");
    }

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!([0.01234, 1.2341, 12.341, 1234.1].map(significant), ["0.0123", "1.234", "12.34", "1234"]);
        assert_eq!(cell(&json!(200)), "<td class=\"number\">200</td>");
        assert_eq!(cell(&json!(f64::NAN)), "<td></td>");
    }

    #[test]
    fn page_escapes_all_text() {
        let bad = || "<script>".to_owned();
        let section = ReportSection {
            about: bad(),
            findings: vec![bad()],
            notes: vec![bad()],
            tables: vec![Table { title: bad(), columns: vec![bad()], rows: vec![vec![json!(bad())]] }],
            figures: vec![ReportFigure { caption: bad(), images: vec![(bad(), bad())] }],
            messages: bad(),
            ..ReportSection::default()
        };
        let report = Report { verdict: bad(), host: HostInfo::current(), sections: vec![section] };
        let page = page(&report);
        assert!(!page.contains("<script>") && page.contains("&lt;script&gt;"), "{page}");
        let verdict = page.find("<p><strong>").unwrap();
        assert!(verdict < page.find("<h2>").unwrap());
    }
}
