"""Drawings made by many programs: for each file the program, the file's name, and the order of a shell that writes it.

The orders run in one folder, in which `SOURCES` lie. Python programs are in `makers_in_python.py`.
"""

SOURCES = {
    "curves.gp": "set samples 200; unset key; plot [0:6] sin(x)*exp(-x/5), 0.3*cos(3*x) with linespoints\n",
    "polar.gp": "set polar; set samples 400; unset key; set grid polar; plot 1+sin(4*t)\n",
    "surface.gp": "set isosamples 12; unset key; set hidden3d; splot [-2:2] [-2:2] exp(-x*x-y*y)\n",
    "boxes.gp": "unset key; set style fill solid 0.5; plot '-' with boxes\n1 3\n2 5\n3 4\n4 1\ne\n",
    "graph.dot": 'digraph { rankdir=LR; a [shape=ellipse]; b [shape=box]; c [shape=hexagon]; d [shape=cylinder]; a->b->c->d; a->d [style=dashed]; d->b }\n',
    "ring.dot": "graph { node [shape=circle label=\"\"]; a--b--c--d--e--a; a--c; b--d; subgraph cluster_x { e; f } }\n",
    "data": "0 0\n1 3\n2 1\n3 4\n4 2\n5 5\n",
    "shapes.pic": ".PS\nbox wid 1 ht 0.5; arrow; circle rad 0.3; line right 0.5 up 0.3; ellipse wid 1 ht 0.4; spline right 0.5 up 0.4 then right 0.5 down 0.8 then right 0.5 up 0.4; arc; arc cw\n.PE\n",
    "part.scad": "difference() { square([40, 25]); translate([12, 12]) circle(r=7, $fn=48); translate([30, 12]) rotate(30) square(8, center=true); }\n",
    "gear.scad": "module tooth(i) { rotate(i*30) translate([15, 0]) polygon([[-3, -3], [5, -1], [5, 1], [-3, 3]]); }\nunion() { circle(r=15, $fn=90); for (i=[0:11]) tooth(i); }\n",
    "offset.scad": "linear_extrude(3) offset(r=3) union() { square([20, 5]); square([5, 20]); }\n",
    "figure.fig": """#FIG 3.2  Produced by xfig version 3.2.8b
Landscape
Center
Metric
A4
100.00
Single
-2
1200 2
1 1 0 1 0 7 50 -1 -1 0.000 1 0.5000 2700 2700 900 450 2700 2700 3600 3150
1 3 0 1 0 7 50 -1 -1 0.000 1 0.0000 5400 2700 600 600 5400 2700 6000 2700
2 1 0 1 0 7 50 -1 -1 0.000 0 0 -1 0 0 4
\t 900 900 3600 900 4500 1800 1800 1800
2 2 0 1 0 7 50 -1 -1 0.000 0 0 -1 0 0 5
\t 4950 900 6750 900 6750 1800 4950 1800 4950 900
2 3 0 2 4 7 50 -1 -1 0.000 0 0 -1 0 0 4
\t 900 3600 1800 4500 2700 3600 900 3600
3 2 0 1 0 7 50 -1 -1 0.000 0 0 0 5
\t 3600 3600 4050 4500 4500 3600 4950 4500 5400 3600
\t 0.000 -1.000 -1.000 -1.000 0.000
5 1 0 1 0 7 50 -1 -1 0.000 0 1 0 0 6300.000 4050.000 5850 4050 6300 3600 6750 4050
""",
    "drawing.ps": """%!PS-Adobe-3.0 EPSF-3.0
%%BoundingBox: 0 0 300 220
newpath 20 20 moveto 120 20 lineto 120 80 lineto 70 110 lineto 20 80 lineto closepath stroke
gsave 200 60 translate 25 rotate newpath 0 0 40 0 300 arc stroke newpath -30 -20 60 40 rectstroke grestore
newpath 20 150 moveto 80 220 120 100 180 180 curveto stroke
newpath 200 130 moveto 280 130 lineto 240 200 lineto closepath gsave 0.8 setgray fill grestore stroke
0.5 setlinewidth 10 10 280 200 rectstroke
showpage
%%EOF
""",
    "bitmap.pbm": "P1\n24 16\n" + "\n".join(" ".join("1" if (x - 8) ** 2 + (y - 8) ** 2 < 36 or (x > 14 and 3 < y < 12 and x + y < 28) else "0"
                                                       for x in range(24)) for y in range(16)) + "\n",
    "board.gbr": """%FSLAX46Y46*%
%MOMM*%
%ADD10C,0.5*%
%ADD11R,2X1*%
G01*
D10*
X1000000Y1000000D02*
X21000000Y1000000D01*
X21000000Y11000000D01*
X1000000Y11000000D01*
X1000000Y1000000D01*
X5000000Y5000000D02*
X15000000Y8000000D01*
D11*
X5000000Y5000000D03*
X15000000Y8000000D03*
M02*
""",
    "formula.tex": "\\documentclass{article}\\pagestyle{empty}\\begin{document}$\\displaystyle\\int_0^\\infty e^{-x^2}\\,dx=\\frac{\\sqrt\\pi}{2}$\\end{document}\n",
    "curve.asy": 'size(80mm); draw((0,0)..(1,2)..(3,1)..(4,3)); draw(ellipse((2,1),1.5,0.7)); draw(shift(3,0)*rotate(30)*box((0,0),(1,0.5)),red); draw(arc((1,1),0.5,20,200),Arrow);\n',
    "figure.mp": 'outputformat:="svg"; outputtemplate:="metapost.svg"; beginfig(1); draw (0,0)..(30,60)..(90,20)..cycle; draw fullcircle xscaled 60 yscaled 30 rotated 20 shifted (60,60); draw (0,80)--(100,90) withpen pencircle scaled 2; endfig; end\n',
    "plot.gle": "size 12 8\namove 1 1\nbox 4 3\namove 8 4\ncircle 2\namove 1 6\nbezier 3 9 6 2 9 7\namove 6 1\naline 11 1.5 arrow end\n",
    "figure.R": "svg('r.svg', width=5, height=4); plot(cars, axes=FALSE, ann=FALSE); lines(lowess(cars)); abline(h=40, lty=2); polygon(c(5,10,8), c(80,90,110)); dev.off()\n",
    "chart.msc": "msc { a [label=\"\"], b [label=\"\"], c [label=\"\"]; a->b; b=>c; c>>a; a box b; b->*; }\n",
    "tune.abc": "X:1\nT:\nM:4/4\nL:1/8\nK:G\nGABc dedB|dedB dedB|c2ec B2dB|A4 G4|]\n",
    "map.geojson": '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[60,0],[50,40],[10,30],[0,0]]]}},{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[5,5],[20,15],[35,8],[45,25]]}}]}\n',
    "picture_pyx.py": "import pyx\nc = pyx.canvas.canvas()\nc.stroke(pyx.path.circle(2, 2, 1.5), [pyx.trafo.rotate(20), pyx.trafo.scale(1, 0.5)])\nc.stroke(pyx.path.curve(0, 0, 1, 4, 3, -2, 5, 3))\nc.stroke(pyx.path.rect(0, 0, 5, 3))\nc.writeSVGfile('pyx')\n",
    "plain.hpgl": "IN;SP1;PU400,400;PD2400,400,2400,1600,1400,2200,400,1600,400,400;PU3600,1200;CI500;SP2;PU400,2600;PD800,3000,1200,2600,1600,3000;PU;SP0;\n",
    "cube.scad": "difference() { cube([20, 15, 0.6]); translate([10, 7, -1]) cylinder(r=4, h=3, $fn=24); }\n",
}

