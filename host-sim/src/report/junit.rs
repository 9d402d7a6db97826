use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

use super::ReportError;
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
}
