#!/usr/bin/env bash
# The live page in a headless Chromium, which Debian has: scripts/browser.sh [FOLDER]
#
# With a folder, pictures of the page, of a report and of a workspace map are left there,
# taken of the release build: docs/ is where the README looks for them.
set -euo pipefail
cd "$(dirname "$0")/.."

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }

if ! command -v chromium >/dev/null || ! command -v chromedriver >/dev/null; then
    echo "browser: installing Debian's chromium and chromium-driver"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        chromium chromium-driver >/dev/null
fi
if [ $# -gt 0 ]; then
    cargo build --package fivebar --release
    exec tests/browser/live_page.py target/release/fivebar --screenshots "$1"
fi
cargo build --package fivebar
exec tests/browser/live_page.py target/debug/fivebar
