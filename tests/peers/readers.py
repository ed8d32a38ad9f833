"""Readers of drawings that share nothing with Fivebar: strokes as lists of points [mm], with y upwards."""

import math
import re

import ezdxf
import ezdxf.disassemble
import ezdxf.path
import numpy
import svgelements
from scipy.interpolate import BSpline

MILLIMETRE = 96 / 25.4  # in units of svgelements
UNITS = {0: 1, 1: 25.4, 2: 304.8, 4: 1, 5: 10, 6: 1000}  # millimetres in each $INSUNITS


def of_svg(file):
    """The strokes of an SVG as svgelements reads it."""
    strokes = []
    for element in svgelements.SVG.parse(str(file), ppi=96).elements():
        if not isinstance(element, svgelements.Shape) or not is_seen(element):
            continue
        path = svgelements.Path(element)
        for part in abs(path).as_subpaths() if len(path) else ():
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


def is_seen(shape):
    """Whether a shape has a fill or a line that is not transparent."""
    values = shape.values
    if values.get("visibility") in ("hidden", "collapse") or values.get("display") == "none" or values.get("opacity") == "0":
        return False
    if shape.stroke_width == 0 and shape.fill.value is None:
        return False
    paints = ((shape.fill, "fill-opacity"), (shape.stroke, "stroke-opacity"))
    return any(paint.value is not None and paint.alpha > 0 and values.get(opacity) not in ("0", "0.0")
               for paint, opacity in paints)


def of_gcode(file):
    """The strokes of G-code with G0 to G3 (I and J), G20, G21, G90 and G91. The tool is down by E, the laser, Z, or on G1 to G3."""
    unit, is_relative, at, strokes, was_drawn, motion, laser, z = 1.0, False, numpy.zeros(2), [], False, 0, None, None
    extruded, extrudes = 0.0, None
    for line in file.read_text().splitlines():
        words = re.findall(r"([A-Z])\s*([-+]?[\d.]+)", re.sub(r"\(.*?\)|;.*", "", line.upper()))
        target, middle = at.copy(), numpy.zeros(2)
        for letter, number in words:
            value = float(number)
            if letter == "G":
                if value in (20, 21):
                    unit = 25.4 if value == 20 else 1.0
                elif value in (90, 91):
                    is_relative = value == 91
                elif value in (0, 1, 2, 3):
                    motion = value
                elif value not in (4, 17, 28, 54, 64, 92, 94):
                    raise ValueError(f"{file}: G{number}")
            elif letter == "M" and value in (3, 4, 5):
                laser = value != 5
            elif letter == "E":
                extrudes = value > extruded if "G92" not in line else False
                extruded = value
            elif letter == "Z":
                z = value
            elif letter in "XY":
                axis = "XY".index(letter)
                target[axis] = value * unit + (at[axis] if is_relative else 0)
            elif letter in "IJ":
                middle["IJ".index(letter)] = value * unit
        if extrudes is not None and not any(letter == "E" for letter, _ in words):
            extrudes = False
        if not any(letter in "XYIJ" for letter, _ in words):
            continue
        draws = extrudes if extrudes is not None else laser if laser is not None else z < 0 if z is not None else motion >= 1
        if draws and ((target != at).any() or motion >= 2):
            if not was_drawn:
                strokes.append([at])
            turn = 0.0
            if motion >= 2:
                turn = turned(at, target, at + middle, motion == 3)
                strokes[-1].extend(along(at, at + middle, turn))
            strokes[-1].append(target)
        was_drawn, at = draws, target
    return [numpy.array(stroke) for stroke in strokes if len(stroke) > 1]


def turned(start, end, middle, is_left):
    """The angle of an arc [rad], to the left or to the right."""
    first, last = (math.atan2(*(point - middle)[::-1]) for point in (start, end))
    turn = (last - first) % math.tau
    turn = turn if turn > 1e-9 else math.tau
    return turn if is_left else turn - math.tau if turn < math.tau else -math.tau


def along(start, middle, turn, count=400):
    """Points of an arc behind its start."""
    x, y = start - middle
    for index in range(1, count + 1):
        angle = turn * index / count
        yield middle + [math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y]


