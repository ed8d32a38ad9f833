"""What other programs write, drawn by Fivebar beside what an independent reader finds in the same file, and beside the drawing.

    python programs.py OUR_EXAMPLE FOLDER_OF_PROGRAMS FOLDER

One drawing of lines, arcs, curves, an ellipse and nested transforms goes through vpype (SVG and HPGL), vpype-gcode (its
profiles in millimetres, in inches and relative), svg-to-gcode and Inkscape (SVG, DXF, HPGL). Fails if any stroke is more than 0.05 mm off.
"""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

import ezdxf.path
import numpy
import svgelements
from shapes import corners, hausdorff, ours
from svg_to_gcode import TOLERANCES
from svg_to_gcode.compiler import Compiler, interfaces
from svg_to_gcode.svg_parser import parse_file

NEAR = 0.05  # mm
DRAWING = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 80" width="100mm" height="80mm">
<g fill="none" stroke="black" stroke-width="0.3">
<path d="M5 5H45V25L25 35L5 25Z"/>
<path d="M55 5C75 5 75 35 90 35S90 5 75 20"/>
<path d="M10 45A15 10 20 1 1 35 60"/>
<circle cx="60" cy="60" r="12.5"/>
<g transform="translate(75 45) rotate(30)"><rect width="15" height="10"/><ellipse cx="8" cy="18" rx="7" ry="3"/></g>
<polyline points="5,70 10,75 15,70 20,75 25,70 30,75"/>
</g></svg>
"""
MILLIMETRE = 96 / 25.4  # in units of svgelements


def of_svg(file):
    """The strokes of an SVG as svgelements reads it, with y upwards."""
    strokes = []
    for element in svgelements.SVG.parse(str(file), ppi=96).elements():
        if not isinstance(element, svgelements.Shape):
            continue
        for part in abs(svgelements.Path(element)).as_subpaths():
            part = svgelements.Path(part)
            pieces = [piece for piece in part if not isinstance(piece, svgelements.Move)]
            points = [[pieces[0].start.x, pieces[0].start.y]] if pieces else []
            for piece in pieces:
                count = 1 if isinstance(piece, (svgelements.Line, svgelements.Close)) else 400
                for index in range(1, count + 1):
                    point = piece.point(index / count)
                    points.append([point.x, point.y])
            if len(points) > 1:
                strokes.append(numpy.array(points) / MILLIMETRE * [1, -1])
    return strokes


def of_gcode(file):
    """The strokes of G-code with G0 and G1, G20, G21, G90 and G91: G1 draws, and so does G0 with the laser on."""
    unit, is_relative, at, strokes, was_drawn, motion, laser, z = 1.0, False, numpy.zeros(2), [], False, 0, None, None
    for line in file.read_text().splitlines():
        words = re.findall(r"([A-Z])\s*(-?[\d.]+)", re.sub(r"\(.*?\)|;.*", "", line.upper()))
        target = at.copy()
        for letter, number in words:
            value = float(number)
            if letter == "G":
                if value in (20, 21):
                    unit = 25.4 if value == 20 else 1.0
                elif value in (90, 91):
                    is_relative = value == 91
                elif value in (0, 1):
                    motion = value
                elif value not in (4, 17, 28):
                    raise ValueError(f"{file}: G{number}")
            elif letter == "M" and value in (3, 4, 5):
                laser = value != 5
            elif letter == "Z":
                z = value
            elif letter in "XY":
                axis = "XY".index(letter)
                target[axis] = value * unit + (at[axis] if is_relative else 0)
        if not any(letter in "XY" for letter, _ in words):
            continue
        draws = laser if laser is not None else z < 0 if z is not None else motion == 1
        if draws and (target != at).any():
            if not was_drawn:
                strokes.append([at])
            strokes[-1].append(target)
        was_drawn, at = draws, target
    return [numpy.array(stroke) for stroke in strokes]


def of_hpgl(file):
    """The strokes of HPGL with PU, PD, PA and PR, in units of 1/40 mm."""
    strokes, at, is_down, is_relative = [], numpy.zeros(2), False, False
    for order in file.read_text().split(";"):
        name, numbers = order.strip()[:2], [float(it) for it in re.findall(r"-?[\d.]+", order[2:])]
        if name not in ("PU", "PD", "PA", "PR"):
            continue
        is_relative = {"PA": False, "PR": True}.get(name, is_relative)
        is_down = {"PU": False, "PD": True}.get(name, is_down)
        for point in zip(numbers[::2], numbers[1::2]):
            point = numpy.array(point) / 40 + is_relative * at
            if is_down:
                if not strokes or (strokes[-1][-1] != at).any():
                    strokes.append([at])
                strokes[-1].append(point)
            at = point
    return [numpy.array(stroke) for stroke in strokes]


def of_dxf(file):
    """The strokes of a DXF as ezdxf reads it."""
    curves = [ezdxf.path.make_path(entity) for entity in ezdxf.readfile(file).modelspace()]
    return [numpy.array([point.vec2 for point in curve.flattening(0.005)]) for curve in curves if len(curve)]


def written(folder, programs):
    """What each program makes of the drawing: its name, the file, its reader, and whether the program itself keeps the drawing:
    relative coordinates add up their rounding, svg-to-gcode knows paths only, Inkscape rounds DXF and cuts over in HPGL.
    """
    drawing = folder / "drawing.svg"
    drawing.write_text(DRAWING)

    def vpype(name, *orders):
        subprocess.run([programs / "vpype", "read", "--quantization", "0.01mm", str(drawing), *orders], check=True)
        return folder / name

    yield "drawing", drawing, of_svg, True
    yield "vpype.svg", vpype("vpype.svg", "linesort", "write", str(folder / "vpype.svg")), of_svg, True
    plot = ["write", "--device", "hp7475a", "--page-size", "a4", "--landscape", "--center", str(folder / "vpype.hpgl")]
    yield "vpype.hpgl", vpype("vpype.hpgl", *plot), of_hpgl, False
    for profile in ("gcodemm", "gcode", "gcode_relative"):
        name = f"{profile}.gcode"
        yield f"vpype-gcode {profile}", vpype(name, "gwrite", "--profile", profile, str(folder / name)), of_gcode, profile != "gcode_relative"
    TOLERANCES["approximation"] = 0.005
    compiler = Compiler(interfaces.Gcode, movement_speed=3000, cutting_speed=1000, pass_depth=0)
    compiler.append_curves(parse_file(str(drawing)))
    file = folder / "svg-to-gcode.gcode"
    compiler.compile_to_file(str(file), passes=1)
    yield "svg-to-gcode", file, of_gcode, False
    for ending, reader in (("svg", of_svg), ("dxf", of_dxf), ("hpgl", of_hpgl)):
        file = folder / f"inkscape.{ending}"
        orders = ["--actions=select-all:all;object-to-path", "--export-plain-svg"] if ending == "svg" else []
        source = drawing if ending == "svg" else folder / "inkscape.svg"
        # Its extensions need Debian's Python.
        subprocess.run(["inkscape", source, *orders, f"--export-type={ending}", f"--export-filename={file}"], check=True,
                       env={**os.environ, "PATH": "/usr/bin:/bin"}, stderr=subprocess.DEVNULL)
        yield f"Inkscape {ending}", file, reader, ending == "svg"


def main():
    arguments = argparse.ArgumentParser()
    for name in ("example", "programs", "folder"):
        arguments.add_argument(name, type=Path)
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    wrong, drawing = [], None
    for name, file, reader, is_kept in written(given.folder, given.programs):
        strokes, found = reader(file), ours(given.example, file)
        # Fivebar centres a drawing; G-code keeps its place.
        to_corner = [[stroke - corners(one)[0] for stroke in one] for one in (strokes, found)]
        off = hausdorff(*to_corner)
        drawing = drawing or to_corner[0]
        from_drawing = hausdorff(to_corner[1], drawing)
        print(f"{name}: {len(found)} strokes, {off:.4f} mm from its reader, {from_drawing:.4f} mm from the drawing", flush=True)
        if not (off <= NEAR and (from_drawing <= NEAR or not is_kept)):
            wrong.append(name)
    if wrong:
        sys.exit(f"programs.py: more than {NEAR} mm off: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
