"""Reads a run's MCAP file by the reader of the MCAP project, and counts each channel's messages.

    mcap_counts.py RUN.mcap TRACE.csv

Every channel of figures must have a message for each line of the trace; the 3D scene at least
one for each fiftieth of a second.
"""

import csv
import json
import sys
from collections import Counter

from mcap.reader import make_reader

FIGURES = ("/tool", "/joints", "/torque", "/current", "/duty")


def main(log_path, trace_path):
    with open(trace_path, newline="") as file:
        rows = list(csv.DictReader(file))
    counts = Counter()
    first = {}
    with open(log_path, "rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema.encoding == "jsonschema" and json.loads(schema.data)
            counts[channel.topic] += 1
            first.setdefault(channel.topic, json.loads(message.data))
    print(dict(counts))
    for topic in FIGURES:
        assert counts[topic] == len(rows), f"{topic}: {counts[topic]} of {len(rows)}"
    assert abs(first["/tool"]["x"] - float(rows[0]["tool_x_m"])) < 1e-8
    span = float(rows[-1]["time_s"]) - float(rows[0]["time_s"])
    assert counts["/scene"] >= 49 * span, f"/scene: {counts['/scene']} in {span} s"


main(*sys.argv[1:])
