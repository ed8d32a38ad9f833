#!/usr/bin/env bash
# Adds a fifth kind of drive, an ideal torque source, to a copy of the sources, and draws with it: what a new kind of drive
# touches is what tests/fifth_kind/ideal_torque.patch touches.
#
#   scripts/fifth_kind.sh           the copy, its compilation, and the run
#   scripts/fifth_kind.sh --check   only whether the patch still applies, to 15 files at most
#
# Where sources that it touches have changed: apply it with `git apply --3way`, correct it, and write it again with
# `git diff HEAD > tests/fifth_kind/ideal_torque.patch`.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
patch=$PWD/tests/fifth_kind/ideal_torque.patch
most=15

files=$(grep -c '^diff --git ' "$patch")
if [ "$files" -gt "$most" ]; then
    echo "fifth_kind: the patch touches $files files, more than $most" >&2
    exit 1
fi
git apply --check "$patch"
echo "fifth_kind: the patch applies, to $files files"
[ "${1:-}" = --check ] && exit

copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
git ls-files -z | xargs -0 cp --parents --no-dereference --target-directory "$copy"
cd "$copy"
git apply "$patch"
export CARGO_TARGET_DIR=$built/fifth-kind
cargo test --package fivebar-sim --lib ideal_torque
cargo run --package fivebar -- sim --robot host/files/robots/ideal.toml --out "$copy/out"
# It has no steps of a commissioning yet, and is told so.
said=$(cargo run --package fivebar -- commission --port simulated --robot host/files/robots/ideal.toml 2>&1 || true)
grep --quiet 'there are no steps for these yet' <<<"$said" || { echo "fifth_kind: $said" >&2; exit 1; }
