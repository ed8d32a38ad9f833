#!/usr/bin/env bash
# Loads the exported arm in MuJoCo, from PyPI, and compares its motion with ours.
set -euo pipefail
cd "$(dirname "$0")/.."

venv=target/mujoco-venv
if ! "$venv/bin/python" -c 'import mujoco' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet mujoco
fi
out=target/mujoco
mkdir -p "$out"
fivebar() { cargo run --quiet --release -- "$@"; }
fivebar export mjcf usp_2dof --out "$out/arm.xml"
fivebar export urdf usp_2dof --out "$out/arm.urdf"
fivebar sim sim-harness/scenarios/as_believed.toml --robot usp_2dof --out "$out" >"$out/run.log"
"$venv/bin/python" tests/mujoco/compare.py "$out/arm.xml" "$out/arm.urdf" "$out/trace.csv"
