use std::collections::HashSet;

use algos_nostd::color::balance::adaptation::Space;
use algos_nostd::image::Rgb;
use algos_nostd::pixel::bayer::BayerOrder;
use algos_nostd::pixel::format::Format;

use super::kind::Kind;
use super::parse::default_of;
use super::table::{self, Input, Output, Stage, stages};
use super::{Frame, Picture, Pipeline, PipelineError, Runner, help, is_help};

fn parse(text: &str) -> Pipeline {
    text.parse().unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str) -> String {
    text.parse::<Pipeline>().unwrap_err().to_string()
}

/// Every value between 0 and 255, edges and slopes.
fn rgb(width: usize, height: usize) -> Picture {
    let mut frame = Frame::filled(width, height, Rgb::default());
    let mut random = 1u32;
    for (index, pixel) in frame.pixels_mut().iter_mut().enumerate() {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let slope = (index * 7 % 256) as u8;
        *pixel = Rgb { r: slope, g: 60 + (random >> 26) as u8, b: if index % 9 < 4 { 220 } else { 40 } };
    }
    frame.into()
}

fn gray(width: usize, height: usize) -> Picture {
    rgb(width, height).into_gray().into()
}

fn run(op: &str, picture: Picture) -> Result<Picture, PipelineError> {
    Runner::new(&parse(op)).run(picture)
}

#[test]
fn the_grammar_of_the_design_is_read() {
    let pipeline = parse("gray|gaussian:size=5,sigma=1.4|canny:low=50,high=150,norm=l2");
    assert_eq!(pipeline.to_string(), "gray|gaussian|canny", "what has its default is left out");
    let op = "quantize:median-cut,colors=32,dither=floyd-steinberg";
    assert_eq!(parse(op).to_string(), op);
    assert_eq!(parse("balance:gray-world"), parse("Balance : method = GRAY-WORLD"));
    assert_eq!(
        parse("sobel:measure=l2"),
        parse("gradient:sobel,measure=l2"),
        "an alias says the first parameter"
    );
    assert_eq!(parse("curve:0:0;255:255").to_string(), "curve");
    assert_eq!(parse("text:a\\,b\\|c\\\\,scale=2").to_string(), "text:text=a\\,b\\|c\\\\,scale=2");
}

#[test]
fn what_is_wrong_names_the_stage_and_what_is_right() {
    for (text, expected) in [
        ("gray|cany", "stage 2, `cany`: no stage is called `cany`; did you mean `canny`?"),
        (
            "canny:lo=5",
            "stage 1, `canny:lo=5`: `canny` has no parameter `lo`; did you mean `low`? Others are high, norm",
        ),
        ("canny:norm=l3", "`norm` is `l3`; did you mean `l1`? Others are l2"),
        ("canny:low=-1", "`low` is `-1`; it must be 0 to 2040"),
        ("gaussian:4", "`size` is `4`; it must be 3, 5, 7"),
        ("gaussian:sigma=1e3", "`sigma` is `1e3`; it must be 0.1 to 16"),
        ("canny:low=5,low=6", "`low` is given twice"),
        ("canny:5,150", "`150` has no key; write `key=value` with a key of low, high"),
        ("sobel:scharr", "`operator` is given twice"),
        ("gray:5", "`gray` has no parameter `5`; it has none"),
        ("gray||canny", "stage 2 of the pipeline is empty"),
        ("", "stage 1 of the pipeline is empty"),
    ] {
        let message = refusal(text);
        assert!(message.contains(expected), "{text}: {message}");
        assert_eq!(message.lines().count(), 1);
    }
}

#[test]
fn what_a_picture_cannot_do_is_said_with_the_stage() {
    let message = run("gray|crop:at=0x0,size=9x9", rgb(4, 4)).unwrap_err().to_string();
    assert!(
        message.starts_with("stage 2, `crop:at=0x0,size=9x9`, on a picture of 4 × 4 pixels: "),
        "{message}"
    );
    let message = run("canny:low=9,high=3", rgb(4, 4)).unwrap_err().to_string();
    assert!(message.contains("`low` is 9; it must be at most `high`"), "{message}");
    for op in
        ["crop:at=-1x0", "scale:1600%x1600%", "demosaic", "format:yuyv", "clip:cyrus-beck,window=0x0;5x5;9x9"]
    {
        let wide = if op.starts_with("scale") { rgb(300, 2) } else { rgb(1, 9) };
        assert!(run(op, wide).is_err(), "{op}");
    }
}

/// Every value of every parameter that is a word or one of a list, with defaults for the others.
fn variants(stage: &'static Stage) -> Vec<String> {
    let mut variants = vec![stage.name.to_owned()];
    for parameter in stage.parameters {
        let mut add = |value: String| variants.push(format!("{}:{}={value}", stage.name, parameter.name));
        match parameter.kind {
            Kind::OneOf(numbers) => numbers.iter().for_each(|number| add(number.to_string())),
            Kind::Word(words) => words.iter().for_each(|(word, _)| add((*word).to_owned())),
            _ => {}
        }
    }
    variants
}

