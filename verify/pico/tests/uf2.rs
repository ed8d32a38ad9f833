//! The file for drag and drop, read by other code than that which writes it.

mod bench;

use fivebar_pico::Image;
use std::process::Command;

#[test]
fn the_file_for_drag_and_drop_has_the_bytes_of_the_image() {
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../firmware/src/board/rp2350/uf2.py"
    );
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let target = folder.join("image.uf2");
    let mut write = Command::new(script);
    let status = write
        .arg(bench::path("rp2350_stepper"))
        .arg(&target)
        .status();
    assert!(status.expect("python3 runs").success());
    let file = std::fs::read(&target).expect("the file");
    let image = Image::read(&bench::path("rp2350_stepper")).expect("an image");
    let mut flash = vec![0xff; image.flash().len()];
    let blocks = file.len() / 512;
    assert_eq!(file.len() % 512, 0);
    for (number, block) in file.chunks_exact(512).enumerate() {
        let word = |at: usize| u32::from_le_bytes(block[at..at + 4].try_into().expect("4 bytes"));
        assert_eq!(
            [word(0), word(4), word(508)],
            [0x0a32_4655, 0x9e5d_5157, 0x0ab1_6f30]
        );
        // The family is stated, and is that of programs for the Arm cores.
        assert_eq!([word(8), word(28)], [0x2000, 0xe48b_ff59]);
        assert_eq!(
            [word(16), word(20), word(24)],
            [256, number as u32, blocks as u32]
        );
        let at = (word(12) - 0x1000_0000) as usize;
        flash[at..at + 256].copy_from_slice(&block[32..288]);
    }
    assert!(flash == image.flash(), "the bytes differ");
}
