use std::borrow::Cow;
use std::time::{Duration, Instant};

use algos_nostd::color::balance::running::RunningWhite;
use algos_nostd::image::Error;

use super::PipelineError;
use super::arguments::Arguments;
use super::parse::{Invocation, Pipeline};
use super::picture::Picture;
use super::table::Input;

/// What a stage remembers from picture to picture.
#[derive(Debug, Default)]
pub(super) struct Memory {
    /// The light that `balance` follows.
    pub(super) white: Option<RunningWhite>,
}

/// Sends pictures through a pipeline, one after the other. Stages that follow something over frames remember it here.
#[derive(Debug)]
pub struct Runner<'a> {
    stages: Vec<(Cow<'a, Invocation>, Memory, Duration)>,
}

impl<'a> Runner<'a> {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(pipeline: &'a Pipeline) -> Self {
        let fresh = |stage| (Cow::Borrowed(stage), Memory::default(), Duration::ZERO);
        Self { stages: pipeline.stages.iter().map(fresh).collect() }
    }

    /// The same, which keeps the pipeline.
    #[must_use]
    pub fn owning(pipeline: Pipeline) -> Runner<'static> {
        let fresh = |stage| (Cow::Owned(stage), Memory::default(), Duration::ZERO);
        Runner { stages: pipeline.stages.into_iter().map(fresh).collect() }
    }

    /// Sends a picture through all stages.
    ///
    /// # Errors
    /// [`PipelineError::Refused`] with the stage that could not do it, and why.
    pub fn run(&mut self, mut picture: Picture) -> Result<Picture, PipelineError> {
        for (index, (invocation, memory, taken)) in self.stages.iter_mut().enumerate() {
            let size = picture.size();
            let started = Instant::now();
            picture = apply(invocation, picture, memory).map_err(|error| PipelineError::Refused {
                number: index + 1,
                text: invocation.text.clone(),
                size,
                error,
            })?;
            *taken += started.elapsed();
        }
        Ok(picture)
    }

    /// Each stage as it was written, and the time that it has taken for all pictures.
    pub fn timing(&self) -> impl Iterator<Item = (&str, Duration)> {
        self.stages.iter().map(|(invocation, _, taken)| (invocation.text.as_str(), *taken))
    }
}

fn apply(invocation: &Invocation, picture: Picture, memory: &mut Memory) -> Result<Picture, Error> {
    let stage = invocation.stage;
    let picture = match stage.input {
        Input::Any => picture,
        Input::Gray => picture.into_gray().into(),
        Input::Rgb => picture.into_rgb().into(),
    };
    let arguments = Arguments { parameters: stage.parameters, values: &invocation.values };
    (stage.apply)(&arguments, picture, memory)
}
