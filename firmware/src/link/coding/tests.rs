use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;

fn coded(format: Format, encoding: Encoding, pixels: &[u8]) -> Option<(Vec<u8>, u8)> {
    let mut room = vec![0; 2 * pixels.len() + 8];
    let length = encode_one(format, encoding, pixels, &mut room)?;
    room.truncate(length);
    let unused = if encoding == Encoding::Bits { unused_bits(pixels.len()) } else { 0 };
    Some((room, unused))
}

#[test]
fn each_encoding_holds_what_the_page_says() {
    for format in Format::ALL {
        for encoding in Encoding::ALL {
            let allowed = match encoding {
                Encoding::Raw | Encoding::RunLength => true,
                Encoding::Qoi => ["rgb888", "gray8", "raw8"].contains(&format.name()),
                Encoding::Bits | Encoding::BitsRunLength => format.name() == "gray8",
            };
            assert_eq!(coded(format, encoding, &[0; 24]).is_some(), allowed, "{format:?} {encoding:?}");
        }
    }
    for encoding in [Encoding::Bits, Encoding::BitsRunLength] {
        assert_eq!(coded(Format::GRAY8, encoding, &[0, 255, 254]), None);
    }
}

#[test]
fn sizes_of_plain_lines() {
    let size = |format, encoding, pixels: &[u8]| coded(format, encoding, pixels).unwrap().0.len();
    assert_eq!(size(Format::RGB888, Encoding::Qoi, &[0; 1920]), 11);
    assert_eq!(size(Format::RGB888, Encoding::RunLength, &[0; 1920]), 20);
    assert_eq!(size(Format::GRAY8, Encoding::RunLength, &[0; 640]), 10);
    assert_eq!(size(Format::GRAY8, Encoding::Bits, &[255; 641]), 81);
    assert_eq!(size(Format::GRAY8, Encoding::BitsRunLength, &[255; 640]), 4);
    // Two equal bytes do not part literals.
    assert_eq!(size(Format::GRAY8, Encoding::RunLength, &[1, 2, 2, 3]), 5);
    assert_eq!(size(Format::GRAY8, Encoding::RunLength, &[2, 2, 3]), 4);
}

#[test]
fn the_sender_takes_what_is_short() {
    let mut room = [0; 1919];
    let mut chosen = |format, pixels: &[u8]| {
        encode(format, Choice::Sender, pixels, &mut room[..pixels.len() - 1]).map(|(encoding, _)| encoding)
    };
    assert_eq!(chosen(Format::GRAY8, &[0; 640]), Some(Encoding::BitsRunLength));
    let dense: Vec<u8> = (0..640).map(|x| if x * x % 7 < 3 { 255 } else { 0 }).collect();
    assert_eq!(chosen(Format::GRAY8, &dense), Some(Encoding::Bits));
    assert_eq!(chosen(Format::GRAY8, &[7; 640]), Some(Encoding::Qoi));
    assert_eq!(chosen(Format::RGB888, &[7; 1920]), Some(Encoding::Qoi));
    assert_eq!(chosen(Format::Index8, &[7; 640]), Some(Encoding::RunLength));
    let noise: Vec<u8> = (0..1920u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    assert_eq!(chosen(Format::RGB888, &noise), None);
}

fn any_pixels() -> impl Strategy<Value = Vec<u8>> {
    let byte = prop_oneof![Just(0u8), Just(255), 0..6u8, any::<u8>()];
    let runs = prop::collection::vec((byte, 1..140usize), 0..30);
    runs.prop_map(|runs| runs.into_iter().flat_map(|(byte, count)| vec![byte; count]).collect())
}

proptest! {
    #[test]
    fn pixels_come_back(pixels in any_pixels(), map in any::<bool>(), mixed in any::<u64>()) {
        for format in Format::ALL {
            let mut pixels: Vec<u8> = pixels.iter().map(|&p| if map && p < 100 { 0 } else if map { 255 } else { p }).collect();
            pixels.truncate(pixels.len() / format.unit_bytes() * format.unit_bytes());
            if mixed.is_multiple_of(3) {
                pixels.iter_mut().zip(0u64..).for_each(|(p, at)| *p ^= (mixed.rotate_left(at as u32) & 1) as u8);
            }
            for encoding in Encoding::ALL {
                let Some((coded, unused)) = coded(format, encoding, &pixels) else { continue };
                let mut back = vec![0xEE; pixels.len()];
                prop_assert_eq!(decode(format, encoding, unused, &coded, &mut back), Some(pixels.len()));
                prop_assert_eq!(&back, &pixels);
                if let Some(short) = back.len().checked_sub(1) {
                    prop_assert_eq!(decode(format, encoding, unused, &coded, &mut back[..short]), None);
                }
            }
        }
    }

    #[test]
    fn nothing_breaks_on_any_payload(payload in prop::collection::vec(any::<u8>(), 0..200), room in 0..600usize) {
        let mut back = vec![0; room];
        for format in Format::ALL {
            for encoding in Encoding::ALL {
                for unused in [0, 3] {
                    if let Some(length) = decode(format, encoding, unused, &payload, &mut back) {
                        prop_assert!(length <= room);
                    }
                }
            }
        }
    }
}
