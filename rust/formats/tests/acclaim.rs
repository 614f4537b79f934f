//! Dialects of Acclaim skeletons and motions, one at a time.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::float_cmp, reason = "values are read exactly")]

use proptest::prelude::*;
use quatfilt_formats::Error;
use quatfilt_formats::acclaim::{AngleUnit, Axis, Dof, Motion, Skeleton, parse_amc, parse_asf};

const ASF: &str = "# made by hand
:version 1.10
:name two legs
:namespace LEGS
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   free text: begin order axis
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 1.5 0
   orientation 0 0 90
:bonedata
  begin
     id 1
     name hip
     direction 1 0 0
     length 2.5
     axis 0 0 0  XYZ
  end
  begin
     id 2
     name femur
     direction 0.34202 -0.939693 7.62852e-016
     length 7.1
     axis 0 0 20   XYZ
    bodymass 3
    dof rx ry rz
    limits (-160.0 20.0)
           (-inf inf)
           (-70.0 60.0)
  end
  begin
     id 3
     name tibia
     direction 0 -1 0
     length 7
     axis 90 10 0 ZYX
    dof rz rx
    limits (-10.0 170.0) (0 1)
  end
:hierarchy
  begin
    root hip
    hip femur
    femur tibia
  end
:skin skin.dat
  whatever
";

const AMC: &str = "#!OML:ASF legs
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 4 5 6
femur 7 8 9
tibia -10 1.5e-014
2
root 11 12 13 14 15 16
femur 17 18 19
tibia 20 21
";

const FIRST: [f64; 11] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, -10.0, 1.5e-14];
const SECOND: [f64; 11] = [11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0, 21.0];

fn skeleton() -> Skeleton {
    parse_asf(ASF.as_bytes()).unwrap()
}

fn amc(text: &str) -> Result<Motion, Error> {
    parse_amc(text.as_bytes(), &skeleton())
}

/// The text with its first `old` made `new`.
fn change(text: &str, old: &str, new: &str) -> String {
    let changed = text.replacen(old, new, 1);
    assert_ne!(changed, text, "{old:?} is not there");
    changed
}

fn refused<T: std::fmt::Debug>(result: Result<T, Error>, line: Option<usize>, reason: &str) {
    let error = result.unwrap_err();
    assert!(error.line == line && error.reason.contains(reason), "{line:?} {reason:?}: got {error:?}");
}

fn notes(notes: &[quatfilt_formats::Note]) -> Vec<String> {
    notes.iter().map(ToString::to_string).collect()
}

