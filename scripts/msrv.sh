#!/usr/bin/env bash
# Compiles everything with the oldest toolchain that Cargo.toml promises (rust-version), which rustup installs.
set -euo pipefail
cd "$(dirname "$0")/.."

version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
rustup toolchain install "$version" --profile minimal --no-self-update
cargo "+$version" check --workspace --locked
cargo "+$version" check --manifest-path python/Cargo.toml --locked
