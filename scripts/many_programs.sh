#!/usr/bin/env bash
# Draws files that many programs of Debian and PyPI make, beside independent readers of them, and writes
# docs/verify/data/files_of_programs.csv. It takes some minutes, and installs the programs.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo -n "$@"; fi; }
as_root apt-get update -qq
as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    abcm2ps asymptote barcode dvisvgm fig2dev gdal-bin gerbv ghostscript gle-graphics gnuplot-nox graphviz hp2xx librsvg2-bin \
    mscgen mupdf-tools openscad pdf2svg ploticus plotutils poppler-utils potrace pstoedit python3-pyx qrencode r-base-core \
    scour slic3r texlive-latex-base texlive-metapost zint >/dev/null
venv=$built/many-venv
if ! [ -x "$venv/bin/vpype" ]; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet cairocffi drawsvg dxfwrite ezdxf matplotlib networkx pygal schemdraw scipy segno \
        svgelements svgpathtools svgwrite trimesh shapely typst vpype vpype-occult
fi
cargo build --quiet "${with_features[@]}" --example strokes
"$venv/bin/python" tests/peers/many.py "$built/debug/examples/strokes" "$built/many_programs" docs/verify/data/files_of_programs.csv
