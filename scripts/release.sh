#!/usr/bin/env bash
# Makes the files of a release in a folder:
#
#   scripts/release.sh program FOLDER TARGET   fivebar for this target of Rust, with its licences, as .tgz
#   scripts/release.sh images FOLDER           the firmware as .elf, .hex and .bin, for a Pico 2 as .elf and .uf2
#   scripts/release.sh sbom FOLDER             what program, images and wheels are made of, as CycloneDX
#   scripts/release.sh checksums FOLDER        SHA256SUMS of all files there
#
# `cargo binstall fivebar` finds the program by its name, which the crate's Cargo.toml states.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

[ $# -ge 2 ] || { sed -n '2,/^set/p' "$0" | sed '$d; s/^# \{0,1\}//' >&2; exit 2; }
mkdir -p "$2"
folder=$(cd "$2" && pwd)
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)

program() {
    cargo build --locked --release --package fivebar --features mcap,png --target "$1"
    local name=fivebar-$version-$1 suffix=
    [[ $1 != *windows* ]] || suffix=.exe
    rm -rf "${folder:?}/$name"
    mkdir "$folder/$name"
    cp "$built/$1/release/fivebar$suffix" README.md CHANGELOG.md LICENSE-* "$folder/$name"
    tar -C "$folder" -czf "$folder/$name.tgz" "$name"
    rm -r "${folder:?}/$name"
}

# stm32f405, stm32f405_stepper and stm32f405_can are for the board, qemu, qemu_stepper and qemu_can for `fivebar pil`.
images() {
    scripts/firmware.sh
    local toolchain copy name
    # The toolchain's own objcopy, and the library that it needs.
    toolchain=$(rustc --print sysroot)
    copy=$toolchain/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-objcopy
    export LD_LIBRARY_PATH=$toolchain/lib
    for name in stm32f405 stm32f405_stepper stm32f405_can qemu qemu_stepper qemu_can; do
        cp "$built/firmware/thumbv7em-none-eabihf/firmware/$name" "$folder/fivebar-$version-$name.elf"
        "$copy" -O ihex "$folder/fivebar-$version-$name.elf" "$folder/fivebar-$version-$name.hex"
        "$copy" -O binary "$folder/fivebar-$version-$name.elf" "$folder/fivebar-$version-$name.bin"
    done
    local pico
    pico=$(scripts/pico.sh image | tail -n 1)
    for name in rp2350_servo rp2350_stepper; do
        cp "$pico/$name" "$folder/fivebar-$version-$name.elf"
        cp "$pico/$name.uf2" "$folder/fivebar-$version-$name.uf2"
    done
}

sbom() {
    local tool=0.5.9
    if [ "$(cargo cyclonedx --version 2>/dev/null)" != "cargo-cyclonedx-cyclonedx $tool" ]; then
        cargo install cargo-cyclonedx --version "$tool" --locked --quiet
    fi
    describe program fivebar --features mcap,png
    describe images fivebar-firmware --features board --target thumbv7em-none-eabihf
    describe python fivebar-python
}

# NAME CRATE OPTION...: the tool writes a list beside the manifest of each crate of the workspace.
describe() {
    local manifest
    manifest=$(git ls-files '*Cargo.toml' | xargs grep -l "^name = \"$2\"$")
    cargo cyclonedx --format json --override-filename sbom --manifest-path "$manifest" "${@:3}"
    mv "$(dirname "$manifest")/sbom.json" "$folder/fivebar-$version-$1.cdx.json"
    git ls-files '*Cargo.toml' | xargs dirname | sed 's|$|/sbom.json|' | xargs rm -f
}

checksums() { (cd "$folder" && rm -f SHA256SUMS && sha256sum -- * >SHA256SUMS); }

case $1 in
program | images | sbom | checksums) "$1" "${@:3}" ;;
*) echo "release: no part $1" >&2; exit 2 ;;
esac
