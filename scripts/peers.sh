#!/usr/bin/env bash
# Checks our output with other programs, from PyPI: Pinocchio and MuJoCo must give exported arms the accelerations of our
# equations, pydot must read the graph, MuJoCo must move the exported arm as our plant does, the reader of the MCAP project must find every sample in a run's log, the travel between strokes must
# not be longer than vpype's, what other programs write must be drawn as they mean it, and outlines of pictures must be as near
# as those of potrace and vtracer.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

venv=$built/peers-venv
if ! "$venv/bin/python" -c 'import mujoco, mcap, mcap_ros2, rosbags, pinocchio, ezdxf, pydot, skimage, svg_to_gcode, vpype, vpype_gcode, vtracer' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet mujoco mcap mcap-ros2-support rosbags pin pydot vpype vpype-gcode==0.13.0 svg-to-gcode==1.5.4 vtracer==0.6.15 scikit-image ezdxf
fi
out=$built/peers
mkdir -p "$out"
fivebar() { cargo run --quiet "${with_features[@]}" -- "$@"; }

# A run of an arm without mismatch, and the arm as a model, in a folder of its own.
run() {
    mkdir -p "$out/$1"
    fivebar export mjcf "$2" --out "$out/$1/arm.xml"
    fivebar sim host/files/scenarios/no_mismatch.toml --robot "$2" \
        --out "$out/$1" --log "$out/$1/run.mcap" >"$out/$1/run.log"
}
run level usp_2dof
# Upright, with a payload: its motors are ideal.
sed -e 's/^gravity = .*/gravity = [0.0, -9.81]/' -e 's/^payload = .*/payload = 0.2/' \
    host/files/robots/usp_2dof.toml >"$out/loaded.toml"
run loaded "$out/loaded.toml"
# Upright, with motors, their friction and brakes.
sed -e 's/^gravity = .*/gravity = [0.0, -9.81]/' -e 's/^\[\[actuator\]\]/&\nbrake_torque = 0.5/' \
    host/files/robots/benchtop.toml >"$out/upright.toml"
run upright "$out/upright.toml"
fivebar export urdf usp_2dof --out "$out/arm.urdf"
# L/R: 1 ms of ideal motors, and 0.24 mH / 2.3 Ω.
"$venv/bin/python" tests/peers/mujoco_motion.py "$out/arm.urdf" \
    "$out/level" 1e-3 "$out/loaded" 1e-3 "$out/upright" 1.0435e-4
"$venv/bin/python" tests/peers/mcap_counts.py "$out/level/run.mcap" "$out/level/trace.csv"
"$venv/bin/python" tests/peers/dynamics.py "$built/debug/fivebar" "$out/dynamics"
cargo build --quiet "${with_features[@]}" --example travel --example strokes
"$venv/bin/python" tests/peers/travel.py "$built/debug/examples/travel" "$venv/bin/vpype" "$out/travel"
if ! command -v potrace >/dev/null || ! command -v inkscape >/dev/null || ! /usr/bin/python3 -c 'import lxml, numpy, cssselect, serial'; then
    as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }
    as_root apt-get update -qq
    # With the packages that Inkscape's extensions use.
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        potrace inkscape python3-lxml python3-numpy python3-cssselect python3-serial >/dev/null
fi
"$venv/bin/python" tests/peers/programs.py "$built/debug/examples/strokes" "$venv/bin" "$out/programs"
"$venv/bin/python" tests/peers/tracing.py "$built/debug/examples/strokes" "$out/tracing"