PLAIN_SVG = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 80" width="100mm" height="80mm"><g fill="none" stroke="black" stroke-width="0.3">
<path d="M5 5H45V25L25 35L5 25Z"/><path d="M55 5C75 5 75 35 90 35S90 5 75 20"/><path d="M10 45A15 10 20 1 1 35 60"/><circle cx="60" cy="60" r="12.5"/>
<g transform="translate(75 45) rotate(30)"><rect width="15" height="10" rx="2"/><ellipse cx="8" cy="18" rx="7" ry="3"/></g></g></svg>
"""
SOURCES["plain.svg"] = PLAIN_SVG


def gnuplot(terminal, output, source):
    return "gnuplot", output, f"gnuplot -e 'set terminal {terminal}; set output \"{output}\"' {source}"



FILES = [
    gnuplot("svg", "gnuplot_curves.svg", "curves.gp"),
    gnuplot("svg", "gnuplot_polar.svg", "polar.gp"),
    gnuplot("svg", "gnuplot_boxes.svg", "boxes.gp"),
    gnuplot("hpgl", "gnuplot_curves.hpgl", "curves.gp"),
    gnuplot("hpgl", "gnuplot_surface.hpgl", "surface.gp"),
    gnuplot("pcl5", "gnuplot_pcl5.hpgl", "curves.gp"),
    gnuplot("dxf", "gnuplot_polar.dxf", "polar.gp"),
    gnuplot("dxf", "gnuplot_surface.dxf", "surface.gp"),
    ("graphviz dot", "dot.svg", "dot -Tsvg graph.dot -o dot.svg"),
    ("graphviz neato", "neato.svg", "neato -Tsvg ring.dot -o neato.svg"),
    ("graphviz circo", "circo.svg", "circo -Tsvg:cairo ring.dot -o circo.svg"),
    ("plotutils graph", "graph.hpgl", "graph -T hpgl <data >graph.hpgl"),
    ("plotutils graph", "graph1.hpgl", "HPGL_VERSION=1 graph -T hpgl <data >graph1.hpgl"),
    ("plotutils graph", "graph15.hpgl", "HPGL_VERSION=1.5 graph -T hpgl -S 4 <data >graph15.hpgl"),
    ("plotutils graph", "graph.svg", "graph -T svg -S 3 <data >graph.svg"),
    ("plotutils pic2plot", "pic2plot.hpgl", "pic2plot -T hpgl shapes.pic >pic2plot.hpgl"),
    ("plotutils pic2plot", "pic2plot1.hpgl", "HPGL_VERSION=1 pic2plot -T hpgl shapes.pic >pic2plot1.hpgl"),
    ("plotutils pic2plot", "pic2plot.svg", "pic2plot -T svg shapes.pic >pic2plot.svg"),
    ("plotutils plotfont", "plotfont.hpgl", "plotfont -T hpgl HersheySerif >plotfont.hpgl"),
    ("OpenSCAD", "openscad_part.dxf", "openscad -o openscad_part.dxf part.scad"),
    ("OpenSCAD", "openscad_gear.dxf", "openscad -o openscad_gear.dxf gear.scad"),
    ("OpenSCAD", "openscad_part.svg", "openscad -o openscad_part.svg part.scad"),
    ("OpenSCAD", "openscad_gear.svg", "openscad -o openscad_gear.svg gear.scad"),
    ("fig2dev", "fig2dev.svg", "fig2dev -L svg figure.fig fig2dev.svg"),
    ("fig2dev", "fig2dev.hpgl", "fig2dev -L ibmgl figure.fig fig2dev.hpgl"),
    ("fig2dev", "fig2dev_dxf.dxf", "fig2dev -L dxf figure.fig fig2dev_dxf.dxf"),
    ("qrencode", "qrencode.svg", "qrencode -t SVG -o qrencode.svg 'Draw me'"),
    ("qrencode", "qrencode_rle.svg", "qrencode -t SVG --rle -o qrencode_rle.svg 'Draw me again'"),
    ("zint", "zint.svg", "zint --notext -b 20 -o zint.svg -d 12345"),
    ("barcode", "barcode.svg", "barcode -n -S -b 12345678 -o barcode.svg"),
    ("pstoedit", "pstoedit.hpgl", "pstoedit -f hpgl drawing.ps pstoedit.hpgl"),
    ("pstoedit", "pstoedit.dxf", "pstoedit -f dxf drawing.ps pstoedit.dxf"),
    ("pstoedit", "pstoedit_s.dxf", "pstoedit -f 'dxf_s:-splineasbspline -mm' drawing.ps pstoedit_s.dxf"),
    ("pstoedit", "pstoedit.gcode", "pstoedit -f gcode drawing.ps pstoedit.gcode"),
    ("pstoedit", "pstoedit.svg", "pstoedit -f plot-svg drawing.ps pstoedit.svg"),
    ("potrace", "potrace.svg", "potrace -s bitmap.pbm -o potrace.svg"),
    ("potrace", "potrace.dxf", "potrace -b dxf bitmap.pbm -o potrace.dxf"),
    ("gerbv", "gerbv.svg", "gerbv -x svg -o gerbv.svg board.gbr"),
    ("dvisvgm", "dvisvgm.svg", "latex -interaction=batchmode formula.tex >/dev/null && dvisvgm --no-fonts formula.dvi -o dvisvgm.svg"),
    ("asymptote", "asymptote.svg", "asy -f eps curve.asy -o asymptote.eps && pstoedit -f plot-svg asymptote.eps asymptote.svg"),
    ("metapost", "metapost.svg", "mpost -interaction=batchmode figure.mp >/dev/null"),
    ("GLE", "gle.svg", "gle -d svg -o gle.svg plot.gle"),
    ("R", "r.svg", "Rscript figure.R"),
    ("mscgen", "mscgen.svg", "mscgen -T svg -i chart.msc -o mscgen.svg"),
    ("abcm2ps", "abcm2ps.svg", "abcm2ps -g tune.abc -O abcm2ps.svg && mv abcm2ps001.svg abcm2ps.svg"),
    ("GDAL", "ogr2ogr.dxf", "ogr2ogr -f DXF ogr2ogr.dxf map.geojson"),
    ("hp2xx", "hp2xx.dxf", "hp2xx -q -m dxf -f hp2xx.dxf plain.hpgl"),
    ("hp2xx", "hp2xx.svg", "hp2xx -q -m svg -f hp2xx.svg plain.hpgl"),
    ("hp2xx", "hp2xx.hpgl", "hp2xx -q -m hpgl -f hp2xx.hpgl plain.hpgl"),
    ("Ghostscript and pdftocairo", "pdftocairo.svg", "gs -q -dBATCH -dNOPAUSE -dEPSCrop -sDEVICE=pdfwrite -o drawing.pdf drawing.ps && pdftocairo -svg drawing.pdf pdftocairo.svg"),
    ("mutool", "mutool.svg", "mutool draw -q -o mutool%d.svg drawing.pdf 1 && mv mutool1.svg mutool.svg"),
    ("pdf2svg", "pdf2svg.svg", "pdf2svg drawing.pdf pdf2svg.svg"),
    ("rsvg-convert", "rsvg.svg", "rsvg-convert -f svg plain.svg -o rsvg.svg"),
    ("scour", "scour.svg", "scour --enable-viewboxing --shorten-ids -i plain.svg -o scour.svg -q"),
    ("PyX", "pyx.svg", "/usr/bin/python3 picture_pyx.py"),
    ("ploticus", "ploticus.svg", "ploticus -prefab scat data=data x=1 y=2 -svg -o ploticus.svg"),
    ("slic3r", "slic3r.gcode", "openscad -q -o cube.stl cube.scad && slic3r --no-gui -o slic3r.gcode cube.stl"),
    ("slic3r", "slic3r.svg", "slic3r --no-gui --export-svg -o slic3r.svg cube.stl"),
]
