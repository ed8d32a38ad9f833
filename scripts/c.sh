#!/usr/bin/env bash
# Builds the kinematics for C (kinematics/c), runs its programs in C, and packs the libraries for Arduino:
# target/c/fivebar-arduino.zip.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

crate=(--quiet --locked --manifest-path kinematics/c/Cargo.toml --target-dir "$built/c")
cargo fmt --manifest-path kinematics/c/Cargo.toml --check
cargo clippy "${crate[@]}" --all-targets -- -D warnings
cargo build "${crate[@]}" --release
FIVEBAR_LIBRARY=$built/c/release/libfivebar.a cargo test "${crate[@]}" -- --nocapture

# The folders are those of Arduino's library specification, of each library those by the `build.mcu` of its boards. Arduino's
# cores compile with newlib and libgcc, which the libraries find there too.
libraries_of=(
    "thumbv6m-none-eabi cortex-m0plus"
    "thumbv7em-none-eabihf cortex-m4 cortex-m7"
    "thumbv8m.main-none-eabihf cortex-m33"
    "riscv32imac-unknown-none-elf esp32c6 esp32h2"
)
folder=$built/c/arduino
toolchain=$(rustc --print sysroot)
rm -rf "$folder"
mkdir -p "$folder/Fivebar/src"
cp -r kinematics/c/arduino/. LICENSE-* "$folder/Fivebar"
cp kinematics/c/include/fivebar.h "$folder/Fivebar/src"
for line in "${libraries_of[@]}"; do
    read -r target boards <<<"$line"
    (
        source scripts/toolchain.sh
        cargo build "${crate[@]}" --release --target "$target" "${cargo_flags[@]}"
    )
    library=$built/c/$target/release/libfivebar.a
    if nm -A "$library" 2>/dev/null | grep -E ':fivebar-[^:]*:.*(panic|begin_unwind)'; then
        echo "c: the library for $target has code that panics" >&2
        exit 1
    fi
    for board in $boards; do
        mkdir "$folder/Fivebar/src/$board"
        # `objcopy` is the toolchain's own, which reads any target.
        LD_LIBRARY_PATH=$toolchain/lib "$toolchain/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-objcopy" \
            --strip-debug "$library" "$folder/Fivebar/src/$board/libfivebar.a"
    done
done
(cd "$folder" && python3 -m zipfile -c fivebar.zip Fivebar)
mv "$folder/fivebar.zip" "$built/c/fivebar-arduino.zip"
echo "c: $built/c/fivebar-arduino.zip: $(wc -c <"$built/c/fivebar-arduino.zip") bytes"
