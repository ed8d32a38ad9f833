"""What other programs write, drawn by Fivebar beside what an independent reader finds in the same file, and beside the drawing.

    python programs.py OUR_EXAMPLE FOLDER_OF_PROGRAMS FOLDER

One drawing of lines, arcs, curves, an ellipse and nested transforms goes through vpype (SVG and HPGL), vpype-gcode (its
profiles in millimetres, in inches and relative), svg-to-gcode and Inkscape (SVG, DXF, HPGL). Fails if any stroke is more than 0.05 mm off.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

from readers import of_dxf, of_gcode, of_hpgl, of_svg
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
