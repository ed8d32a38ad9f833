#!/usr/bin/env python3
"""Checks that imports run one way: between the crates as scripts/arrows.txt allows, and between the
top-level modules of a crate without a circle. It reads `crate::`, `super::` and the crates' manifests."""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
#: Of the workspace, and of the folders with a lock file of their own.
MANIFESTS = [
    "Cargo.toml",
    "kinematics/c/Cargo.toml",
    "verify/chip/Cargo.toml",
    "verify/fuzz/Cargo.toml",
    "verify/leg_m0/Cargo.toml",
    "python/Cargo.toml",
]
#: A test module at the end of a file may use what the file may not.
TESTS = re.compile(r"#\[cfg\(test\)\]\s*mod \w+ \{.*\Z", re.S)
COMMENT = re.compile(r"//.*")


def allowed():
    """The crates that each crate may use."""
    arrows = {}
    for line in (ROOT / "scripts/arrows.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            crate, _, below = line.partition(" ->")
            arrows[crate] = set(below.split())
    return arrows


def packages():
    """The crates of the workspace and of the folders with a lock file of their own."""
    for manifest in MANIFESTS:
        command = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--manifest-path", ROOT / manifest]
        yield from json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["packages"]


def wrong_crates(package, arrows):
    """Dependencies that the list does not allow; those of tests are free."""
    name = package["name"]
    if name not in arrows:
        return [f"scripts/arrows.txt has no line for {name}"]
    used = {d["name"] for d in package["dependencies"] if d["kind"] is None and d["name"].startswith("fivebar")}
    return [f"{name} -> {other}: scripts/arrows.txt does not allow it" for other in sorted(used - arrows[name])]


def modules(source):
    """The top-level modules of a crate, and for each the others that it names."""
    names = {path.stem for path in source.glob("*") if path.suffix == ".rs" or path.is_dir()}
    names -= {"lib", "main", "bin"}
    graph = {name: {} for name in names}
    for path in sorted(source.rglob("*.rs")):
        parts = path.relative_to(source).with_suffix("").parts
        if parts[0] not in names or path.stem == "tests":
            continue
        depth = len(parts) - (parts[-1] == "mod")
        text = COMMENT.sub("", TESTS.sub("", path.read_text(encoding="utf-8")))
        up = r"(?<!super::)" + r"super::" * depth
        for found in re.findall(rf"(?:\bcrate::|{up})(\w+|\{{[^}}]*\}})", text):
            for other in re.findall(r"\w+", found):
                if other in names and other != parts[0]:
                    graph[parts[0]].setdefault(other, path.relative_to(ROOT))
    return graph


def circle(graph):
    """A circle of modules, if there is one."""
    done, path = set(), []

    def visit(name):
        if name in path:
            return path[path.index(name):] + [name]
        if name in done:
            return None
        path.append(name)
        found = next((c for other in sorted(graph[name]) if (c := visit(other))), None)
        path.pop()
        done.add(name)
        return found

    return next((c for name in sorted(graph) if (c := visit(name))), None)


def main():
    arrows = allowed()
    faults = []
    for package in packages():
        faults += wrong_crates(package, arrows)
        graph = modules(pathlib.Path(package["manifest_path"]).parent / "src")
        if found := circle(graph):
            steps = [f"{a} -> {b} ({graph[a][b]})" for a, b in zip(found, found[1:])]
            faults.append(f"{package['name']}: its modules import in a circle: {', '.join(steps)}")
    for fault in faults:
        print(f"arrows: {fault}", file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
