#!/usr/bin/env bash
# Finds or installs what the firmware needs: a Cortex-M4F compiler and an emulator.
#
# When run, it reports what it found or installed. When sourced (by scripts/firmware.sh), it also
# exports the environment that the chosen compiler needs and sets `cargo_flags`. Who sources it for another target
# than the board's sets `target`, and `libraries`, those that Debian's compiler has to build for it.
#
# It looks for the compiler in this order:
#   1. the rustup target, if it is installed;
#   2. `rustup target add`, with a limit of 20 seconds;
#   3. Debian's rustc-web with its library source, which builds `core` itself.
set -euo pipefail

target=${target:-thumbv7em-none-eabihf}
libraries=${libraries:-core}
debian_rustc=/usr/bin/rustc
debian_source=/usr/lib/rustlib/src/rust/library/core/src/lib.rs
cargo_flags=()

# The images name their sources without the folders of this machine, so that two machines make the
# same file.
rustflags="--remap-path-prefix=$PWD=/fivebar\
 --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo\
${CARGO_TARGET_DIR:+ --remap-path-prefix=$CARGO_TARGET_DIR=/fivebar/target}"
of_target=${target^^}
export "CARGO_TARGET_${of_target//[-.]/_}_RUSTFLAGS=$rustflags"

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }

install_packages() {
    command -v apt-get >/dev/null || return 1
    echo "toolchain: installing Debian's packages: $*"
    local log
    log=$(mktemp)
    if ! { as_root env DEBIAN_FRONTEND=noninteractive timeout 120 apt-get update -qq &&
        as_root env DEBIAN_FRONTEND=noninteractive timeout 600 \
            apt-get install -y -qq --no-install-recommends "$@"; } >"$log" 2>&1; then
        tail -n 15 "$log" >&2
        rm -f "$log"
        return 1
    fi
    rm -f "$log"
}

has_target() { [ -d "$(rustc --print sysroot)/lib/rustlib/$target" ]; }
has_debian() { [ -x "$debian_rustc" ] && [ -e "$debian_source" ]; }

add_target() {
    command -v rustup >/dev/null || return 1
    echo "toolchain: rustup target add $target (limit: 20 s)"
    timeout 20 rustup target add "$target" >/dev/null 2>&1 && has_target
}

find_compiler() {
    if has_target; then
        echo "toolchain: rustup's $target"
        return
    fi
    if ! has_debian && add_target; then
        echo "toolchain: rustup's $target, just added"
        return
    fi
    if ! has_debian && ! { install_packages rustc-web rust-web-src && has_debian; }; then
        echo "toolchain: no compiler for $target. Install it with 'rustup target add $target'," \
            "or Debian's packages rustc-web and rust-web-src." >&2
        return 1
    fi
    echo "toolchain: $("$debian_rustc" --version) of Debian, building $libraries from its source"
    export RUSTC=$debian_rustc RUSTC_BOOTSTRAP=1
    cargo_flags=("-Zbuild-std=$libraries")
    if ! command -v rust-lld >/dev/null; then
        PATH="$(env -u RUSTC rustc --print sysroot)/lib/rustlib/x86_64-unknown-linux-gnu/bin:$PATH"
    fi
}

find_emulator() {
    if ! command -v qemu-system-arm >/dev/null && ! install_packages qemu-system-arm; then
        echo "toolchain: no qemu-system-arm. Install your system's package of that name" \
            "(Debian: apt-get install qemu-system-arm)." >&2
        return 1
    fi
    echo "toolchain: $(qemu-system-arm --version | head -n 1)"
}

find_compiler
if [ "${BASH_SOURCE[0]}" = "$0" ]; then
    find_emulator
fi
