//! `docs/pipeline.md` and `docs/algorithms.md`, made of the table. `BLESS=1 cargo test -p host-sim pipeline` writes them,
//! and the pictures of the second one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, RgbImage};

use super::help::{alias_text, takes_and_gives};
use super::kind::Kind;
use super::table::{Stage, stages};
use super::{Picture, Pipeline, Runner};
use crate::scene::Scene;

/// Width and height of the pictures.
const SIZE: (u32, u32) = (240, 180);
/// The largest picture, in bytes.
const MOST_BYTES: u64 = 60_000;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

fn blessing() -> bool {
    std::env::var_os("BLESS").is_some_and(|value| value == "1")
}

/// What must not end a column of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn pipeline_page() -> String {
    let mut page = String::from(
        "# Pipelines\n\n\
         `host-sim process IMAGE --op PIPELINE -o OUT.png` sends a picture through the algorithms of the device, and\n\
         `host-sim replay TRACE --out DIR --op PIPELINE` every frame of a trace. A pipeline is stages with `|` between them:\n\n\
         ```\n\
         gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150,norm=l2\n\
         balance:gray-world\n\
         quantize:median-cut,colors=16,dither=floyd-steinberg\n\
         ```\n\n\
         A stage is a name, or a name and after `:` its values with `,` between them. A value is `key=value`; the first one\n\
         may be the value of the stage's first parameter without its key. What is not said has its default. In values `\\,`,\n\
         `\\|` and `\\\\` stand for those signs. Names and words may be written in either case.\n\n\
         Stages that need gray take the BT.601 luma of colour; stages that need colour give gray to all three channels. Filters\n\
         take either, and treat each channel by itself. Maps (edges) are gray: 255 where something is, else 0.\n\n\
         A place is `ACROSSxDOWN` from the top left corner, each in pixels or, with `%`, in hundredths of the picture's width or\n\
         height; a size is the same. Lists have `;` between their items. Colours are `#rrggbb` or a name: black, white, gray,\n\
         red, green, blue, yellow, cyan, magenta, orange.\n\n\
         `--op help` lists all of this at the command line, `--op help:canny` one stage. [What each does to a\n\
         picture](algorithms.md). With `--timing` the time of each stage is said on stderr.\n",
    );
    let mut heading = None;
    for (group, stage) in stages() {
        if heading != Some(group) {
            let _ = write!(page, "\n## {}\n", group.name());
            heading = Some(group);
        }
        let _ = write!(page, "\n### `{}`\n{} ({}).", stage.name, stage.about, takes_and_gives(stage));
        if stage.least_width > 1 {
            let _ = write!(page, " Lines must have at least {} pixels.", stage.least_width);
        }
        let aliases: Vec<_> =
            stage.aliases.iter().map(|(alias, first)| alias_text(stage, alias, first)).collect();
        if !aliases.is_empty() {
            let _ = write!(page, " Also called {}.", aliases.join(", "));
        }
        page.push('\n');
        if stage.parameters.is_empty() {
            continue;
        }
        page.push_str("\n| parameter | values | default | what it is |\n|---|---|---|---|\n");
        for parameter in stage.parameters {
            let values = match parameter.kind {
                Kind::Word(words) => {
                    let word = |(word, about): &(&str, &str)| {
                        if about.is_empty() {
                            format!("`{word}`")
                        } else {
                            format!("`{word}`: {}", cell(about))
                        }
                    };
                    words.iter().map(word).collect::<Vec<_>>().join("<br>")
                }
                kind => cell(&kind.to_string()),
            };
            let default = if parameter.default.is_empty() {
                "none".to_owned()
            } else {
                format!("`{}`", parameter.default)
            };
            let _ =
                writeln!(page, "| `{}` | {values} | {default} | {} |", parameter.name, cell(parameter.about));
        }
    }
    page
}

fn picture_name(stage: &Stage) -> String {
    format!("stage-{}.png", stage.name)
}

fn algorithms_page() -> String {
    let mut page = String::from(
        "# What each algorithm does\n\n\
         Each picture is made of the demo scene, 240 × 180, by the pipeline beneath it:\n\
         `host-sim process scene.png --op PIPELINE -o out.png`. [All parameters](pipeline.md).\n\n\
         | |\n|---|\n| ![the demo scene](images/stage-scene.png) |\n| the scene |\n",
    );
    let mut heading = None;
    for (group, stage) in stages() {
        if heading != Some(group) {
            let _ = write!(page, "\n## {}\n", group.name());
            heading = Some(group);
        }
        let op = cell(stage.example);
        let name = stage.name;
        let _ = write!(page, "\n### `{name}`\n{}\n\n", stage.about);
        let _ = write!(page, "| ![{name}](images/{}) |\n|---|\n| `{op}` |\n", picture_name(stage));
    }
    page
}

fn example(stage: &Stage, scene: &RgbImage) -> RgbImage {
    let pipeline: Pipeline = stage.example.parse().unwrap_or_else(|error| panic!("{}: {error}", stage.name));
    let made = Runner::new(&pipeline).run(Picture::from_image(scene));
    made.unwrap_or_else(|error| panic!("{}: {error}", stage.name)).into_image()
}

fn same_text(name: &str, made: &str) {
    let path = docs().join(name);
    if blessing() {
        std::fs::write(&path, made).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        there, made,
        "docs/{name} is not what the table says; BLESS=1 cargo test -p host-sim pipeline writes it"
    );
}

fn same_picture(name: &str, made: &RgbImage) {
    let path = docs().join("images").join(name);
    if blessing() {
        let file = std::fs::File::create(&path).unwrap();
        let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
        encoder.write_image(made, made.width(), made.height(), ExtendedColorType::Rgb8).unwrap();
    }
    let there = crate::picture::read(&path).ok();
    assert!(
        there.as_ref() == Some(made),
        "docs/images/{name} is another; BLESS=1 cargo test -p host-sim pipeline writes it"
    );
    assert!(std::fs::metadata(&path).unwrap().len() < MOST_BYTES, "docs/images/{name} has 60 KB or more");
}

#[test]
fn the_pages_are_what_the_table_says() {
    same_text("pipeline.md", &pipeline_page());
    same_text("algorithms.md", &algorithms_page());
}

#[test]
fn the_pictures_are_what_the_stages_make() {
    let scene = Scene::Demo { seed: 0 }.render(0, SIZE.0, SIZE.1);
    same_picture("stage-scene.png", &scene);
    for (_, stage) in stages() {
        let made = example(stage, &scene);
        assert!(
            made != scene || stage.name == "rgb",
            "the example of `{}` leaves the picture as it is",
            stage.name
        );
        same_picture(&picture_name(stage), &made);
    }
}
