#!/usr/bin/env bash
# Compares the interface of each published library with that of the last release's tag: what breaks its users needs
# another version. Before the first tag there is nothing to compare, and the status is 77: not checked.
set -euo pipefail
cd "$(dirname "$0")/.."

version=0.51.0
if ! tag=$(git describe --tags --abbrev=0 --match 'v*' HEAD 2>/dev/null); then
    echo "semver: NOT CHECKED: no tag v* yet" >&2
    exit 77
fi
if [ "$(cargo semver-checks --version 2>/dev/null)" != "cargo-semver-checks $version" ]; then
    cargo install cargo-semver-checks --version "$version" --locked --quiet
fi
cargo semver-checks --baseline-rev "$tag" --workspace
