//! BVH dialects, one at a time: what opens, what is repaired and said so, what is refused and where.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::float_cmp, reason = "values are read exactly")]

use proptest::prelude::*;
use quatfilt_formats::bvh::{Channel, EndSite, File, FrameTime, Joint, parse, write};
use quatfilt_formats::{Error, Precision};

const HIERARCHY: &str = "HIERARCHY
ROOT Hips
{
\tOFFSET 0 90.5 0
\tCHANNELS 3 Zrotation Xrotation Yrotation
\tEnd Site
\t{
\t\tOFFSET 0 1 0
\t}
}
MOTION
";

fn motion(text: &str) -> Result<File, Error> {
    parse(format!("{HIERARCHY}{text}").as_bytes())
}

fn notes(file: &File) -> Vec<String> {
    file.notes.iter().map(ToString::to_string).collect()
}

/// The file, with one note that says `text`.
fn repaired(result: Result<File, Error>, text: &str) -> File {
    let file = result.unwrap();
    let notes = notes(&file);
    assert!(notes.len() == 1 && notes[0].contains(text), "{text:?} is not the one note of {notes:?}");
    file
}

fn refused(result: Result<File, Error>, line: usize, reason: &str) {
    let error = result.unwrap_err();
    assert!(
        error.line == Some(line) && error.reason.contains(reason),
        "line {line} {reason:?}: got {error:?}"
    );
    assert!(!error.reason.contains('\n'));
}

#[test]
fn an_ordinary_file() {
    let file = motion("Frames: 2\nFrame Time: .0083333\n1 -2.5 3e-014\n4 5 -0.0\n").unwrap();
    assert_eq!(file.values, [1.0, -2.5, 3e-14, 4.0, 5.0, 0.0]);
    assert!(file.values[5].is_sign_negative());
    assert_eq!(file.frames, 2);
    assert_eq!(file.frame_time, FrameTime { seconds: 0.008_333_3, text: ".0083333".into() });
    let hips = Joint {
        name: "Hips".into(),
        parent: None,
        offset: [0.0, 90.5, 0.0],
        channels: vec![Channel::Zrotation, Channel::Xrotation, Channel::Yrotation],
        end_sites: vec![EndSite { name: None, offset: [0.0, 1.0, 0.0] }],
    };
    assert_eq!(file.joints, [hips]);
    assert_eq!(file.notes, []);
}

#[test]
fn every_line_end_blank_and_tab() {
    let text = format!("{HIERARCHY}\nFrames:\t2\nFrame Time:\t0.04\n 1  2\t3 \n4 5 6\n\n");
    let plain = parse(text.as_bytes()).unwrap();
    assert_eq!(plain.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(plain.notes, []);
    let mixed = text.replacen('\n', "\r\n", 12);
    for other in [text.replace('\n', "\r\n"), mixed, text.replace('\n', "\r"), text.trim_end().to_owned()] {
        assert_eq!(parse(other.as_bytes()).unwrap(), plain);
    }
}

#[test]
fn blank_lines_between_rows_and_an_end_of_file_mark() {
    let file = motion("Frames: 2\nFrame Time: 1\n1 2 3\n\n \n4 5 6\n\x1a").unwrap();
    assert_eq!(file.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(file.notes, []);
}

#[test]
fn channels_in_any_order_on_any_joint() {
    let text = "HIERARCHY\nROOT a { OFFSET 0 0 0 CHANNELS 6 Zrotation xrotation YROTATION Xposition Yposition Zposition
        JOINT b { CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation OFFSET 1 2 3 }
        JOINT c { OFFSET 1 0 0 CHANNELS 1 Xrotation }
        JOINT d { OFFSET 1 0 0 } }
        MOTION\nFrames: 1\nFrame Time: 1\n1 2 3 4 5 6 7 8 9 10 11 12 13\n";
    let file = parse(text.as_bytes()).unwrap();
    let counts: Vec<_> = file.joints.iter().map(|joint| joint.channels.len()).collect();
    assert_eq!(counts, [6, 6, 1, 0]);
    assert_eq!(file.joints[0].channels[..2], [Channel::Zrotation, Channel::Xrotation]);
    assert_eq!(file.joints[1].offset, [1.0, 2.0, 3.0]);
    assert!(file.joints.iter().all(|joint| joint.end_sites.is_empty()));
    assert_eq!(file.notes, []);
}

#[test]
fn names_with_blanks_colons_numbers_and_other_alphabets() {
    let text = b"HIERARCHY\nROOT mixamorig:Hips \r\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nJOINT LeftUpLeg #1{\n\
        OFFSET 0 0 0\nEnd Site #5\n{\nOFFSET 0 0 1\n}\n}\nJOINT H\xFCfte\n{\nOFFSET 0 0 0\n}\n}\nMOTION\nFrames: 1\n\
        Frame Time: 1\n1\n";
    let file = parse(text).unwrap();
    let names: Vec<_> = file.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["mixamorig:Hips", "LeftUpLeg #1", "Hüfte"]);
    assert_eq!(file.joints[1].end_sites, [EndSite { name: Some("#5".into()), offset: [0.0, 0.0, 1.0] }]);
    assert_eq!(file.joints[2].parent, Some(0));
}

