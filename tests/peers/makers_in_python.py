"""Drawings made by packages of PyPI: each function writes its files into the folder and yields their names."""

import math
import random
import subprocess
import sys
from pathlib import Path


def with_matplotlib(folder):
    import matplotlib
    matplotlib.use("svg")
    import numpy
    from matplotlib import pyplot

    x, y = numpy.meshgrid(numpy.linspace(-2, 2, 40), numpy.linspace(-2, 2, 40))

    def lines(axes):
        axes.plot(x[0], numpy.sin(3 * x[0]), x[0], numpy.exp(-x[0] ** 2), marker="x")

    def contour(axes):
        axes.contour(x, y, numpy.hypot(x, y) * numpy.cos(3 * x), levels=6)

    def stream(axes):
        axes.streamplot(x, y, -y, x + 0.3 * y, density=0.5)

    def pie(axes):
        axes.pie([3, 2, 4], wedgeprops={"edgecolor": "black"})

    def bars(axes):
        axes.bar([1, 2, 3], [3, 5, 2], edgecolor="black", log=False)

    for draw in (lines, contour, stream, pie, bars):
        figure, axes = pyplot.subplots(figsize=(4, 3))
        draw(axes)
        axes.set_axis_off()
        figure.savefig(folder / f"matplotlib_{draw.__name__}.svg")
        pyplot.close(figure)
        yield f"matplotlib_{draw.__name__}.svg"


def with_svgwrite(folder):
    import svgwrite

    drawing = svgwrite.Drawing(folder / "svgwrite.svg", size=("120mm", "90mm"), viewBox="0 0 120 90")
    symbol = drawing.symbol(id="leaf")
    symbol.add(drawing.path("M0 0C10 -5 20 -5 30 0C20 5 10 5 0 0Z", fill="none", stroke="green"))
    drawing.defs.add(symbol)
    group = drawing.add(drawing.g(transform="translate(60 45)"))
    for index in range(6):
        group.add(drawing.use("#leaf", transform=f"rotate({60 * index})"))
    drawing.add(drawing.polygon([(10, 10), (30, 10), (20, 25)], fill="none", stroke="red", transform="skewX(20)"))
    drawing.save()
    yield "svgwrite.svg"


def with_drawsvg(folder):
    import drawsvg

    drawing = drawsvg.Drawing(200, 150, origin="center")
    drawing.append(drawsvg.Arc(0, 0, 60, 20, 250, fill="none", stroke="black"))
    drawing.append(drawsvg.Lines(-80, -50, -20, -60, -40, 0, close=True, fill="#eee", stroke="black"))
    drawing.append(drawsvg.Path(stroke="blue", fill="none").M(-50, 20).Q(0, 70, 50, 20).T(90, 30).L(20, 60))
    drawing.append(drawsvg.Use(drawsvg.Rectangle(0, 0, 20, 10, rx=3, fill="none", stroke="black"), 40, -60))
    drawing.save_svg(folder / "drawsvg.svg")
    yield "drawsvg.svg"


def with_cairo(folder):
    import cairocffi as cairo

    surface = cairo.SVGSurface(str(folder / "cairo.svg"), 200, 150)
    context = cairo.Context(surface)
    for index in range(5):
        context.save()
        context.translate(100, 75)
        context.rotate(index * 0.5)
        context.scale(1, 0.5)
        context.arc(0, 0, 40 + 5 * index, 0.3, 5)
        context.restore()
        context.stroke()
    context.move_to(10, 10)
    context.curve_to(80, 0, 20, 90, 190, 20)
    context.close_path()
    context.stroke()
    surface.finish()
    yield "cairo.svg"


def with_ezdxf(folder):
    import ezdxf

    for version in ("R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018"):
        document = ezdxf.new(version, units=0 if version == "R12" else 4)
        model = document.modelspace()
        model.add_line((0, 0), (40, 10))
        model.add_circle((20, 30), 8)
        model.add_arc((60, 20), 12, 300, 100)
        block = document.blocks.new("leaf", base_point=(1, 0))
        block.add_arc((5, 0), 5, 0, 180)
        block.add_line((0, 0), (10, 0))
        model.add_blockref("leaf", (10, 50), {"xscale": 2, "yscale": -1.5, "rotation": 30})
        model.add_blockref("leaf", (50, 50), {"xscale": -1, "column_count": 3, "column_spacing": 15, "row_count": 2, "row_spacing": 8})
        model.add_polyline2d([(0, 60, 0.5), (20, 70, -1), (30, 60, 0)], format="xyb", close=True)
        if version != "R12":
            model.add_lwpolyline([(70, 0, 1), (80, 0, 0.2), (90, 20, -0.7), (70, 30, 0)], format="xyb", close=True)
            model.add_ellipse((80, 60), (12, 5), 0.4, 0.5, 5)
            model.add_open_spline([(0, 80), (10, 100), (30, 70), (50, 95), (60, 80)])
            model.add_rational_spline([(70, 80), (80, 100), (90, 80), (100, 95)], [1, 3, 1, 2])
            model.add_mtext("left out").set_location((0, 0))
            model.add_hatch().paths.add_polyline_path([(0, 0), (5, 0), (5, 5)])
        model.add_arc((30, 20), 6, 10, 120, dxfattribs={"extrusion": (0, 0, -1)})
        document.saveas(folder / f"ezdxf_{version}.dxf")
        yield f"ezdxf_{version}.dxf"
    document = ezdxf.new("R2010", units=1)
    document.modelspace().add_spline([(0, 0), (1, 2), (3, 1), (4, 3)])
    document.modelspace().add_line((0, 0), (4, 0))
    document.saveas(folder / "ezdxf_fit_points.dxf")
    yield "ezdxf_fit_points.dxf"


