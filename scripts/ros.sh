#!/usr/bin/env bash
# The program as a node of ROS 2: its tests, and rclpy of PyPI, which drives the simulated arm and reads it back.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

with_ros=("${with_features[@]}" --features fivebar/ros)
cargo clippy --quiet --package fivebar --all-targets "${with_ros[@]}" -- -D warnings
cargo test --quiet --package fivebar --lib "${with_ros[@]}" ros:: -- --include-ignored
cargo build --quiet --package fivebar --bin fivebar "${with_ros[@]}"

venv=$built/ros-venv
if ! "$venv/bin/python" -c 'import rclpy, sensor_msgs, std_srvs, diagnostic_msgs, trajectory_msgs' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet numpy ros-kilted-rclpy ros-kilted-rmw-fastrtps-cpp ros-kilted-sensor-msgs \
        ros-kilted-std-srvs ros-kilted-diagnostic-msgs ros-kilted-trajectory-msgs
fi
# A domain of its own: whoever else is in the network neither drives this arm nor is driven.
export ROS_DOMAIN_ID=${ROS_DOMAIN_ID:-87} RMW_IMPLEMENTATION=rmw_fastrtps_cpp
"$venv/bin/python" tests/ros/drive.py "$built/debug/fivebar"