#[test]
fn several_roots() {
    let root = "ROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\n";
    let text = format!(
        "HIERARCHY\n{root}{}MOTION\nFrames: 1\nFrame Time: 1\n1 2\n",
        root.replace("ROOT a", "ROOT b")
    );
    let file = parse(text.as_bytes()).unwrap();
    assert_eq!(file.joints.iter().map(|joint| joint.parent).collect::<Vec<_>>(), [None, None]);
}

#[test]
fn what_is_missing_at_the_start_is_noted() {
    let ordinary = format!("{HIERARCHY}Frames: 1\nFrame Time: 1\n1 2 3\n");
    let no_keyword = ordinary.trim_start_matches("HIERARCHY\n");
    repaired(parse(no_keyword.as_bytes()), "line 1: HIERARCHY missing");
    let marked = format!("\u{feff}{ordinary}");
    repaired(parse(marked.as_bytes()), "line 1: byte-order mark");
    let no_offset = ordinary.replace("\tOFFSET 0 90.5 0\n", "");
    repaired(parse(no_offset.as_bytes()), "line 9: OFFSET missing in joint `Hips` (line 2)");
}

#[test]
fn equal_names_are_noted() {
    let text = HIERARCHY.replace("\tEnd Site", "\tJOINT Hips\n\t{\n\tOFFSET 0 0 0\n\t}\n\tEnd Site");
    let text = format!("{text}Frames: 1\nFrame Time: 1\n1 2 3\n");
    repaired(parse(text.as_bytes()), "line 6: joint `Hips` has the name of that of line 2");
}

#[test]
fn frame_time_missing_or_meaningless() {
    for (text, note) in [
        ("Frames: 1\n1 2 3\n", "line 11: `Frame Time:` missing: 1/30 s"),
        ("Frames: 1\nFrame Time: 0\n1 2 3\n", "line 13: `Frame Time:` `0` is no duration"),
        ("Frames: 1\nFrame Time: -1\n1 2 3\n", "no duration"),
        ("Frames: 1\nFrame Time:\n1 2 3\n", "no duration"),
        ("Frames: 1\nFrame Time: nan\n1 2 3\n", "no duration"),
    ] {
        let file = repaired(motion(text), note);
        assert_eq!(file.frame_time.seconds.to_bits(), (1.0_f64 / 30.0).to_bits());
    }
}

#[test]
fn another_number_of_rows_than_said() {
    let more = repaired(motion("Frames: 1\nFrame Time: 1\n1 2 3\n4 5 6\n"), "says 1, the file has 2");
    assert_eq!(more.frames, 2);
    let fewer = repaired(motion("Frames: 9\nFrame Time: 1\n1 2 3\n4 5 6\n"), "says 9, the file has 2");
    assert_eq!(fewer.frames, 2);
    let unsaid = repaired(motion("Frame Time: 1\n1 2 3\n"), "no number of `Frames:`: the file has 1");
    assert_eq!(unsaid.frames, 1);
    let none = motion("Frames: 0\nFrame Time: 1\n").unwrap();
    assert_eq!((none.frames, none.values.len(), none.notes.len()), (0, 0, 0));
}

#[test]
fn a_last_row_cut_short_is_dropped() {
    for end in ["4 5", "4 5\n", "4 5 -", "4 5 6e-", "-"] {
        let file = motion(&format!("Frames: 2\nFrame Time: 1\n1 2 3\n{end}")).unwrap();
        assert_eq!(file.values, [1.0, 2.0, 3.0], "{end:?}");
        let notes = notes(&file);
        assert!(notes[0].starts_with("line 15: last row cut short"), "{notes:?}");
        assert!(notes[1].contains("says 2, the file has 1"), "{notes:?}");
    }
    // Of three rows, the second may have lost digits of its last number.
    let file = motion("Frames: 3\nFrame Time: 1\n1 2 3\n4 5 6").unwrap();
    assert_eq!(file.values, [1.0, 2.0, 3.0]);
    assert!(notes(&file)[0].contains("the file ends inside row 2"));
    // All rows are there: a missing line end means nothing.
    assert_eq!(motion("Frames: 2\nFrame Time: 1\n1 2 3\n4 5 6").unwrap().notes, []);
}

