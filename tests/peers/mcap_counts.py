"""Reads a run's MCAP file by the reader of the MCAP project, and counts each channel's messages.

    mcap_counts.py RUN.mcap TRACE.csv

The channel of figures must have a message for each line of the trace; the 3D scene at least
one for each fiftieth of a second.
"""

import csv
import json
import sys
from collections import Counter

from mcap.reader import make_reader
from mcap_ros1.decoder import DecoderFactory


def main(log_path, trace_path):
    with open(trace_path, newline="") as file:
        rows = list(csv.DictReader(file))
    counts = Counter()
    first = {}
    decoder = DecoderFactory()
    with open(log_path, "rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            counts[channel.topic] += 1
            if channel.topic in first:
                continue
            if schema.encoding == "ros1msg":
                first[channel.topic] = decoder.decoder_for(channel.message_encoding, schema)(message.data)
            else:
                assert schema.encoding == "jsonschema" and json.loads(schema.data)
                first[channel.topic] = json.loads(message.data)
    print(dict(counts))
    assert counts["/run"] == len(rows), f"/run: {counts['/run']} of {len(rows)}"
    assert abs(first["/run"].tool_x - float(rows[0]["tool_x_m"])) < 1e-8
    span = float(rows[-1]["time_s"]) - float(rows[0]["time_s"])
    assert counts["/scene"] >= 49 * span, f"/scene: {counts['/scene']} in {span} s"


main(*sys.argv[1:])
