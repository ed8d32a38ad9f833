#!/usr/bin/env bash
# Tests the live page, and the page "your arm, now", in a headless Chromium from Debian, the live page also in its
# Firefox: scripts/browser.sh [FOLDER]
#
# With a folder, it also writes pictures there, taken with the release build: of the page, of a
# report and of a workspace map. The documents use pictures that lie in docs/use and docs/design.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }

if ! command -v chromium >/dev/null || ! command -v chromedriver >/dev/null || ! command -v firefox-esr >/dev/null; then
    echo "browser: installing Debian's chromium, chromium-driver and firefox-esr"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        chromium chromium-driver firefox-esr >/dev/null
fi
axe=$built/axe
if [ ! -e "$axe/node_modules/axe-core/axe.min.js" ]; then
    command -v npm >/dev/null || { echo "browser: npm is needed (Debian: apt-get install npm)" >&2; exit 1; }
    mkdir -p "$axe"
    npm install --silent --no-save --prefix "$axe" axe-core@4.10.3
fi
scripts/browser_arm.sh
cargo build --quiet "${with_features[@]}" --example answer
own_arm() { tests/browser/own_arm.py "$built/browser-arm" "$built/debug/examples/answer" "$@"; }
if [ $# -gt 0 ]; then
    build_program --release
    own_arm --screenshots "$1"
    exec tests/browser/live_page.py "$built/release/fivebar" --screenshots "$1"
fi
own_arm
build_program
exec tests/browser/live_page.py "$built/debug/fivebar"
