#!/usr/bin/env bash
# Builds the fuzz targets with counters of coverage:
#
#   verify/fuzz/build.sh            decode, points, session, settings_pages
#   verify/fuzz/build.sh files      all of them; builds the program's library, too
#
# These are the flags of `cargo fuzz`, without its sanitizer, which needs a nightly compiler and
# finds little in code without `unsafe`.
set -euo pipefail
cd "$(dirname "$0")"
export RUSTFLAGS="--cfg fuzzing \
    -Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares \
    -Cdebug-assertions=yes -Coverflow-checks=yes"
target=$(rustc -vV | sed -n 's/^host: //p')
features=()
[ $# -eq 0 ] || features=(--features "$1")
# The target is named so that build scripts get no counters.
cargo build --release --target "$target" "${features[@]}"