#[test]
fn values_that_are_no_numbers_are_missing_samples() {
    let file = repaired(
        motion("Frames: 2\nFrame Time: 1\n1 2 3\nnan -nan(ind) inf\n"),
        "line 15: 3 values are not a number: kept as missing",
    );
    assert_eq!(file.values[..3], [1.0, 2.0, 3.0]);
    assert!(file.values[3..].iter().all(|value| value.is_nan()));
    repaired(motion("Frames: 1\nFrame Time: 1\n1 -1.#IND 3\n"), "line 14: 1 value is not a number");
}

#[test]
fn rows_wrapped_over_lines() {
    let file = repaired(motion("Frames: 2\nFrame Time: 1\n1 2\n3 4\n5 6\n"), "line 14: lines are not rows");
    assert_eq!(file.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    refused(motion("Frames: 3\nFrame Time: 1\n1 2\n3 4\n5 6\n"), 14, "expected 3 values in a row, got 2");
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    let header = "Frames: 3\nFrame Time: 1\n1 2 3\n";
    refused(motion(&format!("{header}4 5\n7 8 9\n")), 15, "expected 3 values in a row, got 2");
    refused(motion(&format!("{header}4 5 6 7\n7 8 9\n")), 15, "expected 3 values in a row, got 4");
    refused(motion(&format!("{header}4 x 6\n7 8 9\n")), 15, "expected a number, got `x`");
    refused(motion(&format!("{header}4 5 6 7\n")), 15, "got 4");
    refused(motion("Frames: 3\nFrame Time: 1\n1,5 2 3\n4 5 6\n"), 14, "expected a number, got `1,5`");
    refused(motion("Frames: 3\nFrame Time: 1\n"), 14, "no complete row of 3 values");
    refused(motion("Frames: 3\nFrame Time: 1\n1 2"), 14, "expected 3 values in a row, got 2");
    refused(motion("Frame Time: 1\n"), 13, "no complete row");
    refused(motion("Frames: 3\nPlayback: 1\n1 2 3"), 13, "expected `Frames:`, `Frame Time:` or a row");
    refused(motion("Frames: 18446744073709551615\nFrame Time: 1\n1 2\n3\n"), 14, "got 2");
}

#[test]
fn hierarchies_that_are_none_are_refused() {
    let cut =
        |lines: usize| -> String { HIERARCHY.lines().take(lines).flat_map(|line| [line, "\n"]).collect() };
    refused(parse(b"MOTION\nFrames: 1\n"), 1, "MOTION without a HIERARCHY");
    refused(parse(b"solid cube\n"), 1, "not BVH: expected HIERARCHY, got `solid`");
    refused(parse(b"HIERARCHY\nMOTION\n"), 2, "MOTION without a ROOT");
    refused(parse(cut(1).as_bytes()), 2, "the file ends before MOTION");
    refused(parse(cut(2).as_bytes()), 3, "the file ends after `Hips`");
    refused(parse(cut(4).as_bytes()), 5, "the file ends inside joint `Hips` (line 2)");
    refused(parse(cut(8).as_bytes()), 9, "the file ends inside the End Site of line 6");
    refused(parse(cut(10).as_bytes()), 11, "the file ends before MOTION");
    for (old, new, line, reason) in [
        ("OFFSET 0 90.5 0", "OFFSET 0 90.5", 5, "OFFSET: expected three finite numbers, got `CHANNELS`"),
        ("OFFSET 0 90.5 0", "OFFSET 0 nan 0", 4, "got `nan`"),
        ("OFFSET 0 90.5 0", "OFFSET 0 0 0\nOFFSET 0 0 0", 5, "second OFFSET in joint `Hips` (line 2)"),
        ("CHANNELS 3", "CHANNELS 2", 5, "got `Yrotation`"),
        ("CHANNELS 3", "CHANNELS 4", 6, "CHANNELS: expected 4 like Xposition or Zrotation, got `End`"),
        ("CHANNELS 3", "CHANNELS 9", 5, "expected at most 6, got 9"),
        ("CHANNELS 3", "CHANNELS", 5, "CHANNELS: expected their number, got `Zrotation`"),
        ("Zrotation X", "Xrotation X", 5, "Xrotation comes twice"),
        ("\t}\n}\nMOTION", "\t}\nMOTION", 10, "MOTION inside joint `Hips` (line 2): a `}` is missing"),
        ("}\nMOTION", "}\n}\nMOTION", 11, "`}` outside of a ROOT"),
        ("\t}\n}\nMOTION", "\t}\nROOT b\n{\n}\n}\nMOTION", 10, "ROOT inside joint"),
        ("ROOT Hips\n", "ROOT\n", 2, "a joint without a name"),
        ("ROOT Hips\n{", "ROOT Hips\nOFFSET", 3, "expected `{` after `Hips`, got `OFFSET`"),
        ("ROOT Hips", "JOINT Hips", 2, "JOINT outside of a ROOT"),
        ("End Site", "End Effector", 6, "expected End Site, got End `Effector`"),
        ("\tCHANNELS 3 Zrotation Xrotation Yrotation\n", "", 10, "no joint has CHANNELS"),
    ] {
        let text = HIERARCHY.replacen(old, new, 1);
        assert_ne!(text, HIERARCHY);
        refused(parse(format!("{text}Frames: 1\nFrame Time: 1\n1 2 3\n").as_bytes()), line, reason);
    }
}

#[test]
fn what_is_no_text_is_refused() {
    assert!(parse(b"").unwrap_err().reason.contains("empty"));
    refused(parse(b"\x89PNG\r\n\x1a\n\0\0"), 3, "binary data");
    let mut holes = format!("{HIERARCHY}Frames: 2\nFrame Time: 1\n1 2 3\n").into_bytes();
    holes.extend([0; 9000]);
    refused(parse(&holes), 15, "binary data");
}

#[test]
fn joints_that_are_not_depth_first_are_written_so_with_their_columns() {
    let joint = |name: &str, parent, count: usize| Joint {
        name: name.into(),
        parent,
        channels: Channel::ALL[..count].to_vec(),
        ..Joint::default()
    };
    let joints =
        [joint("a", None, 1), joint("b", Some(0), 1), joint("c", Some(0), 2), joint("d", Some(1), 1)];
    let values = [1.0, 2.0, 3.0, 4.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0];
    let text = write(&joints, &FrameTime::new(0.01), &values, Precision::Shortest).unwrap();
    let file = parse(&text).unwrap();
    let names: Vec<_> = file.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "d", "c"]);
    assert_eq!(file.values, [1.0, 2.0, 5.0, 3.0, 4.0, 10.0, 20.0, 50.0, 30.0, 40.0]);
}

