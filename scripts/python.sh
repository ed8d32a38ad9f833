#!/usr/bin/env bash
# Tests the Python package as its users install it: with `pip install` from the checkout into a
# fresh virtual environment. Then it runs the package's tests and notebooks, type checks, examples and benchmark, and
# compares a front of `fivebar design` with that of pymoo, from PyPI. It skips the tests of PyTorch, whose
# wheel has 0.5 GB and needs 3 GB of libraries: after `pip install torch`, `pytest tests/test_torch.py` runs them.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

(
    cd python
    cargo fmt --check
    cargo clippy --quiet --locked -- -D warnings
)
build_program # the tests compare with it

venv=$built/python-venv
rm -rf "$venv"
if ! python3 -m venv "$venv"; then
    echo "python: python3 with its venv module is needed (Debian: apt-get install python3-venv)" >&2
    exit 1
fi
"$venv/bin/pip" install --quiet --disable-pip-version-check './python[test,cluster,jax]' pymoo
root=$PWD
python=$venv/bin/python
out=$built/python-example
mkdir -p "$out"

(cd python && "$python" -m pytest --quiet)
(cd python && "$python" -m mypy --cache-dir "$built/mypy" package/fivebar examples)
(cd "$out" && "$python" -m mypy.stubtest --concise --ignore-disjoint-bases fivebar._native)
for example in "$root"/python/examples/*.py; do
    (cd "$out" && "$python" "$example")
done
"$python" python/benches/inverse.py
# A small front beside that of another optimiser.
"$python" tests/peers/front.py --front 3 --seeds 1 --cases 0
# Other packages on the same work must give the same answers. They come last, because one of them needs an older NumPy.
"$venv/bin/pip" install --quiet --disable-pip-version-check pin toppra roboticstoolbox-python ruckig
"$venv/bin/python" tests/peers/rivals.py
