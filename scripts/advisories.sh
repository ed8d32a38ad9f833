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
for lock in $(git ls-files '*Cargo.lock'); do
    cargo deny --offline --manifest-path "${lock%lock}toml" check --config deny.toml advisories
done