def with_dxfwrite(folder):
    from dxfwrite import DXFEngine as dxf

    drawing = dxf.drawing(str(folder / "dxfwrite.dxf"))
    drawing.add(dxf.line((0, 0), (50, 20)))
    drawing.add(dxf.arc(10, (30, 30), 20, 200))
    drawing.add(dxf.polyline([(0, 40), (20, 60), (40, 40)], flags=1))
    curve = dxf.spline([(0, 70), (20, 90), (40, 60), (60, 80)], segments=40)
    drawing.add(curve)
    drawing.save()
    yield "dxfwrite.dxf"


def with_vpype(folder):
    vpype = str(Path(sys.executable).with_name("vpype"))
    plain = str(folder / "plain.svg")
    orders = {
        "vpype_occult.svg": ["rect", "10mm", "10mm", "50mm", "30mm", "circle", "50mm", "30mm", "20mm", "occult", "write"],
        "vpype_dxy.hpgl": ["read", plain, "write", "-d", "dxy", "-p", "a3", "--center"],
        "vpype_designmate.hpgl": ["read", plain, "write", "-d", "designmate", "-p", "a4", "--center"],
        "vpype_hp7550.hpgl": ["read", plain, "write", "-d", "hp7550", "-p", "a4", "--center"],
        "vpype_artisan.hpgl": ["read", plain, "write", "-d", "artisan", "-p", "a4", "--center"],
    }
    for name, order in orders.items():
        if subprocess.run([vpype, *order, str(folder / name)], capture_output=True).returncode == 0:
            yield name


def with_pygal(folder):
    import pygal

    chart = pygal.XY(show_legend=False, show_x_labels=False, show_y_labels=False, js=[], pretty_print=True)
    chart.add("", [(math.cos(index / 5), math.sin(index / 3)) for index in range(40)])
    chart.render_to_file(str(folder / "pygal.svg"))
    yield "pygal.svg"


def with_schemdraw(folder):
    import schemdraw
    from schemdraw import elements

    schemdraw.use("svg")
    with schemdraw.Drawing(file=str(folder / "schemdraw.svg"), show=False):
        elements.Resistor()
        elements.Capacitor().down()
        elements.Diode().left()
        elements.Inductor2().up()
    yield "schemdraw.svg"


def with_segno(folder):
    import segno

    segno.make("Draw me").save(folder / "segno.svg", scale=4)
    yield "segno.svg"


def with_svgpathtools(folder):
    import svgpathtools

    path = svgpathtools.parse_path("M10 10A30 20 30 1 1 90 60L50 90Q20 90 10 60Z")
    svgpathtools.wsvg([path, path.rotated(40), path.scaled(0.5)], filename=str(folder / "svgpathtools.svg"))
    yield "svgpathtools.svg"


def with_trimesh(folder):
    import numpy
    import trimesh

    ring = trimesh.path.creation.circle(radius=12) + trimesh.path.creation.rectangle(numpy.array([[-20, -15], [25, 18]]))
    for ending in ("dxf", "svg"):
        ring.export(str(folder / f"trimesh.{ending}"))
        yield f"trimesh.{ending}"


def with_typst(folder):
    import typst

    source = folder / "typst.typ"
    source.write_text("#set page(width: 80mm, height: 60mm)\n#place(circle(radius: 15mm))\n#place(dx: 20mm, dy: 10mm, rotate(20deg, rect(width: 25mm, height: 12mm, radius: 3mm)))\n"
                      "#place(curve(curve.move((10mm, 10mm)), curve.cubic((30mm, 0mm), (10mm, 40mm), (50mm, 40mm)), curve.close()))\n")
    typst.compile(str(source), output=str(folder / "typst.svg"), format="svg")
    yield "typst.svg"


def with_networkx(folder):
    import matplotlib
    matplotlib.use("svg")
    import networkx
    from matplotlib import pyplot

    random.seed(1)
    networkx.draw(networkx.petersen_graph(), networkx.circular_layout(networkx.petersen_graph()))
    pyplot.savefig(folder / "networkx.svg")
    yield "networkx.svg"


def written(folder):
    """Each package's name with the names of its files."""
    for name, make in list(globals().items()):
        if name.startswith("with_"):
            yield name.removeprefix("with_"), make(folder)
