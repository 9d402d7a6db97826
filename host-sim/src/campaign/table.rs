use std::collections::BTreeMap;
use std::fmt;

use super::case::CaseResult;
use crate::fault::FaultKind;

/// What came of the cases of one class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Row {
    cases: u64,
    /// The frames received were those sent.
    masked: u64,
    masked_named: u64,
    /// Of the others: found at all, the right class first, among the first two.
    flagged: u64,
    first: u64,
    second: u64,
    /// Other classes that came first.
    mistaken: BTreeMap<FaultKind, u64>,
}

/// What came of all cases: the confusion table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    rows: BTreeMap<FaultKind, Row>,
    clean: u64,
    alarms: u64,
}

impl Table {
    /// Counts results.
    #[must_use]
    pub fn of(results: &[CaseResult]) -> Self {
        let mut table = Self::default();
        for result in results {
            let Some(class) = result.class else {
                table.clean += 1;
                table.alarms += u64::from(!result.found.is_empty());
                continue;
            };
            let row = table.rows.entry(class).or_default();
            let place = result.found.iter().position(|(found, ..)| *found == class);
            row.cases += 1;
            if result.intact {
                row.masked += 1;
                row.masked_named += u64::from(place == Some(0));
                continue;
            }
            row.flagged += u64::from(!result.found.is_empty());
            row.first += u64::from(place == Some(0));
            row.second += u64::from(place.is_some_and(|place| place < 2));
            if let (Some((found, ..)), true) = (result.found.first(), place != Some(0)) {
                *row.mistaken.entry(*found).or_default() += 1;
            }
        }
        table
    }

    fn total(&self, count: impl Fn(&Row) -> u64) -> u64 {
        self.rows.values().map(count).sum()
    }

    /// What is short of the bars, in words; none if all are reached.
    #[must_use]
    pub fn shortfalls(&self) -> Vec<String> {
        let shown = self.total(|row| row.cases - row.masked);
        let mut short = Vec::new();
        let unflagged = shown - self.total(|row| row.flagged);
        if unflagged > 0 {
            short.push(format!("{unflagged} corrupt cases of {shown} were not flagged; the bar is none"));
        }
        if self.alarms > 0 {
            short.push(format!(
                "{} of {} clean traces raised an alarm; the bar is none",
                self.alarms, self.clean
            ));
        }
        for (count, percent, what) in [
            (self.total(|row| row.first), 95, "the right class first"),
            (self.total(|row| row.second), 99, "the right class among the first two"),
        ] {
            if count * 100 < shown * percent {
                short.push(format!("{what} in {count} of {shown}; the bar is {percent} %"));
            }
        }
        short
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| fault | cases | masked (named) | shown | flagged | right first | among two | mistaken for |"
        )?;
        writeln!(f, "|---|---:|---:|---:|---:|---:|---:|---|")?;
        let mut sum = Row::default();
        for (kind, row) in &self.rows {
            let mistaken: Vec<String> =
                row.mistaken.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
            line(f, &format!("`{kind}`"), row, &mistaken.join(", "))?;
            sum.cases += row.cases;
            sum.masked += row.masked;
            sum.masked_named += row.masked_named;
            sum.flagged += row.flagged;
            sum.first += row.first;
            sum.second += row.second;
        }
        line(f, "all", &sum, "")?;
        writeln!(f)?;
        write!(f, "Clean traces: {}; false alarms: {}.", self.clean, self.alarms)
    }
}

fn line(f: &mut fmt::Formatter<'_>, name: &str, row: &Row, mistaken: &str) -> fmt::Result {
    let shown = row.cases - row.masked;
    let masked =
        if row.masked == 0 { String::new() } else { format!("{} ({})", row.masked, row.masked_named) };
    let percent = |count: u64| {
        if shown == 0 { String::new() } else { format!("{:.1} %", 100.0 * count as f64 / shown as f64) }
    };
    writeln!(
        f,
        "| {name} | {} | {masked} | {shown} | {} | {} | {} | {mistaken} |",
        row.cases,
        percent(row.flagged),
        percent(row.first),
        percent(row.second)
    )
}
