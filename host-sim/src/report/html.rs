use std::path::Path;

use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;

use super::ReportError;
use super::page::{FindingPlace, Page};
use super::text::{grouped, usual};
use crate::diagnosis::Finding;
use crate::picture;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
/// In the order in which they stand in the page.
const SCRIPTS: [&str; 4] = [
    include_str!("page.js"),
    include_str!("waveform.js"),
    include_str!("charts.js"),
    include_str!("links.js"),
];

/// A finding as the page words it.
#[derive(Serialize)]
struct Card<'a> {
    finding: &'a Finding,
    name: String,
    about: &'static str,
    percent: String,
    place: String,
}

/// A row of the table of what was measured.
#[derive(Serialize)]
struct Fact(&'static str, String);

/// Writes the page as one file that needs nothing else, whole or not at all.
///
/// # Errors
/// [`ReportError`] if the file cannot be written.
pub fn write(page: &Page, path: &Path) -> Result<(), ReportError> {
    Ok(picture::write_raw(path, render(page)?.as_bytes())?)
}

/// The page as text.
fn render(page: &Page) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("grouped", |number: u64| grouped(number));
    environment.add_template("page", TEMPLATE)?;
    let numbers = serde_json::to_string(page).map_err(|error| ReportError::Numbers(error.to_string()))?;
    let cards: Vec<Card<'_>> = page
        .diagnosis
        .findings
        .iter()
        .zip(&page.places)
        .map(|(finding, place)| card(finding, place))
        .collect();
    let text = environment.get_template("page")?.render(context! {
        page => page,
        pictures => page.pictures,
        cards => cards,
        facts => measured(page),
        bits => bits(page),
        numbers => in_script(&numbers),
        style => STYLE,
        scripts => SCRIPTS.concat(),
        version => env!("CARGO_PKG_VERSION"),
    })?;
    Ok(text)
}

/// JSON that cannot end the script element that it stands in: the same value, in other letters.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn card<'a>(finding: &'a Finding, place: &FindingPlace) -> Card<'a> {
    let place = match (place.everywhere, place.frame, place.row) {
        (true, ..) => "everywhere".to_owned(),
        (_, Some(frame), Some(row)) => format!("clock {}, frame {frame}, row {row}", grouped(place.clock)),
        _ => format!("clock {}, in no frame that came", grouped(place.clock)),
    };
    Card {
        finding,
        name: finding.fault.to_string(),
        about: finding.fault.about(),
        percent: format!("{:.0}", 100.0 * finding.confidence),
        place,
    }
}

fn measured(page: &Page) -> Vec<Fact> {
    let measured = &page.diagnosis.measured;
    let clock =
        measured.pclk_hz.map_or("not known".to_owned(), |hertz| format!("{:.3} MHz", f64::from(hertz) / 1e6));
    vec![
        Fact("pixel clocks", grouped(measured.clocks)),
        Fact("pixel clock", clock),
        Fact("frames", grouped(measured.frames)),
        Fact("lines a frame", usual(&measured.lines_a_frame)),
        Fact("samples a line", usual(&measured.samples_a_line)),
        Fact("clocks between lines", usual(&measured.blanking_clocks)),
        Fact("clocks of VSYNC", usual(&measured.vsync_clocks)),
        Fact(
            "edges of HSYNC, of VSYNC",
            format!("{}, {}", grouped(measured.sync_edges.0), grouped(measured.sync_edges.1)),
        ),
        Fact("bits a sample", format!("{:.2}", measured.entropy_bits)),
    ]
}

/// A data wire: its name, how often it changes, and how often it agrees with the one below, in per cent.
#[derive(Serialize)]
struct Bit(String, f64, Option<f64>);

fn bits(page: &Page) -> Vec<Bit> {
    let measured = &page.diagnosis.measured;
    let wire = |(bit, toggling): (usize, &f64)| {
        let agreement = bit.checked_sub(1).and_then(|below| measured.agreement.get(below));
        Bit(format!("D{bit}"), 100.0 * toggling, agreement.map(|share| 100.0 * share))
    };
    measured.toggling.iter().enumerate().map(wire).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_is_called_does_not_become_markup() {
        let evil = "</script><img src=x onerror=alert(1)>&\"'.camt";
        let page = Page { trace: evil.to_owned(), notes: vec![evil.to_owned()], ..Page::default() };
        let html = render(&page).unwrap();
        assert!(!html.contains("<img src=x"), "in text and in numbers");
        assert_eq!(html.matches("</script>").count(), 2, "one for the numbers, one for the script");
        let (_, numbers) = html.split_once("id=\"numbers\">").unwrap();
        let (numbers, _) = numbers.split_once("</script>").unwrap();
        let value: serde_json::Value = serde_json::from_str(numbers).unwrap();
        assert_eq!(value["trace"], evil);
    }

    #[test]
    fn the_page_asks_for_nothing() {
        let html = render(&Page::default()).unwrap();
        for outside in ["http:", "https:", "src=\"/", "url(", "import "] {
            assert!(!html.contains(outside), "{outside}");
        }
        assert!(html.contains("default-src 'none'"));
    }
}