#[test]
fn the_text_that_is_written() {
    let file = motion("Frames: 2\nFrame Time: .0400\n1 -2.5 nan\n4 5 6.25\n").unwrap();
    let text = write(&file.joints, &file.frame_time, &file.values, Precision::Shortest).unwrap();
    let expected = format!("{HIERARCHY}Frames: 2\nFrame Time: .0400\n1 -2.5 nan\n4 5 6.25\n");
    assert_eq!(String::from_utf8(text).unwrap(), expected);
    let slower = FrameTime { seconds: 0.05, ..file.frame_time };
    let text = write(&file.joints, &slower, &file.values, Precision::Decimals(3)).unwrap();
    let expected = format!("{HIERARCHY}Frames: 2\nFrame Time: 0.05\n1.000 -2.500 nan\n4.000 5.000 6.250\n");
    assert_eq!(String::from_utf8(text).unwrap(), expected);
}

#[test]
fn what_cannot_be_written_is_refused() {
    let file = motion("Frames: 1\nFrame Time: 1\n1 2 3\n").unwrap();
    let attempt = |change: &dyn Fn(&mut Joint), values: &[f64], seconds: f64| {
        let mut joints = file.joints.clone();
        change(&mut joints[0]);
        write(&joints, &FrameTime::new(seconds), values, Precision::Shortest).unwrap_err().reason
    };
    let keep = |_: &mut Joint| ();
    assert!(attempt(&keep, &[1.0, 2.0], 1.0).contains("2 values: expected rows of 3"));
    assert!(attempt(&keep, &file.values, 0.0).contains("frame time"));
    assert!(attempt(&|joint| joint.name = "a\nb".into(), &file.values, 1.0).contains("joint name"));
    assert!(attempt(&|joint| joint.name = " a".into(), &file.values, 1.0).contains("joint name"));
    assert!(
        attempt(&|joint| joint.parent = Some(0), &file.values, 1.0).contains("expected a parent before it")
    );
    assert!(attempt(&|joint| joint.offset[1] = f64::NAN, &file.values, 1.0).contains("finite offsets"));
    assert!(attempt(&|joint| joint.channels[1] = joint.channels[0], &file.values, 1.0).contains("twice"));
    assert!(attempt(&|joint| joint.channels.clear(), &file.values, 1.0).contains("expected rows of 0"));
}

