#!/usr/bin/env bash
# Mutation testing: changes one operator or one function at a time, as cargo-mutants lists them, and
# runs the crate's tests. Fails if a mutant survives that scripts/mutants.txt does not justify.
#
#   scripts/mutants.sh                                      all
#   scripts/mutants.sh firmware/src/safety/monitor.rs ...   these files
#   scripts/mutants.sh --sample                             the states and their transitions
#   scripts/mutants.sh --mistakes                           those that firmware/mistakes.py seeds
#
# Further options are those of scripts/mutants.py.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

version=27.1.0
sample=(firmware/src/safety/state.rs firmware/src/controller/transitions.rs)
all=('firmware/src/safety/**' 'firmware/src/controller/**' 'firmware/src/session/**'
    'firmware/src/settings/**' 'firmware/src/storage/**' 'firmware/src/planner/**'
    'firmware/src/protocol/**' 'kinematics/src/control/**' 'kinematics/src/five_bar/**'
    'kinematics/src/dynamics/**')
case "${1:-}" in
    --sample) arguments=("${sample[@]}" "${@:2}") ;;
    --mistakes) arguments=("$@" --constants) ;;
    '') arguments=(--constants "${all[@]}") ;;
    *) arguments=("$@") ;;
esac

if [ "$(cargo mutants --version 2>/dev/null)" != "cargo-mutants $version" ]; then
    cargo install cargo-mutants --version "$version" --locked --debug --quiet
fi
venv=$built/mutants-venv
if ! "$venv/bin/python" -c 'import tree_sitter_rust' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet tree-sitter==0.26.1 tree-sitter-rust==0.24.2
fi
exec "$venv/bin/python" scripts/mutants.py "${arguments[@]}"