/// Some values need another one beside them, or a picture that not all are.
fn settled(op: &str) -> String {
    match op {
        "quantize:method=fixed" => format!("{op},palette=red;#102030"),
        "balance:method=white" => format!("{op},white=#c0a080"),
        _ => op.to_owned(),
    }
}

#[test]
fn every_stage_takes_every_picture() {
    let pictures =
        [(1, 1), (2, 3), (33, 17)].map(|(width, height)| [rgb(width, height), gray(width, height)]);
    for (_, stage) in stages() {
        for op in variants(stage) {
            for picture in pictures.as_flattened() {
                let (width, _) = picture.size();
                if width < stage.least_width || (op.contains("yuyv") || op.contains("uyvy")) && width % 2 == 1
                {
                    continue;
                }
                let op = settled(&op);
                let made = run(&op, picture.clone()).unwrap_or_else(|error| panic!("{error}"));
                let is_gray = matches!(made, Picture::Gray(_));
                let takes_gray = match stage.input {
                    Input::Any => matches!(picture, Picture::Gray(_)),
                    Input::Gray => true,
                    Input::Rgb => false,
                };
                let expected = match stage.output {
                    Output::Same => takes_gray,
                    Output::Gray => true,
                    Output::Rgb => false,
                };
                assert_eq!(is_gray, expected, "{op} gives what the table says");
            }
        }
    }
}

#[test]
fn the_table_is_sound() {
    let mut names = HashSet::new();
    assert!(table::names().all(|name| names.insert(name)), "no name is used twice");
    for (_, stage) in stages() {
        let mut keys = HashSet::new();
        assert!(stage.parameters.iter().all(|parameter| keys.insert(parameter.name)), "{}", stage.name);
        for parameter in stage.parameters {
            let default = default_of(parameter);
            let again = parameter.kind.parse(&default.to_string());
            assert_eq!(
                again.as_ref(),
                Some(&default),
                "`{}` of `{}` is read as written",
                parameter.name,
                stage.name
            );
        }
        for (alias, first) in stage.aliases {
            parse(alias);
            let kind = stage.parameters.first().map(|parameter| parameter.kind);
            assert!(first.is_empty() || kind.is_some_and(|kind| kind.parse(first).is_some()), "{alias}");
        }
        assert!(
            stage.example.contains(stage.name)
                || stage.aliases.iter().any(|(alias, _)| stage.example.contains(alias))
        );
        parse(stage.example);
    }
}

/// The words that name things of the library are the library's.
#[test]
fn words_are_the_librarys() {
    let words = |name: &str, key: &str| {
        let (stage, _) = table::find(name).unwrap();
        let parameter = stage.parameters.iter().find(|parameter| parameter.name == key).unwrap();
        parameter.kind.words().collect::<Vec<_>>()
    };
    assert!(words("balance", "space").into_iter().skip(1).all(|word| Space::from_name(word).is_some()));
    assert_eq!(words("balance", "space").len(), Space::ALL.len() + 1);
    assert!(words("demosaic", "order").into_iter().all(|word| BayerOrder::from_name(word).is_some()));
    assert!(words("format", "name").into_iter().all(|word| Format::from_name(word).is_some()));
    let operators: HashSet<_> =
        algos_nostd::draw::Operator::ALL.iter().map(|operator| operator.name()).collect();
    assert_eq!(words("composite", "operator").into_iter().collect::<HashSet<_>>(), operators);
}

#[test]
fn help_names_all_stages_and_parameters() {
    assert!(is_help("help") && is_help(" help:canny") && !is_help("helpless"));
    let all = help("help").unwrap();
    for (group, stage) in stages() {
        assert!(all.contains(group.name()) && all.contains(stage.about), "{}", stage.name);
        let one = help(&format!("help:{}", stage.name)).unwrap();
        for parameter in stage.parameters {
            let line = format!("{:<11} {} [", parameter.name, parameter.kind);
            assert!(all.contains(&line), "{}: {}", stage.name, parameter.name);
            assert!(one.contains(parameter.about) && one.contains(parameter.name));
            assert!(parameter.kind.words().all(|word| one.contains(word)));
        }
        assert!(stage.aliases.iter().all(|(alias, _)| one.contains(alias)));
    }
    assert!(help("help:cany").unwrap_err().to_string().contains("did you mean `canny`"));
}