#[test]
fn long_files_are_the_same_in_a_pool_and_outside() {
    let rows: usize = 150_000;
    let values: Vec<f64> =
        (0..3 * rows).map(|i| (i as f64).sqrt() * if i % 2 == 0 { 1.0 } else { -1e-3 }).collect();
    let joints = motion("Frames: 0\nFrame Time: 1\n").unwrap().joints;
    let frame_time = FrameTime::new(1.0 / 120.0);
    let alone = write(&joints, &frame_time, &values, Precision::Shortest).unwrap();
    assert!(alone.len() > 4 << 20, "several chunks");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let (text, together) = pool.install(|| {
        (write(&joints, &frame_time, &values, Precision::Shortest).unwrap(), parse(&alone).unwrap())
    });
    assert_eq!(text, alone);
    assert_eq!(parse(&alone).unwrap(), together);
    assert_eq!(together.values, values);
    let mut broken = alone;
    let end = broken.len() - 3;
    broken[end - 400_000] = b'x';
    let errors = pool.install(|| parse(&broken).unwrap_err());
    assert_eq!(parse(&broken).unwrap_err(), errors);
    assert!(errors.line.is_some());
}

fn joints() -> impl Strategy<Value = Vec<Joint>> {
    let name = "[A-Za-z][A-Za-z0-9:_#]{0,6}( [a-z#0-9]{1,4})?";
    let offset = prop::array::uniform3(-100.0..100.0_f64);
    let site =
        (prop::option::of("#[0-9]{1,2}"), offset.clone()).prop_map(|(name, offset)| EndSite { name, offset });
    let channels = prop::sample::subsequence(Channel::ALL.to_vec(), 0..=6).prop_shuffle();
    let joint = (name, offset, channels, prop::collection::vec(site, 0..3), any::<prop::sample::Index>());
    prop::collection::vec(joint, 1..8).prop_map(|drafts| {
        let mut joints: Vec<Joint> = Vec::new();
        for (index, (name, offset, channels, end_sites, parent)) in drafts.into_iter().enumerate() {
            // A parent on the branch of the joint before keeps the order depth first.
            let mut branch = vec![None];
            let mut ancestor = index.checked_sub(1);
            while let Some(joint) = ancestor {
                branch.push(Some(joint));
                ancestor = joints[joint].parent;
            }
            joints.push(Joint {
                name: format!("{name}{index}"),
                parent: *parent.get(&branch),
                offset,
                channels,
                end_sites,
            });
        }
        if joints.iter().all(|joint| joint.channels.is_empty()) {
            joints[0].channels = vec![Channel::Yrotation];
        }
        joints
    })
}

proptest! {
    #[test]
    fn what_is_written_reads_back(
        joints in joints(),
        rows in 0_usize..5,
        seconds in 1e-4..1.0_f64,
        seed in prop::collection::vec(prop_oneof![-180.0..180.0_f64, any::<f64>().prop_filter("finite", |v| v.is_finite())], 200),
    ) {
        let channels: usize = joints.iter().map(|joint| joint.channels.len()).sum();
        let values = &seed[..rows * channels.min(40)];
        prop_assume!(values.len() == rows * channels);
        let frame_time = FrameTime::new(seconds);
        let text = write(&joints, &frame_time, values, Precision::Shortest).unwrap();
        let file = parse(&text).unwrap();
        prop_assert_eq!(&file.joints, &joints);
        prop_assert_eq!(&file.frame_time, &frame_time);
        prop_assert_eq!(&file.values, &values);
        prop_assert_eq!(file.frames, rows);
        prop_assert!(file.notes.is_empty());
        prop_assert_eq!(write(&file.joints, &file.frame_time, &file.values, Precision::Shortest).unwrap(), text);
    }

    #[test]
    fn damaged_files_are_read_or_refused(cut in 0_usize..400, at in 0_usize..400, byte in any::<u8>()) {
        let mut text = format!("{HIERARCHY}Frames: 3\nFrame Time: 0.1\n1 2 3\n4.5 -6e-3 nan\n7 8 9\n").into_bytes();
        text.truncate(text.len() - cut.min(text.len()));
        if let Some(place) = text.get_mut(at) {
            *place = byte;
        }
        if let Ok(file) = parse(&text) {
            let channels: usize = file.joints.iter().map(|joint| joint.channels.len()).sum();
            prop_assert_eq!(file.values.len(), file.frames * channels);
        }
    }

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(parse(&bytes).is_err());
    }
}
