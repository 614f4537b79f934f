//! Real files: each opens, or is refused with a reason; what opens is written and read back as it was.
//!
//! They are found by `QUATFILT_DATA`, by default `../shared/data` from the root of the repository.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests")]

use quatfilt_formats::acclaim::{parse_amc, parse_asf};
use quatfilt_formats::{Note, Precision, bvh};
use std::path::{Path, PathBuf};

/// Files below the data folder with one of the extensions, sorted; none where the folder is absent.
fn files(extension: &str) -> Vec<PathBuf> {
    let root = std::env::var_os("QUATFILT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    if !root.is_dir() {
        println!("skipped: {} is absent (QUATFILT_DATA names the data folder)", root.display());
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "no .{extension} below the data folder");
    found
}

fn show(path: &Path, notes: &[Note]) {
    for note in notes {
        println!("{}: {note}", path.display());
    }
}

#[test]
fn every_bvh_opens_or_is_refused_and_reads_back() {
    for path in files("bvh") {
        let name = path.file_name().unwrap().to_str().unwrap();
        let file = match bvh::parse(&std::fs::read(&path).unwrap()) {
            Ok(file) => file,
            Err(error) => {
                println!("{}: refused: {error}", path.display());
                assert_eq!(
                    name, "output1_nohierarchy.bvh",
                    "only a file without a skeleton is refused: {error}"
                );
                continue;
            }
        };
        show(&path, &file.notes);
        assert_eq!(file.notes.is_empty(), name != "nan_row_sideskip.bvh", "{name}");
        let text = bvh::write(&file.joints, &file.frame_time, &file.values, Precision::Shortest).unwrap();
        let again = bvh::parse(&text).unwrap();
        assert_eq!((&again.joints, &again.frame_time), (&file.joints, &file.frame_time), "{name}");
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&again.values), bits(&file.values), "{name}");
    }
}

#[test]
fn every_acclaim_motion_opens_with_its_skeleton() {
    for path in files("asf") {
        let skeleton = parse_asf(&std::fs::read(&path).unwrap()).unwrap();
        show(&path, &skeleton.notes);
        assert!(skeleton.notes.is_empty(), "{}", path.display());
        assert_eq!((skeleton.bones.len(), skeleton.columns()), (30, 62), "{}", path.display());
        for path in files("amc").into_iter().filter(|motion| motion.parent() == path.parent()) {
            let motion = parse_amc(&std::fs::read(&path).unwrap(), &skeleton).unwrap();
            show(&path, &motion.notes);
            let cut = ["07_12.amc", "golf_01.amc"].iter().any(|name| path.ends_with(name));
            assert_eq!(motion.notes.is_empty(), !cut, "{}", path.display());
            assert!(motion.values.iter().all(|value| value.is_finite()), "{}", path.display());
            assert_eq!(motion.values.len(), motion.frames * skeleton.columns());
        }
    }
}