#[test]
fn gray_and_colour_become_one_another() {
    let Picture::Gray(frame) = run("gray", rgb(5, 4)).unwrap() else { panic!("not gray") };
    let Picture::Rgb(back) = run("rgb", Picture::Gray(frame.clone())).unwrap() else { panic!("not colour") };
    assert!(
        back.pixels().iter().zip(frame.pixels()).all(|(pixel, &gray)| *pixel == Rgb::new(gray, gray, gray))
    );
}

#[test]
fn filters_treat_each_channel_by_itself() {
    let Picture::Rgb(colour) = rgb(19, 13) else { panic!("not colour") };
    for op in [
        "gaussian",
        "box:9",
        "median:5",
        "bilateral",
        "morphology:top-hat,size=5",
        "unsharp",
        "morphology:close",
    ] {
        let Picture::Rgb(made) = run(op, colour.clone().into()).unwrap() else { panic!("not colour") };
        for channel in [|pixel: &Rgb| pixel.r, |pixel: &Rgb| pixel.g, |pixel: &Rgb| pixel.b] {
            let mut plane = Frame::filled(19, 13, 0);
            plane
                .pixels_mut()
                .iter_mut()
                .zip(colour.pixels())
                .for_each(|(gray, pixel)| *gray = channel(pixel));
            let Picture::Gray(alone) = run(op, plane.into()).unwrap() else { panic!("not gray") };
            assert!(
                alone.pixels().iter().zip(made.pixels()).all(|(gray, pixel)| *gray == channel(pixel)),
                "{op}"
            );
        }
    }
}

#[test]
fn geometry_comes_back() {
    let picture = rgb(7, 4);
    for op in [
        "flip|flip",
        "flip:vertical|flip:vertical",
        "rotate|rotate:270",
        "rotate:180|rotate:180",
        "crop:at=0x0,size=100%x100%",
        "scale:100%x100%",
    ] {
        assert_eq!(run(op, picture.clone()).unwrap(), picture, "{op}");
    }
    assert_eq!(run("rotate", picture.clone()).unwrap().size(), (4, 7));
    assert_eq!(run("scale:20x5", picture).unwrap().size(), (20, 5));
}

#[test]
fn lines_and_fills_agree_however_they_are_made() {
    let picture = rgb(40, 30);
    let same = |ops: &[&str]| {
        let made: Vec<_> = ops.iter().map(|op| run(op, picture.clone()).unwrap()).collect();
        assert!(made.windows(2).all(|pair| pair[0] == pair[1]), "{ops:?}");
        assert_ne!(made[0], picture, "{ops:?}");
    };
    same(&["line", "line:runs"]);
    same(&[
        "clip",
        "clip:cohen-sutherland",
        "clip:liang-barsky",
        "clip:nicholl-lee-nicholl",
        "clip:nine-regions",
        "clip:cyrus-beck",
    ]);
    let floods = ["span", "walk", "queue", "stack"]
        .map(|method| format!("circle:radius=9,fill=yes|flood:{method},color=blue"));
    same(&floods.each_ref().map(String::as_str));
    same(&["quantize:search=nearest", "quantize:search=exact-map"]);
}

#[test]
fn a_palette_has_no_more_colours_than_asked_for() {
    let (picture, palette) = (rgb(64, 48), "palette=red;#102030;white;blue");
    for method in [
        "wu",
        "median-cut",
        "octree",
        "k-means",
        "local-k-means",
        "neuquant",
        "popularity",
        "fixed",
        "spatial",
    ] {
        for dither in ["none", "floyd-steinberg", "bayer-4", "blue-noise"] {
            let op = format!("quantize:{method},colors=7,dither={dither},{palette}");
            let Picture::Rgb(made) = run(&op, picture.clone()).unwrap() else { panic!("not colour") };
            let colors: HashSet<_> = made.pixels().iter().map(|pixel| (pixel.r, pixel.g, pixel.b)).collect();
            assert!((2..=7).contains(&colors.len()), "{op}: {}", colors.len());
        }
    }
}

#[test]
fn balance_follows_the_light_over_frames() {
    let pipeline = parse("balance:rate=64");
    let mut runner = Runner::new(&pipeline);
    let tinted = |r, g, b| Picture::Rgb(Frame::filled(4, 4, Rgb { r, g, b }));
    let neutral = |picture: Picture| {
        let Picture::Rgb(frame) = picture else { panic!("not colour") };
        let pixel = frame.pixels()[0];
        pixel.r.abs_diff(pixel.g).max(pixel.g.abs_diff(pixel.b))
    };
    assert!(neutral(runner.run(tinted(160, 120, 80)).unwrap()) <= 1, "the first light is taken as it is");
    assert!(neutral(runner.run(tinted(80, 120, 160)).unwrap()) > 20, "a new one is not taken at once");
    let last = (0..40).map(|_| runner.run(tinted(80, 120, 160)).unwrap()).last().unwrap();
    assert!(neutral(last) <= 1, "but in the end");
}
