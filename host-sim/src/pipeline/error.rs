use algos_nostd::image::Error;

use super::table::{names, stages};
use crate::profile::nearest;

/// What is wrong with a pipeline, or went wrong in it. Each names the stage by number, from 1, and text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// Nothing where a stage should be.
    #[error(
        "stage {number} of the pipeline is empty; write stages with `|` between them, for instance `gray|canny`"
    )]
    EmptyStage {
        /// The stage.
        number: usize,
    },
    /// A name that is none.
    #[error(
        "stage {number}, `{text}`: no stage is called `{name}`; did you mean `{nearest}`? Others are {others}; `help` says what they do"
    )]
    UnknownStage {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// What was taken for its name.
        name: String,
        /// The name nearest to it.
        nearest: &'static str,
        /// The other names.
        others: String,
    },
    /// A key that the stage does not have.
    #[error("stage {number}, `{text}`: `{stage}` has no parameter `{key}`; {instead}")]
    UnknownParameter {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// Its name.
        stage: &'static str,
        /// The key.
        key: String,
        /// Which it has, the nearest first.
        instead: String,
    },
    /// A key that is given twice.
    #[error("stage {number}, `{text}`: `{key}` is given twice; keep one")]
    Twice {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// The key.
        key: &'static str,
    },
    /// A value without a key that is not the first.
    #[error("stage {number}, `{text}`: `{word}` has no key; write `key=value` with a key of {keys}")]
    NoKey {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// The value.
        word: String,
        /// The keys of the stage.
        keys: String,
    },
    /// A value that the parameter can't have.
    #[error("stage {number}, `{text}`: `{key}` is `{got}`; {instead}")]
    Value {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// The parameter.
        key: &'static str,
        /// The value.
        got: String,
        /// Which are right, the nearest first.
        instead: String,
    },
    /// The algorithm refused the picture or the values together.
    #[error("stage {number}, `{text}`, on a picture of {} × {} pixels: {error}", size.0, size.1)]
    Refused {
        /// The stage.
        number: usize,
        /// As it was written.
        text: String,
        /// Width and height of the picture that came to the stage.
        size: (usize, usize),
        /// What it said.
        #[source]
        error: Error,
    },
}

impl PipelineError {
    /// [`PipelineError::UnknownStage`] with what there is.
    pub(super) fn unknown_stage(number: usize, text: &str, name: &str) -> Self {
        let nearest = nearest(name, names()).unwrap_or("gray");
        let others: Vec<_> =
            stages().map(|(_, stage)| stage.name()).filter(|name| *name != nearest).collect();
        let (text, name, others) = (text.to_owned(), name.to_owned(), others.join(", "));
        Self::UnknownStage { number, text, name, nearest, others }
    }
}
