use algos_nostd::image::Error;

use super::arguments::Arguments;
use super::kind::Kind;
use super::picture::Picture;
use super::run::Memory;
use super::stages::TABLES;

/// What kind of thing a stage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Colours and levels, each pixel by itself or by all.
    Color,
    /// Neighbourhoods.
    Filter,
    /// Gradients, edges, curves.
    Edges,
    /// Palettes and dithering.
    Quantize,
    /// Places: turning, cutting, scaling.
    Geometry,
    /// Drawing on the picture.
    Draw,
}

impl Group {
    /// The heading of help.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Color => "colour",
            Self::Filter => "filter",
            Self::Edges => "edges",
            Self::Quantize => "quantize",
            Self::Geometry => "geometry",
            Self::Draw => "draw",
        }
    }
}

/// What a stage takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Input {
    /// Colour or gray.
    Any,
    /// Gray; colour is turned into its luma.
    Gray,
    /// Colour; gray is given to all three channels.
    Rgb,
}

/// What a stage gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// The same as it takes.
    Same,
    /// Gray.
    Gray,
    /// Colour.
    Rgb,
}

/// A parameter of a stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameter {
    /// Its key.
    pub(super) name: &'static str,
    /// The values that are right.
    pub(super) kind: Kind,
    /// The value where none is given.
    pub(super) default: &'static str,
    /// One line for people, with the unit.
    pub(super) about: &'static str,
}

/// A stage: all that parsing, running, messages, help and the page know of it.
#[derive(Debug)]
pub struct Stage {
    pub(super) name: &'static str,
    /// Other names, and what they say for the first parameter (nothing, if they are just another word).
    pub(super) aliases: &'static [(&'static str, &'static str)],
    /// One line for people.
    pub(super) about: &'static str,
    pub(super) input: Input,
    pub(super) output: Output,
    /// In the order of help. The first one's value may be given without its key.
    pub(super) parameters: &'static [Parameter],
    /// Pixels of a line from which on all of its methods work; the library refuses shorter ones.
    pub(super) least_width: usize,
    /// A pipeline that shows what it does.
    pub(super) example: &'static str,
    pub(super) apply: fn(&Arguments<'_>, Picture, &mut Memory) -> Result<Picture, Error>,
}

impl Stage {
    /// The name in pipelines.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// A pipeline that shows what the stage does.
    #[must_use]
    pub fn example(&self) -> &'static str {
        self.example
    }
}

/// Every stage with its group, in the order of help.
pub fn stages() -> impl Iterator<Item = (Group, &'static Stage)> {
    TABLES.iter().flat_map(|(group, stages)| stages.iter().map(|stage| (*group, stage)))
}

/// The stage of that name or alias, and the value that an alias has for its first parameter.
pub(super) fn find(name: &str) -> Option<(&'static Stage, &'static str)> {
    stages().find_map(|(_, stage)| {
        if stage.name.eq_ignore_ascii_case(name) {
            return Some((stage, ""));
        }
        let alias = stage.aliases.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(name));
        alias.map(|(_, first)| (stage, *first))
    })
}

/// Every name and alias.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    stages().flat_map(|(_, stage)| {
        std::iter::once(stage.name).chain(stage.aliases.iter().map(|(alias, _)| *alias))
    })
}
