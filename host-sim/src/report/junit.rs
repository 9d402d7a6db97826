use std::collections::BTreeSet;

use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

use super::ReportError;
use crate::campaign::CaseResult;
use crate::diagnosis::{Diagnosis, FaultKind};

/// A diagnosis as a CI shows it: JUnit XML, a test case for each class of faults, in which a finding is a failure. A class that no
/// trace shows is skipped.
///
/// # Errors
/// [`ReportError`] if the XML cannot be written, which is a bug.
pub fn junit(trace: &str, profile: &str, diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let mut suite = TestSuite::new(trace);
    suite.add_property(Property::new("profile", profile));
    suite.add_property(Property::new("place", diagnosis.place.to_string()));
    suite.add_property(Property::new("pixel clocks", diagnosis.measured.clocks.to_string()));
    for kind in FaultKind::all() {
        let mut case = TestCase::new(kind.to_string(), status(kind, diagnosis));
        case.set_classname(format!("diagnose.{profile}"));
        suite.add_test_case(case);
    }
    let mut report = Report::new("host-sim diagnose");
    report.add_test_suite(suite);
    report.to_string().map_err(|error| ReportError::Numbers(error.to_string()))
}

fn status(kind: FaultKind, diagnosis: &Diagnosis) -> TestCaseStatus {
    if let Some(finding) = diagnosis.findings.iter().find(|finding| finding.fault == kind) {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
        let percent = 100.0 * finding.confidence;
        let line = finding.line.map(|line| format!(", line {line}")).unwrap_or_default();
        status.set_type(kind.to_string());
        status.set_message(format!("{} ({percent:.0} %)", kind.about()));
        status.set_description(format!(
            "clock {}{line}: {}\nremedy: {}",
            finding.at_pclk, finding.evidence.text, finding.remedy
        ));
        return status;
    }
    if kind == FaultKind::RedBlueSwap {
        let mut status = TestCaseStatus::skipped();
        status.set_message("no trace tells red and blue apart");
        return status;
    }
    TestCaseStatus::success()
}

/// Cases that a failure lists.
const LISTED: usize = 20;

/// A campaign as a CI shows it: JUnit XML, a test case for each class of faults, which fails if a corrupt trace was not flagged or the right
/// class came first in fewer than 95 % of its cases; one for the clean traces, which fails if one raised an alarm; and one for the bars of the
/// whole, which fails by `shortfalls`.
///
/// # Errors
/// [`ReportError`] if the XML cannot be written, which is a bug.
pub fn campaign_junit(results: &[CaseResult], shortfalls: &[String]) -> Result<String, ReportError> {
    let mut suite = TestSuite::new("campaign");
    let mut add = |name: &str, status: TestCaseStatus| {
        let mut case = TestCase::new(name, status);
        case.set_classname("campaign");
        suite.add_test_case(case);
    };
    let classes: BTreeSet<FaultKind> = results.iter().filter_map(|result| result.class).collect();
    for class in classes {
        let shown: Vec<&CaseResult> =
            results.iter().filter(|result| result.class == Some(class) && !result.intact).collect();
        add(&class.to_string(), class_status(class, &shown));
    }
    let clean = results.iter().filter(|result| result.class.is_none());
    let alarms: Vec<&CaseResult> = clean.filter(|result| !result.found.is_empty()).collect();
    let alarm = format!("{} clean traces raised an alarm", alarms.len());
    add("clean traces", if alarms.is_empty() { TestCaseStatus::success() } else { failed(alarm, &alarms) });
    add(
        "the bars",
        if shortfalls.is_empty() { TestCaseStatus::success() } else { failed(shortfalls.join("; "), &[]) },
    );
    let mut report = Report::new("host-sim campaign");
    report.add_test_suite(suite);
    report.to_string().map_err(|error| ReportError::Numbers(error.to_string()))
}

fn class_status(class: FaultKind, shown: &[&CaseResult]) -> TestCaseStatus {
    if shown.is_empty() {
        let mut status = TestCaseStatus::skipped();
        status.set_message("every frame came as it was sent: the fault is masked");
        return status;
    }
    let first = |result: &&CaseResult| result.found.first().is_some_and(|(found, ..)| *found == class);
    let wrong: Vec<&CaseResult> = shown.iter().copied().filter(|result| !first(result)).collect();
    let unflagged = wrong.iter().filter(|result| result.found.is_empty()).count();
    if unflagged == 0 && 100 * wrong.len() <= 5 * shown.len() {
        return TestCaseStatus::success();
    }
    let message = format!(
        "{unflagged} of {} not flagged; another class first in {}",
        shown.len(),
        wrong.len() - unflagged
    );
    failed(message, &wrong)
}

fn failed(message: String, cases: &[&CaseResult]) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_type("campaign");
    status.set_message(message);
    let mut lines: Vec<String> = cases.iter().take(LISTED).map(|result| told(result)).collect();
    if cases.len() > LISTED {
        lines.push(format!("and {} more", cases.len() - LISTED));
    }
    status.set_description(lines.join("\n"));
    status
}

