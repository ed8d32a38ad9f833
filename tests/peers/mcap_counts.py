"""Reads a run's MCAP file by the reader of the MCAP project, and as a bag of ROS 2 by `rosbags`.

    mcap_counts.py RUN.mcap TRACE.csv

The channel of figures must have a message for each line of the trace, the joints one for each hundredth and the 3D scene one
for each fiftieth of a second.
"""

import csv
import pathlib
import sys
from collections import Counter

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader


def main(log_path, trace_path):
    with open(trace_path, newline="") as file:
        rows = list(csv.DictReader(file))
    span = float(rows[-1]["time_s"]) - float(rows[0]["time_s"])
    x, y, theta1, theta4 = (float(rows[0][name]) for name in ("tool_x_m", "tool_y_m", "theta1_rad", "theta4_rad"))
    for reads in (by_mcap, by_rosbags):
        counts, first = reads(log_path)
        print(reads.__name__, dict(counts))
        assert counts["/run"] == len(rows), f"/run: {counts['/run']} of {len(rows)}"
        assert counts["/joint_states"] >= 99 * span, f"/joint_states: {counts['/joint_states']} in {span} s"
        assert counts["/scene"] >= 49 * span, f"/scene: {counts['/scene']} in {span} s"
        run, joints, scene = (first[topic] for topic in ("/run", "/joint_states", "/scene"))
        assert abs(run.tool_x - x) < 1e-8 and abs(run.tool_y - y) < 1e-8
        assert list(joints.name) == ["A", "E"] and joints.header.frame_id == "base"
        assert abs(joints.position[0] - theta1) < 1e-8 and abs(joints.position[1] - theta4) < 1e-8
        # The third point of the line is C, and without an offset the tool.
        assert scene.type == 4 and len(scene.points) == 5
        assert abs(scene.points[2].x - x) < 1e-6 and abs(scene.points[2].y - y) < 1e-6


def by_mcap(path):
    counts, first, decoder = Counter(), {}, DecoderFactory()
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            counts[channel.topic] += 1
            if channel.topic not in first:
                first[channel.topic] = decoder.decoder_for(channel.message_encoding, schema)(message.data)
    return counts, first


def by_rosbags(path):
    counts, first = Counter(), {}
    with AnyReader([pathlib.Path(path)]) as reader:
        for connection, _, data in reader.messages():
            counts[connection.topic] += 1
            if connection.topic not in first:
                first[connection.topic] = reader.deserialize(data, connection.msgtype)
    return counts, first


main(*sys.argv[1:])
