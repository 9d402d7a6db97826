use std::fmt;
use std::str::FromStr;

use super::PipelineError;
use super::table::{self, Parameter, Stage};
use super::value::Value;
use crate::profile::nearest;

/// Stages, in the order in which a picture goes through them.
///
/// The text form is what `--op` takes: stages with `|` between them, each a name, or a name and after `:` values with
/// `,` between them. A value is `key=value`; the first may be the value of the stage's first parameter alone. In values
/// `\,`, `\|` and `\\` stand for those signs. What is printed leaves out what has its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Pipeline {
    pub(super) stages: Vec<Invocation>,
}

/// A stage with its values.
#[derive(Clone, Debug)]
pub struct Invocation {
    pub(super) stage: &'static Stage,
    /// One for each of the stage's parameters.
    pub(super) values: Vec<Value>,
    /// As it was written.
    pub(super) text: String,
}

/// How it was written makes no difference.
impl PartialEq for Invocation {
    fn eq(&self, other: &Self) -> bool {
        self.stage.name == other.stage.name && self.values == other.values
    }
}

impl FromStr for Pipeline {
    type Err = PipelineError;

    fn from_str(text: &str) -> Result<Self, PipelineError> {
        let stages = split(text, '|').into_iter().enumerate();
        let stages: Result<_, _> = stages.map(|(index, text)| invocation(index + 1, text.trim())).collect();
        Ok(Self { stages: stages? })
    }
}

/// Splits at a sign where no `\` stands before it.
fn split(text: &str, at: char) -> Vec<&str> {
    let (mut parts, mut start, mut escaped) = (Vec::new(), 0, false);
    for (index, sign) in text.char_indices() {
        if sign == at && !escaped {
            parts.push(&text[start..index]);
            start = index + sign.len_utf8();
        }
        escaped = sign == '\\' && !escaped;
    }
    parts.push(&text[start..]);
    parts
}

/// Takes away each `\` that stands before `,`, `|` or `\`.
fn unescape(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut signs = text.chars().peekable();
    while let Some(sign) = signs.next() {
        match signs.peek() {
            Some(next @ (',' | '|' | '\\')) if sign == '\\' => {
                plain.push(*next);
                signs.next();
            }
            _ => plain.push(sign),
        }
    }
    plain
}

fn escape(text: &str) -> String {
    text.chars().fold(String::new(), |mut escaped, sign| {
        if matches!(sign, ',' | '|' | '\\') {
            escaped.push('\\');
        }
        escaped.push(sign);
        escaped
    })
}

/// The default of a parameter.
///
/// # Panics
/// If the table's default is not among its own values, which a test rules out.
pub(super) fn default_of(parameter: &Parameter) -> Value {
    parameter.kind.parse(parameter.default).unwrap_or_else(|| {
        panic!("the default of `{}`, `{}`, is not allowed", parameter.name, parameter.default)
    })
}

fn invocation(number: usize, text: &str) -> Result<Invocation, PipelineError> {
    let (name, rest) = match text.split_once(':') {
        Some((name, rest)) => (name.trim(), Some(rest)),
        None => (text, None),
    };
    if name.is_empty() {
        return Err(PipelineError::EmptyStage { number });
    }
    let Some((stage, first)) = table::find(name) else {
        return Err(PipelineError::unknown_stage(number, text, name));
    };
    let mut given: Vec<Option<Value>> = vec![None; stage.parameters.len()];
    if let (Some(parameter), Some(slot)) = (stage.parameters.first(), given.first_mut())
        && !first.is_empty()
    {
        *slot = parameter.kind.parse(first);
    }
    let parts = rest.map(|rest| split(rest, ',')).unwrap_or_default();
    for (place, part) in parts.into_iter().enumerate() {
        let (index, value) = argument(number, text, stage, place, part.trim())?;
        let (Some(parameter), Some(slot)) = (stage.parameters.get(index), given.get_mut(index)) else {
            continue;
        };
        if slot.is_some() {
            return Err(PipelineError::Twice { number, text: text.to_owned(), key: parameter.name });
        }
        let value = unescape(value.trim());
        match parameter.kind.parse(&value) {
            Some(value) => *slot = Some(value),
            None => return Err(wrong_value(number, text, parameter, value)),
        }
    }
    let values = stage.parameters.iter().zip(given);
    let values = values.map(|(parameter, value)| value.unwrap_or_else(|| default_of(parameter))).collect();
    Ok(Invocation { stage, values, text: text.to_owned() })
}

/// Which parameter is meant, and the text of its value.
fn argument<'a>(
    number: usize,
    text: &str,
    stage: &Stage,
    place: usize,
    part: &'a str,
) -> Result<(usize, &'a str), PipelineError> {
    let index_of =
        |key: &str| stage.parameters.iter().position(|parameter| parameter.name.eq_ignore_ascii_case(key));
    if let Some((key, value)) = part.split_once('=') {
        let key = key.trim();
        return match index_of(key) {
            Some(index) => Ok((index, value)),
            None => Err(unknown_parameter(number, text, stage, key)),
        };
    }
    match stage.parameters {
        [] => Err(unknown_parameter(number, text, stage, part)),
        _ if place == 0 => Ok((0, part)),
        parameters => {
            let keys: Vec<_> = parameters.iter().map(|parameter| parameter.name).collect();
            let (text, word) = (text.to_owned(), part.to_owned());
            Err(PipelineError::NoKey { number, text, word, keys: keys.join(", ") })
        }
    }
}

fn unknown_parameter(number: usize, text: &str, stage: &Stage, key: &str) -> PipelineError {
    let names = || stage.parameters.iter().map(|parameter| parameter.name);
    let instead = match nearest(key, names()) {
        None => "it has none".to_owned(),
        Some(nearest) => {
            let others: Vec<_> = names().filter(|name| *name != nearest).collect();
            let others =
                if others.is_empty() { String::new() } else { format!(" Others are {}", others.join(", ")) };
            format!("did you mean `{nearest}`?{others}")
        }
    };
    PipelineError::UnknownParameter {
        number,
        text: text.to_owned(),
        stage: stage.name,
        key: key.to_owned(),
        instead,
    }
}

fn wrong_value(number: usize, text: &str, parameter: &Parameter, got: String) -> PipelineError {
    let instead = match nearest(&got, parameter.kind.words()) {
        None => format!("it must be {}", parameter.kind),
        Some(nearest) => {
            let others: Vec<_> = parameter.kind.words().filter(|word| *word != nearest).collect();
            format!("did you mean `{nearest}`? Others are {}", others.join(", "))
        }
    };
    PipelineError::Value { number, text: text.to_owned(), key: parameter.name, got, instead }
}

impl fmt::Display for Invocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.stage.name)?;
        let mut before = ':';
        for (index, (parameter, value)) in self.stage.parameters.iter().zip(&self.values).enumerate() {
            if *value == default_of(parameter) {
                continue;
            }
            let key = match value {
                // A word that is the first speaks for itself.
                Value::Word(_) if index == 0 => String::new(),
                _ => format!("{}=", parameter.name),
            };
            write!(f, "{before}{key}{}", escape(&value.to_string()))?;
            before = ',';
        }
        Ok(())
    }
}

impl fmt::Display for Pipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, stage) in self.stages.iter().enumerate() {
            write!(f, "{}{stage}", if index > 0 { "|" } else { "" })?;
        }
        Ok(())
    }
}
