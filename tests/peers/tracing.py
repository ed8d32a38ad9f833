"""Pictures as outlines: Fivebar beside potrace and vtracer, on five logos and five pictures like photographs, from seeds.

    python tracing.py OUR_EXAMPLE FOLDER [--write TABLE.csv]

Each picture has 800 by 800 pixels and 100 mm. The reference is the contour of its darkness at 0.5, by marching squares: every point that is
drawn must be near it, and it near what is drawn where it surrounds more than a speck. Fails if Fivebar's outlines are farther from it than LARGEST, or more than TIE times as far as the nearer of the two.
"""

import argparse
import csv
import subprocess
import sys
import time
from pathlib import Path

import numpy
import svgelements
import vtracer
from PIL import Image, ImageDraw, ImageFilter
from shapes import farthest, ours, sampled
from skimage.measure import find_contours

SIDE = 800  # pixels
PIXEL = 100.0 / SIDE  # mm
FINE = 4  # pixels of a logo are drawn finer by this, then averaged
STEP = 0.05  # between two compared points [mm]
LARGEST = 0.3  # mm
TIE = 1.5
SPECK = 3  # areas of fewer pixels are left out by all [pixels]
SEEN = 16  # areas of so many must be drawn [pixels]


def logo(number):
    """A logo: discs, bars, a star or rings."""
    dice = numpy.random.default_rng(number)
    picture = Image.new("L", (SIDE * FINE, SIDE * FINE), 255)
    pen = ImageDraw.Draw(picture)
    size = SIDE * FINE
    if number == 0:
        for ring in range(5, 0, -1):
            r = size * ring / 12
            pen.ellipse([size / 2 - r, size / 2 - r, size / 2 + r, size / 2 + r], fill=0 if ring % 2 else 255)
    elif number == 1:
        corners = [(size * (0.5 + r * numpy.sin(i * numpy.pi / 5)), size * (0.5 - r * numpy.cos(i * numpy.pi / 5)))
                   for i, r in enumerate([0.45, 0.18] * 5)]
        pen.polygon(corners, fill=0)
    elif number == 2:
        for bar in range(6):
            left = size * (0.08 + 0.15 * bar)
            pen.rounded_rectangle([left, size * dice.uniform(0.1, 0.5), left + size * 0.1, size * 0.9], size * 0.03, fill=0)
    elif number == 3:
        pen.pieslice([size * 0.1, size * 0.1, size * 0.9, size * 0.9], 40, 320, fill=0)
        pen.ellipse([size * 0.5, size * 0.2, size * 0.6, size * 0.3], fill=255)
    else:
        for _ in range(12):
            x, y = dice.uniform(0.15, 0.85, 2) * size
            r = dice.uniform(0.03, 0.12) * size
            pen.ellipse([x - r, y - r, x + r, y + r], fill=int(dice.choice([0, 255])))
    return picture.resize((SIDE, SIDE), Image.BOX)


def photograph(number):
    """A picture like a photograph: smooth noise of a few sizes, with grain."""
    dice = numpy.random.default_rng(100 + number)
    grey = numpy.zeros((SIDE, SIDE))
    for blur in (80, 40, 20):
        noise = Image.fromarray(dice.integers(0, 256, (SIDE, SIDE), dtype=numpy.uint8))
        part = numpy.asarray(noise.filter(ImageFilter.GaussianBlur(blur)), dtype=float)
        grey += (part - part.mean()) / part.std() * blur
    grey = (grey - grey.min()) / (grey.max() - grey.min())
    return Image.fromarray((255 * grey).round().astype(numpy.uint8))


PICTURES = {f"logo {n + 1}": (logo, n) for n in range(5)} | {f"photograph {n + 1}": (photograph, n) for n in range(5)}


def reference(picture):
    """The contours of darkness 0.5 [mm], y upwards."""
    dark = numpy.pad(1 - numpy.asarray(picture, dtype=float) / 255, 1)
    lines = find_contours(dark, 0.5)
    return [numpy.column_stack([line[:, 1] - 0.5, SIDE + 0.5 - line[:, 0]]) * PIXEL for line in lines]


def surrounded(line):
    """The area in a closed line [mm²]."""
    x, y = line.T
    return abs(numpy.dot(x, numpy.roll(y, 1)) - numpy.dot(y, numpy.roll(x, 1))) / 2


def distance(strokes, contours):
    """The Hausdorff distance, without contours of specks [mm]."""
    drawn = sampled(strokes, STEP)
    large = [line for line in contours if surrounded(line) >= SEEN * PIXEL**2]
    return max(farthest(drawn, sampled(contours, STEP)), farthest(sampled(large, STEP), drawn))


def of_svg(file, scale):
    """The outlines of an SVG of potrace or vtracer, y upwards."""
    strokes = []
    for element in svgelements.SVG.parse(str(file)).elements():
        if not isinstance(element, svgelements.Path):
            continue
        for part in element.as_subpaths():
            pieces = [piece for piece in svgelements.Path(part) if not isinstance(piece, svgelements.Move)]
            points = [piece.point(i / 8) for piece in pieces for i in range(9)]
            if points:
                strokes.append(numpy.array([[scale * p.x, 100 - scale * p.y] for p in points]))
    return strokes


def potrace(picture, folder):
    grey, svg = folder / "grey.pgm", folder / "potrace.svg"
    picture.save(grey)
    began = time.perf_counter()
    subprocess.run(["potrace", "--svg", "--blacklevel", "0.5", "--turdsize", str(SPECK), "-o", svg, grey], check=True)
    took = time.perf_counter() - began
    # Its page is in points, of which svgelements makes pixels of 1/96 inch.
    return of_svg(svg, PIXEL * 72 / 96), took


def traced_by_vtracer(picture, folder):
    grey, svg = folder / "grey.png", folder / "vtracer.svg"
    picture.save(grey)
    began = time.perf_counter()
    vtracer.convert_image_to_svg_py(str(grey), str(svg), colormode="binary", mode="spline", filter_speckle=2)
    return of_svg(svg, PIXEL), time.perf_counter() - began


def fivebar(example, picture, folder):
    grey = folder / "grey.png"
    picture.save(grey)
    began = time.perf_counter()
    strokes = ours(example, grey, "outline", "0.5")
    return strokes, time.perf_counter() - began


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("example", type=Path)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--write", type=Path)
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    tracers = {"fivebar": lambda *of: fivebar(given.example, *of), "potrace": potrace, "vtracer": traced_by_vtracer}
    rows, wrong = [], []
    for name, (make, number) in PICTURES.items():
        picture = make(number)
        contours, off = reference(picture), {}
        for tracer, trace in tracers.items():
            strokes, seconds = trace(picture, given.folder)
            off[tracer] = distance(strokes, contours)
            rows.append([name, tracer, f"{off[tracer]:.3f}", len(strokes), len(contours), f"{seconds:.2f}"])
            print(*rows[-1], flush=True)
        own, best = off["fivebar"], min(off["potrace"], off["vtracer"])
        if not own <= min(LARGEST, TIE * best):
            wrong.append(name)
    if given.write is not None:
        with given.write.open("w", newline="") as table:
            writer = csv.writer(table, lineterminator="\n")
            writer.writerow(["picture", "program", "Hausdorff distance [mm]", "strokes", "contours", "time [s]"])
            writer.writerows(rows)
    if wrong:
        sys.exit(f"tracing.py: farther than {LARGEST} mm or {TIE} times the nearer of potrace and vtracer: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
