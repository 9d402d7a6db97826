//! Every kind of value change, what is wrong with a text, and damage.

use super::*;

const HEAD: &str = "$timescale 1 ns $end $var wire 1 ! PCLK $end $var wire 1 \" HS $end $var wire 1 # VS $end
$var wire 8 $ D [7:0] $end $var wire 1 long-identifier other $end $var real 64 & t $end $var wire 70 wide w $end
$enddefinitions $end\n";

fn after_head(changes: &str) -> Result<Vec<Clock>, VcdError> {
    usual(&format!("{HEAD}{changes}"))
}

#[test]
fn every_kind_of_change_and_blank_is_understood() {
    let clocks = after_head(
        "$dumpvars x! 1\" 0# bx $ 0long-identifier r0.5 & $end\r\n#10\r\n0!\r\nb101 $\r\n#20 1! 1long-identifier\t\
         #30 0!\nBZ01 $\nr-1e9 &\nb1111111111111111111111111111111111111111111111111111111111111111111111 wide\n\
         $comment 1! #99 $dumpall $end\n#40 1! 0\"\n#000000000000000050 0!\nb11110000 $\n#12345678901234567890\n1!",
    );
    assert_eq!(clocks.unwrap(), [(true, false, 5), (false, false, 1), (false, false, 0xF0)]);
}

#[test]
fn an_identifier_is_not_taken_for_a_longer_one() {
    let head = HEAD.replace("long-identifier", "abcdefg").replace("wire 1 \"", "wire 1 abcdefgh");
    let text = format!("{head}#0 0! 1abcdefgh #1 1! #2 0! 0abcdefg #3 1! #4 0! 0abcdefgh #5 1!");
    assert_eq!(usual(&text).unwrap(), [(true, false, 0), (true, false, 0), (false, false, 0)]);
    assert!(usual(&format!("{head}#0 1abcdefghi")).unwrap_err().to_string().contains("`abcdefghi`"));
}

#[test]
fn unknown_values_read_as_zero_and_are_counted() {
    let text = format!("{HEAD}#0 0! bx1xx $ z\" xlong-identifier #1 1! #2 x! #3 1! #4");
    let (clocks, played) = read(text.as_bytes(), &CaptureOptions::default()).unwrap();
    assert_eq!(clocks, [(false, false, 4); 2]);
    assert_eq!(played.unknown, 3);
}

#[test]
fn what_is_dumped_as_standing_is_no_edge() {
    let one = [(false, false, 1)];
    // The clock stands high; then one edge.
    assert_eq!(after_head("#0 $dumpvars 1! b0 $ $end #1 0! b1 $ #2 1! #3").unwrap(), one);
    assert_eq!(after_head("$dumpvars 1! b0 $ $end #0 #1 b1 $ #2 0! #3 1! #4").unwrap(), one);
    assert_eq!(after_head("#0 $dumpvars 1! bx $ $end #1 0! #2 1! b1 $ #3").unwrap(), one);
    // Held until the clock falls, that was the first sample.
    assert_eq!(
        after_head("#0 $dumpvars 1! b1 $ $end #1 0! #2 b10 $ #3 1!").unwrap(),
        [one[0], (false, false, 2)]
    );
    // A pause of the dump is no edge either.
    assert_eq!(
        after_head("#0 0! b1 $ #1 1! #2 0! #3 $dumpoff x! $end #4 $dumpon 1! $end #5 0!").unwrap(),
        one
    );
    // Without such a section the first level is an edge: a generator that begins with one is taken at its word.
    assert_eq!(after_head("#0 b1 $ 1! #1 0! #2").unwrap(), one);
    // A checkpoint repeats what is there.
    assert_eq!(after_head("#0 0! b1 $ #1 1! $dumpall 1! b1 $ $end #2 0!").unwrap(), one);
}

#[test]
fn the_order_within_a_time_stamp_does_not_matter_but_the_sample_point_does() {
    for changes in [
        "#0 0! #5 b1 $ 1! #6 0! #7 b10 $ 1! #8",
        "#0 0! #5 1! b1 $ #6 0! #7 1! b10 $",
        "#0 0! #5 1! #5 b1 $ #6 0! #7 1! b10 $",
    ] {
        assert_eq!(after_head(changes).unwrap(), [(false, false, 1), (false, false, 2)]);
        let before = CaptureOptions { sample_point: SamplePoint::BeforeEdge, ..CaptureOptions::default() };
        let (clocks, _) = read(format!("{HEAD}{changes}").as_bytes(), &before).unwrap();
        assert_eq!(clocks, [(false, false, 0), (false, false, 1)]);
    }
    let falling = CaptureOptions { edge: Edge::Falling, ..CaptureOptions::default() };
    let (clocks, _) = read(format!("{HEAD}#0 1! b1 $ #1 0! #2 1! b10 $ #3 0!").as_bytes(), &falling).unwrap();
    assert_eq!(clocks, [(false, false, 1), (false, false, 2)]);
}

#[test]
fn errors_say_where_and_what() {
    for (changes, line, expected) in [
        ("#0 0!\n#5 1?\n", 5, "identifier `?`"),
        ("#0\n1\n#5", 5, "without an identifier"),
        ("#5\n#4", 5, "time 4 comes after 5"),
        ("#5x", 4, "`#5x` is not a time"),
        ("#", 4, "`#` is not a time"),
        ("#99999999999999999999", 4, "is not a time"),
        ("b102 $", 4, "`b102` is neither"),
        ("b111111111 $", 4, "8 bits"),
        ("b $", 4, "`b` does not fit"),
        ("b1", 4, "without an identifier"),
        ("1$", 4, "`1` does not fit identifier `$`, declared with 8 bits"),
        ("r1.5 !", 4, "`r1.5` does not fit"),
        ("\n\nq!", 6, "`q!` is neither"),
        ("$comment no end", 4, "inside `a $ section`"),
        ("$dumpvars 1!", 4, "inside `$dumpvars`"),
        ("$end", 4, "`$end` among the value changes"),
        ("$var wire 1 ! A $end", 4, "`$var` among"),
        ("#0 0! #5", 4, "no rising edge"),
    ] {
        let error = after_head(changes).unwrap_err();
        assert!(error.to_string().contains(expected), "{changes:?}: {error}");
        if let VcdError::Text { place, .. } = error {
            assert_eq!(place.line, line, "{changes:?}: {error}");
        }
    }
    let no_clock = "$var wire 1 ! CH0 $end $enddefinitions $end #0 1!";
    assert!(usual(no_clock).unwrap_err().to_string().contains("--map PCLK="));
}

#[test]
fn every_truncation_and_every_flipped_bit_of_a_dump_is_a_trace_or_a_typed_error() {
    let text = format!(
        "{HEAD}$dumpvars 0! 1\" 0# b0 $ $end\n#10\n1!\n#20\n0!\nb10x1 $\n#30\n1!\n0long-identifier\n#40\n"
    );
    let whole = usual(&text).unwrap();
    assert_eq!(whole.len(), 2);
    for length in 0..text.len() {
        if let Ok(clocks) = usual(&text[..length]) {
            assert!(whole.starts_with(&clocks), "cut at {length}");
        }
    }
    let mut refused = 0;
    for bit in 0..text.len() * 8 {
        let mut flipped = text.clone().into_bytes();
        flipped[bit / 8] ^= 1 << (bit % 8);
        match read(&flipped, &CaptureOptions::default()) {
            Ok((clocks, _)) => assert!(clocks.len() <= 4, "bit {bit}"),
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().is_empty());
            }
        }
    }
    assert!(refused > text.len(), "{refused}");
}
