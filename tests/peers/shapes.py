"""Distances between drawings: lists of strokes, each a list of points [mm]."""

import json
import subprocess

import numpy
from scipy.spatial import cKDTree

STEP = 0.02  # between two points of a sampled line [mm]


def ours(example, file, *picture):
    """The strokes that Fivebar reads from a file."""
    answer = subprocess.run([example, str(file), *picture], check=True, capture_output=True, text=True).stdout
    return [numpy.array(stroke) for stroke in json.loads(answer)]


def sampled(strokes, step=STEP):
    """Points along the strokes, at most so far apart."""
    points = []
    for stroke in strokes:
        points.append(stroke[:1])
        for start, end in zip(stroke[:-1], stroke[1:]):
            count = max(1, int(numpy.ceil(numpy.hypot(*(end - start)) / step)))
            share = numpy.arange(1, count + 1)[:, None] / count
            points.append(start + share * (end - start))
    return numpy.concatenate(points)


def farthest(here, there):
    """The greatest distance of a point here from its nearest one there."""
    return float(cKDTree(there).query(here)[0].max())


def hausdorff(one, other, step=STEP):
    """The greatest distance of a point of either drawing from the other drawing."""
    one, other = sampled(one, step), sampled(other, step)
    return max(farthest(one, other), farthest(other, one))


def corners(strokes):
    """The lower left and the upper right corner around a drawing."""
    points = numpy.concatenate(strokes)
    return points.min(axis=0), points.max(axis=0)
