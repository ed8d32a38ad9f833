#!/usr/bin/env bash
# Builds the page "your arm, now" into target/browser-arm: scripts/browser_arm.sh
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh
target=wasm32-unknown-unknown
libraries=std,panic_abort
source scripts/toolchain.sh

cargo build --quiet --package fivebar-browser --lib --profile browser --target "$target" "${cargo_flags[@]}"
site=$built/browser-arm
rm -rf "$site"
mkdir -p "$site"
cp host/browser/page/* host/fivebar/src/serve/page/style.css "$site"
cp "$built/$target/browser/fivebar_browser.wasm" "$site/fivebar.wasm"
echo "the page is in $site: $(($(stat -c %s "$site/fivebar.wasm") / 1000)) kB of program; serve it by any server of files"
