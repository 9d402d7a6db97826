use std::fmt::Write as _;

use super::PipelineError;
use super::kind::Kind;
use super::table::{self, Input, Output, Stage, stages};

/// Whether a pipeline's text asks for help: `help`, or `help:NAME` with a stage's name.
#[must_use]
pub fn is_help(text: &str) -> bool {
    let text = text.trim();
    text == "help" || text.starts_with("help:")
}

/// Help on all stages, or on one of them by `help:NAME`.
///
/// # Errors
/// [`PipelineError::UnknownStage`] if the name is none.
pub fn help(text: &str) -> Result<String, PipelineError> {
    match text.trim().split_once(':') {
        None => Ok(all()),
        Some((_, name)) => match table::find(name.trim()) {
            Some((stage, _)) => Ok(one(stage)),
            None => Err(PipelineError::unknown_stage(1, text, name.trim())),
        },
    }
}

fn all() -> String {
    let mut text = String::from(
        "A pipeline is stages with | between them: gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150,norm=l2\n\
         The first parameter's value may stand without its key: balance:gray-world\n\
         Stages that need gray take the BT.601 luma of colour; stages that need colour give gray to all channels.\n\
         --op help:NAME says all about one stage.\n",
    );
    let mut heading = None;
    for (group, stage) in stages() {
        if heading != Some(group) {
            let _ = write!(text, "\n{}\n", group.name());
            heading = Some(group);
        }
        let _ = writeln!(text, "  {:<13} {} ({})", stage.name, stage.about, takes_and_gives(stage));
        for parameter in stage.parameters {
            let default = if parameter.default.is_empty() { "none" } else { parameter.default };
            let _ = writeln!(text, "    {:<11} {} [{default}]", parameter.name, parameter.kind);
        }
    }
    text
}

fn one(stage: &Stage) -> String {
    let mut text = format!("{}: {}\n{}\n", stage.name, stage.about, takes_and_gives_at_length(stage));
    if stage.least_width > 1 {
        let _ = writeln!(text, "Lines must have at least {} pixels.", stage.least_width);
    }
    let aliases: Vec<_> =
        stage.aliases.iter().map(|(alias, first)| alias_text(stage, alias, first)).collect();
    if !aliases.is_empty() {
        let _ = writeln!(text, "Also called: {}", aliases.join(", "));
    }
    for parameter in stage.parameters {
        let default = if parameter.default.is_empty() { "none" } else { parameter.default };
        let _ = writeln!(text, "\n  {:<11} {}", parameter.name, parameter.about);
        if let Kind::Word(words) = parameter.kind {
            for (word, about) in words {
                let mark = if *word == parameter.default { " (default)" } else { "" };
                let _ = writeln!(text, "    {word:<20} {about}{mark}");
            }
        } else {
            let _ = writeln!(text, "    {}; default {default}", parameter.kind);
        }
    }
    let _ = writeln!(text, "\nFor instance: --op '{}'", stage.example);
    text
}

/// An alias, and what it stands for if it says more than the name.
pub(super) fn alias_text(stage: &Stage, alias: &str, first: &str) -> String {
    if first.is_empty() { alias.to_owned() } else { format!("{alias} (= {}:{first})", stage.name) }
}

/// What goes in and comes out, in few words.
pub(super) fn takes_and_gives(stage: &Stage) -> &'static str {
    match (stage.input, stage.output) {
        (Input::Any, Output::Same) => "any → same",
        (Input::Any, Output::Gray) => "any → gray",
        (Input::Any, Output::Rgb) => "any → colour",
        (Input::Gray, Output::Rgb) => "gray → colour",
        (Input::Gray, _) => "gray → gray",
        (Input::Rgb, Output::Gray) => "colour → gray",
        (Input::Rgb, _) => "colour → colour",
    }
}

fn takes_and_gives_at_length(stage: &Stage) -> String {
    let takes = match stage.input {
        Input::Any => "colour (each channel by itself, or all three together) or gray",
        Input::Gray => "gray; colour is turned into its BT.601 luma",
        Input::Rgb => "colour; gray is given to all three channels",
    };
    let gives = match (stage.output, stage.input) {
        (Output::Same, Input::Any) => "the same",
        (Output::Gray, _) | (_, Input::Gray) if stage.output != Output::Rgb => "gray",
        _ => "colour",
    };
    format!("Takes {takes}. Gives {gives}.")
}
