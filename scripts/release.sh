#!/usr/bin/env bash
# Makes the files of a release in a folder:
#
#   scripts/release.sh program FOLDER TARGET   fivebar for this target of Rust, with its licences, as .tgz
#   scripts/release.sh images FOLDER           the firmware as .elf, .hex and .bin
#   scripts/release.sh sbom FOLDER             what program, images and wheels are made of, as CycloneDX
#   scripts/release.sh checksums FOLDER        SHA256SUMS of all files there
#
# `cargo binstall fivebar` finds the program by its name: sim-harness/Cargo.toml states it.
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

# stm32f405 is for the board, qemu for `fivebar pil`.
images() {
    scripts/firmware.sh
    local host copy name
    host=$(rustc -vV | sed -n 's/^host: //p')
    copy=$(rustc --print sysroot)/lib/rustlib/$host/bin/rust-objcopy
    for name in stm32f405 qemu; do
        cp "$built/firmware/thumbv7em-none-eabihf/firmware/$name" "$folder/fivebar-$version-$name.elf"
        "$copy" -O ihex "$folder/fivebar-$version-$name.elf" "$folder/fivebar-$version-$name.hex"
        "$copy" -O binary "$folder/fivebar-$version-$name.elf" "$folder/fivebar-$version-$name.bin"
    done
}

sbom() {
    local tool=0.5.9 manifest name
    if [ "$(cargo cyclonedx --version 2>/dev/null)" != "cargo-cyclonedx-cyclonedx $tool" ]; then
        cargo install cargo-cyclonedx --version "$tool" --locked --quiet
    fi
    describe() { # NAME MANIFEST OPTION...: the list lands beside the manifest of each crate of the workspace.
        name=fivebar-$version-$1 manifest=$2
        cargo cyclonedx --format json --override-filename sbom --manifest-path "$manifest" "${@:3}"
        mv "$(dirname "$manifest")/sbom.json" "$folder/$name.cdx.json"
        git ls-files -z '*Cargo.toml' | xargs -0 -n 1 dirname | sed 's|$|/sbom.json|' | tr '\n' '\0' | xargs -0 rm -f
    }
    describe program sim-harness/Cargo.toml --features mcap,png
    describe images firmware/Cargo.toml --features board --target thumbv7em-none-eabihf
    describe python python/Cargo.toml
}

checksums() { (cd "$folder" && rm -f SHA256SUMS && sha256sum -- * >SHA256SUMS); }

case $1 in
program | images | sbom | checksums) "$1" "${@:3}" ;;
*) echo "release: no part $1" >&2; exit 2 ;;
esac