def of_hpgl(file):
    """The strokes of HPGL with PU, PD, PA, PR, CI, AA, AR, EA, BZ, IP, SC and RO, in units of 1/40 mm."""
    text = file.read_bytes().decode("latin-1")
    text = re.sub("\x1b(%-?\\d*[A-Z]|\\.[A-Z@()](?:[^:]*:)?|E|[&*][^A-Z]*[A-Z])", "", text)
    text = re.sub("LB[^\x03]*\x03", ";", text)
    strokes, at, is_down, is_relative, is_open = [], numpy.zeros(2), False, False, False
    frame, scale, zero, quarter = None, numpy.ones(2), numpy.zeros(2), 0

    def place(point):
        x, y = (zero + scale * point) / 40
        for _ in range(quarter):
            x, y = -y, x
        return numpy.array([x, y])

    def go(points, draws):
        nonlocal at, is_open
        for point in points:
            if draws and not is_open:
                strokes.append([place(at)])
            if draws:
                strokes[-1].append(place(point))
            at, is_open = point, draws

    for name, numbers in re.findall(r"([A-Za-z]{2})\s*([-+\d., \r\n]*)", text):
        name = name.upper()
        numbers = [float(it) for it in re.findall(r"[-+]?[\d.]+", numbers)]
        points = [numpy.array(point) for point in zip(numbers[::2], numbers[1::2])]
        if name in ("PA", "PR"):
            is_relative = name == "PR"
        if name in ("PU", "PD"):
            is_down = name == "PD"
            is_open = is_open and is_down
        if name in ("PU", "PD", "PA", "PR"):
            for point in points:
                go([at + point if is_relative else point], is_down)
        elif name == "SP":
            is_down = is_open = False
        elif name == "CI":
            middle, is_open = at, False
            at = middle + [numbers[0], 0]
            go(list(along(at, middle, math.tau)), True)
            at, is_open = middle, False
        elif name in ("AA", "AR"):
            middle = points[0] + (at if name == "AR" else 0)
            go(list(along(at, middle, math.radians(numbers[2]))), is_down)
        elif name in ("EA", "ER"):
            x, y = points[0] + (at if name == "ER" else 0)
            start = at
            is_open = False
            go([numpy.array([x, at[1]]), numpy.array([x, y]), numpy.array([start[0], y]), start], True)
            is_open = False
        elif name == "BZ":
            for index in range(0, len(points), 3):
                a, b, c, d = at, *points[index:index + 3]
                steps = numpy.linspace(0, 1, 200)[1:]
                go([(1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t * t * (1 - t) * c + t ** 3 * d for t in steps], is_down)
        elif name in ("IN", "DF"):
            frame, scale, zero, quarter, is_down, is_relative, is_open = None, numpy.ones(2), numpy.zeros(2), 0, False, False, False
        elif name == "IP":
            frame = numbers or None
        elif name == "RO":
            quarter = int(numbers[0] // 90) if numbers else 0
        elif name == "SC" and numbers:
            (left, right, low, high), (x1, y1, x2, y2) = numbers[:4], frame
            now = zero + scale * at
            scale = numpy.array([(x2 - x1) / (right - left), (y2 - y1) / (high - low)])
            zero = numpy.array([x1, y1]) - scale * [left, low]
            at = (now - zero) / scale
    return [numpy.array(stroke) for stroke in strokes]


def of_dxf(file):
    """The strokes of a DXF as ezdxf reads it, blocks resolved; texts, hatches and points have none."""
    document = ezdxf.readfile(file)
    # ezdxf supposes metres in a file that states no unit.
    states_unit = "$INSUNITS" in file.read_text(errors="replace")
    unit, strokes = UNITS[document.units] if states_unit else 1, []
    for entity in ezdxf.disassemble.recursive_decompose(document.modelspace()):
        layer = document.layers.get(entity.dxf.layer) if entity.dxf.layer in document.layers else None
        if entity.dxftype() in ("TEXT", "MTEXT", "ATTRIB", "ATTDEF", "HATCH", "POINT", "SOLID") or entity.dxf.invisible:
            continue
        if layer and (layer.is_off() or layer.is_frozen()):
            continue
        if entity.dxftype() == "SPLINE" and len(entity.control_points):
            strokes.append(unit * of_spline(entity))
            continue
        curve = ezdxf.path.make_path(entity)
        for part in curve.sub_paths() if curve.has_sub_paths else [curve]:
            if len(part):
                strokes.append(unit * numpy.array([point.vec2 for point in part.flattening(0.002 / unit, segments=16)]))
    return strokes


def of_spline(entity):
    """Points of a spline between its inner knots; ezdxf takes the outer ones as well, where it is no curve."""
    degree, knots = entity.dxf.degree, numpy.array(entity.knots)
    points = numpy.array(entity.control_points)[:, :2]
    weights = numpy.array(entity.weights if len(entity.weights) else numpy.ones(len(points)))[:, None]
    curve = BSpline(knots, numpy.hstack([points * weights, weights]), degree)
    at = curve(numpy.linspace(knots[degree], knots[-degree - 1], 2000))
    return at[:, :2] / at[:, 2:]


READERS = {".svg": of_svg, ".dxf": of_dxf}
READERS |= dict.fromkeys((".ngc", ".gcode", ".nc"), of_gcode)
READERS |= dict.fromkeys((".hpgl", ".plt", ".hpg"), of_hpgl)