fn told(result: &CaseResult) -> String {
    let found: Vec<String> =
        result.found.iter().map(|(kind, sure, _)| format!("{kind} ({} %)", sure / 10)).collect();
    let found = if found.is_empty() { "nothing".to_owned() } else { found.join(", ") };
    let fault = if result.fault.is_empty() { "no fault" } else { &result.fault };
    format!(
        "case {}, {}, {}, {fault}, seed {}: {found}",
        result.case, result.profile, result.scene, result.seed
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{Evidence, Finding, Remedy};

    /// What the usual readers of JUnit ask for: names, and counts that are those of the elements.
    fn check(xml: &str) -> roxmltree::Document<'_> {
        let document = roxmltree::Document::parse(xml).unwrap();
        let root = document.root_element();
        assert_eq!(root.tag_name().name(), "testsuites");
        for suite in root.children().filter(roxmltree::Node::is_element) {
            assert_eq!(suite.tag_name().name(), "testsuite");
            let cases: Vec<_> = suite.children().filter(|node| node.has_tag_name("testcase")).collect();
            let with = |tag: &str| {
                let has =
                    |case: &&roxmltree::Node<'_, '_>| case.children().any(|node| node.has_tag_name(tag));
                cases.iter().filter(has).count().to_string()
            };
            for (attribute, count) in [
                ("tests", cases.len().to_string()),
                ("failures", with("failure")),
                ("skipped", with("skipped")),
                ("errors", with("error")),
            ] {
                assert_eq!(suite.attribute(attribute), Some(&count[..]), "{attribute}");
                assert_eq!(root.attribute(attribute), Some(&count[..]), "{attribute} of the whole");
            }
            let mut names: Vec<_> = cases.iter().map(|case| case.attribute("name").unwrap()).collect();
            assert!(cases.iter().all(|case| case.attribute("classname").is_some()));
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), cases.len(), "no name twice");
        }
        document
    }

    #[test]
    fn a_finding_is_a_failure_and_every_other_class_passes() {
        let finding = Finding {
            fault: FaultKind::StuckBit,
            confidence: 0.97,
            score: 0.97,
            at_pclk: 77,
            line: Some(3),
            evidence: Evidence::new("D5 < \"D4\" & is\u{1} always low"),
            remedy: Remedy::new("check D5").register("CR.EDM = 0"),
        };
        let diagnosis = Diagnosis { findings: vec![finding], ..Diagnosis::default() };
        let xml = junit("a<b>&\".vcd", "vga", &diagnosis).unwrap();
        let document = check(&xml);
        let failures: Vec<_> = document.descendants().filter(|node| node.has_tag_name("failure")).collect();
        assert_eq!(failures.len(), 1);
        assert_eq!(failures[0].parent().unwrap().attribute("name"), Some("stuck-bit"));
        assert_eq!(
            failures[0].text(),
            Some("clock 77, line 3: D5 < \"D4\" & is always low\nremedy: check D5; register: CR.EDM = 0")
        );
        let suite = document.root_element().first_element_child().unwrap();
        assert_eq!(suite.attribute("name"), Some("a<b>&\".vcd"));
        check(&junit("clean.camt", "vga", &Diagnosis::default()).unwrap());
    }

    #[test]
    fn a_campaign_fails_by_class_and_says_which_cases() {
        let case = |number: u64, class: Option<FaultKind>, intact: bool, found: &[FaultKind]| CaseResult {
            case: number,
            profile: "vga".to_owned(),
            scene: "demo".to_owned(),
            class,
            fault: class.map(|class| class.to_string()).unwrap_or_default(),
            seed: number,
            intact,
            found: found.iter().map(|kind| (*kind, 900, 900)).collect(),
        };
        let (stuck, swapped, slip) = (FaultKind::StuckBit, FaultKind::SwappedBits, FaultKind::ByteSlip);
        let mut results: Vec<CaseResult> =
            (0..20).map(|number| case(number, Some(stuck), false, &[stuck])).collect();
        results.push(case(20, Some(stuck), false, &[swapped, stuck]));
        results.push(case(21, Some(swapped), false, &[]));
        results.push(case(22, Some(slip), true, &[]));
        results.push(case(23, None, true, &[slip]));
        let xml = campaign_junit(&results, &["1 of 21".to_owned()]).unwrap();
        let document = check(&xml);
        let text = |name: &str| {
            let of = |node: &roxmltree::Node<'_, '_>| {
                node.has_tag_name("testcase") && node.attribute("name") == Some(name)
            };
            let inside = document.descendants().find(of).unwrap().first_element_child()?;
            Some((inside.tag_name().name().to_owned(), inside.attribute("message").unwrap().to_owned()))
        };
        let failure = |message: &str| Some(("failure".to_owned(), message.to_owned()));
        assert_eq!(text("stuck-bit"), None, "20 of 21 are 95 %");
        assert_eq!(text("swapped-bits"), failure("1 of 1 not flagged; another class first in 0"));
        assert_eq!(text("byte-slip").unwrap().0, "skipped");
        assert_eq!(text("clean traces"), failure("1 clean traces raised an alarm"));
        assert_eq!(text("the bars"), failure("1 of 21"));
        assert!(xml.contains("case 21, vga, demo, swapped-bits, seed 21: nothing"));
        check(&campaign_junit(&[], &[]).unwrap());
    }
}
