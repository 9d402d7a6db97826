//! What holds for any text and any values.

use algos_nostd::image::Rgb;
use proptest::prelude::*;

use super::kind::Kind;
use super::parse::{Invocation, default_of};
use super::table::{self, stages};
use super::value::Value;
use super::{Frame, Pipeline, Runner};

/// Any value of a kind.
fn value(kind: Kind) -> BoxedStrategy<Value> {
    let place = || {
        (0..2000i32, 0..2000i32, any::<bool>()).prop_map(|(x, y, percent)| {
            if percent { format!("{}%x{}%", x / 2 + 1, y / 2 + 1) } else { format!("{}x{}", x + 1, y + 1) }
        })
    };
    let texts = |one: BoxedStrategy<String>, least: usize, most: usize| {
        prop::collection::vec(one, least..=most).prop_map(|items| items.join(";")).boxed()
    };
    let text: BoxedStrategy<String> = match kind {
        Kind::Integer(least, most) => (least..=most).prop_map(|number| number.to_string()).boxed(),
        Kind::OneOf(numbers) => prop::sample::select(numbers).prop_map(|number| number.to_string()).boxed(),
        Kind::Decimal(least, most) => {
            (least..=most).prop_map(|number| Value::Decimal(number).to_string()).boxed()
        }
        Kind::Word(words) => prop::sample::select(words).prop_map(|(word, _)| word.to_owned()).boxed(),
        Kind::Color => "#[0-9a-f]{6}".boxed(),
        Kind::Colors(_) => texts("#[0-9a-f]{6}".boxed(), 1, 5),
        Kind::Place | Kind::Size => place().boxed(),
        Kind::Places(least, most) => texts(place().boxed(), least, most.min(6)),
        Kind::Pairs(least, most) => {
            let pair = (any::<u8>(), any::<u8>()).prop_map(|(from, to)| format!("{from}:{to}"));
            texts(pair.boxed(), least, most.min(6))
        }
        Kind::Numbers(counts, least, most) => {
            let number = (least..=most).prop_map(|number| Value::Decimal(number).to_string()).boxed();
            prop::sample::select(counts)
                .prop_flat_map(move |count| prop::collection::vec(number.clone(), count))
                .prop_map(|items| items.join(";"))
                .boxed()
        }
        Kind::Text => "[ -~é\\\\,|]{0,12}".prop_map(|text| text.trim().to_owned()).boxed(),
    };
    text.prop_map(move |text| kind.parse(&text).unwrap_or_else(|| panic!("{kind}: {text}"))).boxed()
}

fn invocation() -> impl Strategy<Value = Invocation> {
    prop::sample::select(stages().map(|(_, stage)| stage).collect::<Vec<_>>()).prop_flat_map(|stage| {
        let values: Vec<_> = stage
            .parameters
            .iter()
            .map(|parameter| prop_oneof![Just(default_of(parameter)), value(parameter.kind)])
            .collect();
        values.prop_map(move |values| Invocation { stage, values, text: String::new() })
    })
}

proptest! {
    #[test]
    fn what_is_printed_is_read_as_the_same(stages in prop::collection::vec(invocation(), 1..4)) {
        let pipeline = Pipeline { stages };
        let text = pipeline.to_string();
        prop_assert_eq!(text.parse::<Pipeline>().map_err(|error| error.to_string()), Ok(pipeline), "{}", text);
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,40}") {
        let _ = text.parse::<Pipeline>();
    }

    #[test]
    fn no_text_that_is_nearly_right_panics(
        name in prop::sample::select(table::names().collect::<Vec<_>>()),
        rest in "[:=,;|x%#.0-9a-z\\\\ -]{0,24}",
    ) {
        let _ = format!("{name}:{rest}").parse::<Pipeline>();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the values are, a stage makes a picture or says why not.
    #[test]
    fn no_values_panic(stage in invocation(), width in 1usize..12, height in 1usize..12) {
        let text = stage.to_string();
        let pipeline = Pipeline { stages: vec![stage] };
        // A size in pixels is up to 4096 a side: that takes its time, and is the library's to test.
        prop_assume!(!text.starts_with("scale") && !text.contains("spatial"));
        let mut frame = Frame::filled(width, height, Rgb::default());
        for (index, pixel) in (0u8..=255).cycle().zip(frame.pixels_mut()) {
            *pixel = Rgb { r: index.wrapping_mul(37), g: index, b: index.wrapping_mul(101) };
        }
        let _ = Runner::new(&pipeline).run(frame.into());
    }
}