#[test]
fn an_ordinary_skeleton() {
    let skeleton = skeleton();
    assert_eq!(skeleton.notes, []);
    assert_eq!(skeleton.name, "two legs");
    assert_eq!(
        (skeleton.units.mass, skeleton.units.length, skeleton.units.angle),
        (1.0, 0.45, AngleUnit::Degrees)
    );
    assert_eq!(skeleton.root.order, [Dof::Tx, Dof::Ty, Dof::Tz, Dof::Rx, Dof::Ry, Dof::Rz]);
    assert_eq!(skeleton.root.axis_order, [Axis::X, Axis::Y, Axis::Z]);
    assert_eq!((skeleton.root.position, skeleton.root.orientation), ([0.0, 1.5, 0.0], [0.0, 0.0, 90.0]));
    assert_eq!(
        skeleton.bones.iter().map(|bone| bone.name.as_str()).collect::<Vec<_>>(),
        ["hip", "femur", "tibia"]
    );
    assert_eq!(skeleton.bones.iter().map(|bone| bone.parent).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
    let [hip, femur, tibia] = &skeleton.bones[..] else { panic!("three bones") };
    assert!(hip.dof.is_empty() && hip.limits.is_empty());
    assert_eq!((femur.direction, femur.length), ([0.342_02, -0.939_693, 7.628_52e-16], 7.1));
    assert_eq!((femur.axis, femur.axis_order), ([0.0, 0.0, 20.0], [Axis::X, Axis::Y, Axis::Z]));
    assert_eq!(femur.limits, [[-160.0, 20.0], [f64::NEG_INFINITY, f64::INFINITY], [-70.0, 60.0]]);
    assert_eq!((tibia.axis, tibia.axis_order), ([90.0, 10.0, 0.0], [Axis::Z, Axis::Y, Axis::X]));
    assert_eq!(tibia.dof, [Dof::Rz, Dof::Rx]);
    assert_eq!(tibia.limits, [[-10.0, 170.0], [0.0, 1.0]]);
    assert_eq!(skeleton.columns(), 11);
}

#[test]
fn line_ends_case_and_latin1() {
    for text in [ASF.replace('\n', "\r\n"), ASF.replacen('\n', "\r\n", 20)] {
        assert_eq!(parse_asf(text.as_bytes()).unwrap(), skeleton());
    }
    let lower = change(ASF, "order TX TY TZ RX RY RZ", "order tx ty tz rx ry rz");
    assert_eq!(parse_asf(lower.as_bytes()).unwrap(), skeleton());
    let mut latin1 = b"# gr\xFC\xDFe\n".to_vec();
    latin1.extend_from_slice(ASF.as_bytes());
    assert_eq!(parse_asf(&latin1).unwrap(), skeleton());
    let mut motion = b"# gr\xFC\xDFe\r\n".to_vec();
    motion.extend_from_slice(AMC.as_bytes());
    assert_eq!(parse_amc(&motion, &skeleton()).unwrap(), amc(AMC).unwrap());
}

#[test]
fn degrees_of_freedom_of_every_kind() {
    let text = change(ASF, "dof rx ry rz", "dof TX l rz");
    assert_eq!(parse_asf(text.as_bytes()).unwrap().bones[1].dof, [Dof::Tx, Dof::Length, Dof::Rz]);
    let text = change(ASF, "    dof rx ry rz\n", "    dof\n");
    assert!(parse_asf(text.as_bytes()).unwrap().bones[1].dof.is_empty());
}

#[test]
fn bones_come_after_their_parents() {
    let text = change(
        ASF,
        "    root hip\n    hip femur\n    femur tibia\n",
        "    tibia hip\n    root femur\n    femur tibia\n",
    );
    let skeleton = parse_asf(text.as_bytes()).unwrap();
    assert_eq!(
        skeleton.bones.iter().map(|bone| bone.name.as_str()).collect::<Vec<_>>(),
        ["femur", "tibia", "hip"]
    );
    assert_eq!(skeleton.bones.iter().map(|bone| bone.parent).collect::<Vec<_>>(), [None, Some(0), Some(1)]);
    let motion = parse_amc(AMC.as_bytes(), &skeleton).unwrap();
    assert_eq!(motion.values[..11], FIRST);
}

#[test]
fn what_a_skeleton_lacks_is_noted() {
    for (old, new, note) in [
        (
            "    femur tibia\n",
            "",
            "line 36: bone `tibia` (line 36) is missing from :hierarchy: attached to the root",
        ),
        (":units\n  mass 1.0\n  length 0.45\n  angle deg\n", "", "no :units section"),
        ("   order TX TY TZ RX RY RZ\n", "", "root: no `order`"),
        ("     axis 0 0 20   XYZ\n", "", "bone `femur` has no `axis`"),
        ("axis 0 0 20   XYZ", "axis 0 0 20", "line 29: axis: no order of the axes: XYZ assumed"),
        ("(-inf inf)", "(-inf)", "line 33: limits: `-inf)` is no pair of numbers"),
        ("# made", "\u{feff}# made", "line 1: byte-order mark"),
    ] {
        let skeleton = parse_asf(change(ASF, old, new).as_bytes()).unwrap();
        let notes = notes(&skeleton.notes);
        assert!(notes.len() == 1 && notes[0].contains(note), "{note}: {notes:?}");
    }
}

#[test]
fn skeletons_that_are_none_are_refused() {
    for (old, new, line, reason) in [
        ("# made by hand\n", "made by hand\n", 1, "not ASF: expected `:version`, got `made by hand`"),
        ("angle deg", "angle grad", 8, "angle: expected deg or rad, got `grad`"),
        ("length 0.45", "length -1", 7, "length: expected a positive number, got -1"),
        ("dof rx ry rz", "dof rx rw", 31, "expected tx ty tz rx ry rz or l, got `rw`"),
        ("dof rx ry rz", "dof rx rx", 31, "`rx` comes twice"),
        ("direction 0 -1 0", "direction 0 -1", 39, "direction: expected a finite number, got ``"),
        ("     direction 0 -1 0\n", "", 36, "bone `tibia` (line 36) has no `direction`"),
        ("     length 7\n", "", 36, "has no `length`"),
        ("     name tibia\n", "", 48, "bone `tibia` is not in :bonedata"),
        ("90 10 0 ZYX", "90 10 0 ZZX", 41, "axis: expected an order such as XYZ, got `ZZX`"),
        ("     name tibia", "     name femur", 49, "bone `tibia` is not in :bonedata"),
        ("    root hip\n", "    root hip\n    femur femur\n", 49, "bone `femur` has two parents"),
        (
            "    root hip\n    hip femur\n",
            "    root hip\n    tibia femur\n",
            36,
            "bone `tibia` (line 36) hangs on itself",
        ),
        ("  end\n:hierarchy", ":hierarchy", 44, "bone `tibia` (line 36) has no `end`"),
        ("  end\n  begin\n     id 3", "  begin\n     id 3", 35, "bone `femur` (line 24) has no `end`"),
        (":hierarchy\n", ":shape\n", 52, "no :hierarchy section"),
        (":root\n", ":rot\n", 52, "no :root section"),
    ] {
        refused(parse_asf(change(ASF, old, new).as_bytes()), Some(line), reason);
    }
    let cut: String = ASF.lines().take(34).flat_map(|line| [line, "\n"]).collect();
    refused(parse_asf(cut.as_bytes()), Some(34), "the file ends inside bone `femur` (line 24)");
    let cut: String = ASF.lines().take(15).flat_map(|line| [line, "\n"]).collect();
    refused(parse_asf(cut.as_bytes()), Some(15), "no bones");
    refused(parse_asf(b""), None, "empty");
    refused(parse_asf(b"\0\x01\x02"), Some(1), "binary");
}

#[test]
fn an_ordinary_motion() {
    let motion = amc(AMC).unwrap();
    assert_eq!(motion.values, [FIRST, SECOND].concat());
    assert_eq!((motion.frames, motion.angle), (2, AngleUnit::Degrees));
    assert_eq!(motion.notes, []);
    for text in [AMC.replace('\n', "\r\n"), AMC.replacen('\n', "\r\n", 4), AMC.trim_end().to_owned()] {
        assert_eq!(amc(&text).unwrap(), motion);
    }
}

#[test]
fn bones_in_another_order() {
    let text =
        change(AMC, "root 11 12 13 14 15 16\nfemur 17 18 19\n", "femur 17 18 19\nroot 11 12 13 14 15 16\n");
    assert_eq!(amc(&text).unwrap().values, [FIRST, SECOND].concat());
}

#[test]
fn units_of_angles() {
    assert_eq!(amc(&change(AMC, ":DEGREES", ":RADIANS")).unwrap().angle, AngleUnit::Radians);
    let motion = amc(&change(AMC, ":DEGREES\n", "")).unwrap();
    assert_eq!(motion.angle, AngleUnit::Degrees);
    assert_eq!(notes(&motion.notes), ["neither :DEGREES nor :RADIANS: degrees assumed, as in the skeleton"]);
}

#[test]
fn bones_without_degrees_of_freedom_may_be_listed() {
    for line in ["hip\n", "hip 0 0 0\n"] {
        let motion = amc(&change(AMC, "femur 7", &format!("{line}femur 7"))).unwrap();
        assert_eq!((motion.values, motion.notes.len()), ([FIRST, SECOND].concat(), 0));
    }
    refused(amc(&change(AMC, "femur 7", "hip 1\nfemur 7")), Some(6), "`hip`: expected 0 values, got 1");
}

#[test]
fn a_last_frame_cut_short_is_dropped() {
    let lines: Vec<&str> = AMC.lines().collect();
    for end in [
        "2\n",
        "2\nro",
        "2\nroot 11 12 1",
        "2\nroot 11 12 13 14 15 16\nfemur 17 18 19",
        "2\nroot 11 12 13 14 15 16\nfemur 17 18 19\ntibia 20 2e-",
    ] {
        let motion = amc(&format!("{}\n{end}", lines[..7].join("\n"))).unwrap();
        assert_eq!((&motion.values[..], motion.frames), (&FIRST[..], 1), "{end:?}");
        let notes = notes(&motion.notes);
        assert!(notes.len() == 1 && notes[0].starts_with("line 8: last frame 2 is cut short"), "{notes:?}");
    }
    refused(
        amc(&format!("{}\nfemur 7", lines[..5].join("\n"))),
        Some(6),
        "`femur`: expected 3 values, got 1",
    );
}

#[test]
fn bones_that_frames_leave_out() {
    let motion = amc(&change(AMC, "femur 7 8 9\n", "")).unwrap();
    assert!(motion.values[6..9].iter().all(|value| value.is_nan()));
    assert_eq!(motion.values[11..], SECOND);
    assert_eq!(notes(&motion.notes), ["bone `femur` is missing in 1 frames: missing samples"]);
    let motion = amc(&change(&change(AMC, "femur 7 8 9\n", ""), "femur 17 18 19\n", "")).unwrap();
    assert_eq!(motion.values[6..9], [0.0; 3]);
    assert_eq!(notes(&motion.notes), ["bone `femur` is in no frame: kept at rest"]);
}

#[test]
fn frames_that_leap_and_values_that_are_no_numbers() {
    let motion = amc(&change(AMC, "\n2\n", "\n5\n")).unwrap();
    assert_eq!(
        notes(&motion.notes),
        ["line 8: frame 5 follows frame 1 (1 such): kept as neighbours in time"]
    );
    let motion = amc(&change(AMC, "femur 7 8 9", "femur nan 8 -1.#IND")).unwrap();
    assert!(motion.values[6].is_nan() && motion.values[8].is_nan());
    assert_eq!(
        notes(&motion.notes),
        ["line 6: values that are no numbers (2 such): kept as missing samples"]
    );
}

#[test]
fn motions_that_are_none_are_refused() {
    for (old, new, line, reason) in [
        ("1\nroot", "root", 4, "not AMC: expected the number of a frame, got `root 1 2 3 4 5 6`"),
        ("femur 7", "fibula 7", 6, "bone `fibula` is not in the skeleton"),
        ("femur 7 8 9", "femur 7 8", 6, "`femur`: expected 3 values, got 2"),
        ("femur 7 8 9", "femur 7 8 9 10", 6, "`femur`: expected 3 values, got 4"),
        ("femur 7 8 9", "femur 7 x 9", 6, "`femur`: expected a number, got `x`"),
        ("femur 7 8 9", "root 1 2 3 4 5 6", 6, "bone `root` comes twice in frame 1"),
        ("femur 7 8 9", ":DEGREES", 6, "expected a bone or a frame, got `:DEGREES`"),
        ("\n2\n", "\n99999999999999999999999\n", 8, "expected the number of a frame"),
    ] {
        refused(amc(&change(AMC, old, new)), Some(line), reason);
    }
    refused(amc(":DEGREES\n"), None, "no frame has values");
    refused(amc("1\n2\n"), None, "no frame has values");
    refused(amc(""), None, "empty");
    refused(amc("PK\x03\x04"), Some(1), "binary");
}

proptest! {
    #[test]
    fn damaged_files_are_read_or_refused(cut in 0_usize..1500, at in 0_usize..1500, byte in any::<u8>()) {
        for text in [ASF, AMC] {
            let mut text = text.as_bytes().to_vec();
            text.truncate(text.len() - cut.min(text.len()));
            if let Some(place) = text.get_mut(at) {
                *place = byte;
            }
            let _ = parse_asf(&text);
            if let Ok(motion) = parse_amc(&text, &skeleton()) {
                prop_assert_eq!(motion.values.len(), motion.frames * 11);
            }
        }
    }
}
