//! `fivebar export` from the outside; what the models hold is checked by their readers
//! (scripts/peers.sh).

use std::process::{Command, Output};

fn export(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("export").args(arguments).output().unwrap()
}

#[test]
fn prints_the_model_or_writes_it_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    for (format, begins) in [("mjcf", "<mujoco"), ("urdf", "<?xml"), ("dot", "graph")] {
        let printed = export(&[format, "usp_2dof"]);
        assert!(printed.status.success());
        let model = String::from_utf8(printed.stdout).unwrap();
        assert!(model.trim_start().starts_with(begins), "{model}");

        let path = folder.path().join(format);
        let path = path.to_str().unwrap();
        let written = export(&[format, "usp_2dof", "--out", path]);
        assert!(written.status.success());
        assert_eq!(std::fs::read_to_string(path).unwrap(), model);
        let said = String::from_utf8(written.stdout).unwrap();
        assert!(said.contains("usp_2dof") && said.contains(path), "{said}");
        assert_eq!(said.lines().count(), 1);
    }
}

#[test]
fn a_place_that_cannot_be_written_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let refused = export(&["dot", "--out", folder.path().to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(1));
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(words.contains(folder.path().to_str().unwrap()), "{words}");
}
