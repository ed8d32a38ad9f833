//! `fivebar pil` with an image of another release. The emulator is a script that replies
//! to everything with the same frame.

use fivebar_firmware::drives::BrushedCommand;
use fivebar_firmware::protocol::{
    CommandError, ControllerMessage, Reply, Sequence, VERSION, encode,
};
use fivebar_testkit::program;
use std::fs;
use std::os::unix::fs::PermissionsExt;

/// Connects to both addresses in its arguments. After the first byte on the serial line it
/// sends the file `answer`; then it reads on.
const EMULATOR: &str = r#"#!/usr/bin/env bash
for word; do
    case $word in tcp:*) address=${word#tcp:}; ports+=("${address//[!0-9:]/}") ;; esac
done
exec 3<>"/dev/tcp/127.0.0.1/${ports[0]##*:}" 4<>"/dev/tcp/127.0.0.1/${ports[1]##*:}"
read -r -N 1 -u 3
cat "$(dirname "$0")/answer" >&3
cat <&3 >/dev/null
"#;

#[test]
fn the_error_for_an_image_of_another_release_says_how_to_build_it() {
    let folder = tempfile::tempdir().unwrap();
    let emulator = folder.path().join("qemu-system-arm");
    fs::write(&emulator, EMULATOR).unwrap();
    fs::set_permissions(&emulator, fs::Permissions::from_mode(0o755)).unwrap();
    let answer = ControllerMessage::<BrushedCommand>::Reply {
        sequence: Sequence(1),
        reply: Reply::Refused(CommandError::Version(VERSION + 1)),
    };
    fs::write(folder.path().join("answer"), &*encode(&answer).unwrap()).unwrap();
    let image = folder.path().join("old image");
    fs::write(&image, "never read").unwrap();

    let path = std::env::var("PATH").unwrap();
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["pil", "--image"])
        .arg(&image)
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .current_dir(folder.path())
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    for part in [
        &format!("uses version {} of the protocol", VERSION + 1),
        &image.display().to_string(),
        "scripts/firmware.sh",
    ] {
        assert!(stderr.contains(part), "{part:?} is not in {stderr}");
    }
}
