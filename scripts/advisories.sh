#!/usr/bin/env bash
# Checks the dependencies of every lock file for known vulnerabilities, by cargo-deny and its advisory database.
#
# Status 77: not checked, because this machine has no cargo-deny or no database. The database is fetched
# from its own repository, so GitHub's job `dependencies` has it always, and checks on each change and once
# a week.
set -euo pipefail
cd "$(dirname "$0")/.."

database=${CARGO_HOME:-$HOME/.cargo}/advisory-dbs
if ! command -v cargo-deny >/dev/null || [ ! -d "$database" ]; then
    echo "advisories: NOT CHECKED: cargo-deny or its database ($database) is absent. Run 'cargo install" >&2
    echo "advisories: cargo-deny' and 'cargo deny fetch', or look at GitHub's job 'dependencies'." >&2
    exit 77
fi
for manifest in Cargo.toml verify/fuzz/Cargo.toml python/Cargo.toml verify/chip/Cargo.toml verify/pico/Cargo.toml verify/leg_m0/Cargo.toml kinematics/c/Cargo.toml; do
    cargo deny --offline --manifest-path "$manifest" check --config deny.toml advisories
done
