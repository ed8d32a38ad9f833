#!/usr/bin/env python3
"""Checks that imports run one way: between the crates as scripts/arrows.txt allows, between the top-level modules of a
crate without a circle, and between its files without a circle of more than three. It reads `crate::`, `super::` and the
crates' manifests."""

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
#: Comments, and where an item is visible, which is no import.
COMMENT = re.compile(r"//.*|\bpub\(in [\w:]+\)")
#: An import, and one that hands its names on.
USE = re.compile(r"^\s*use\s+([^;]+);", re.M)
EXPORT = re.compile(r"^\s*pub(?:\([^)]*\))?\s+use\s+([^;]+);", re.M)
#: The most files that may import each other in a circle.
MOST_IN_CIRCLE = 3
#: Folders that are one type in many files.
ONE_TYPE = {"firmware/src/controller", "firmware/src/planner"}


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


def leaves(tree):
    """The paths of an import, each a list of names: `a::{b, c::d}` has two."""
    tree, paths, depth, start = re.sub(r"\s+(as\s+\w+)?", "", tree) + ",", [], 0, 0
    for place, letter in enumerate(tree):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            head, brace, rest = tree[start:place].partition("{")
            start = place + 1
            below = leaves(rest[:-1]) if brace else [[]]
            paths += [list(filter(None, head.split("::"))) + path for path in below] if head or brace else []
    return paths


class Files:
    """The files of a crate as modules, each named by its path, and what each imports."""

    def __init__(self, source):
        self.texts = {}
        for path in source.rglob("*.rs"):
            parts = path.relative_to(source).with_suffix("").parts
            if parts[0] != "bin" and "tests" not in parts:
                name = parts[:-1] if parts[-1] in ("mod", "lib", "main") else parts
                self.texts[name] = COMMENT.sub("", TESTS.sub("", path.read_text(encoding="utf-8")))
        self.exports = {name: [leaf for tree in EXPORT.findall(text) for leaf in leaves(tree)]
                        for name, text in self.texts.items()}

    def imports(self, name):
        """The files that a file imports from. What a folder hands on is imported from the file that has it."""
        text = EXPORT.sub("", self.texts[name])
        paths = [leaf for tree in USE.findall(text) for leaf in leaves(tree)]
        paths += [path.split("::") for path in re.findall(r"\b((?:crate|super)(?:::\w+)+)", USE.sub("", text))]
        found = {self.file_of(name, path) for path in paths}
        # The root of a crate hands on what the others have.
        return {} if name == () else dict.fromkeys(found - {None, name, ()})

    def file_of(self, name, path):
        """The file in which the last name of this path is, as seen from the file `name`; none of another crate."""
        at, rest = list(name), list(path)
        if rest[0] == "crate":
            at, rest = [], rest[1:]
        elif rest[0] in ("super", "self"):
            while rest and rest[0] in ("super", "self"):
                at = at[:-1] if rest.pop(0) == "super" else at
        elif (*at, rest[0]) not in self.texts:
            return None
        while rest and (*at, rest[0]) in self.texts:
            at.append(rest.pop(0))
        handed_on = (leaf for leaf in self.exports.get(tuple(at), []) if rest and leaf[-1] == rest[0] and leaf != path)
        return next((file for leaf in handed_on if (file := self.file_of(tuple(at), leaf))), tuple(at))


def circles(graph):
    """The sets of files each of which imports, through others, every file of its set (Tarjan)."""
    order, lowest, open_, found = {}, {}, [], []

    def visit(name):
        order[name] = lowest[name] = len(order)
        open_.append(name)
        for other in graph[name]:
            if other not in order:
                visit(other)
            if other in open_:
                lowest[name] = min(lowest[name], lowest[other])
        if lowest[name] == order[name]:
            place = open_.index(name)
            found.append(sorted(open_[place:]))
            del open_[place:]

    for name in graph:
        if name not in order:
            visit(name)
    return found


def large_circles(source):
    """The circles of too many files, of which each is named."""
    files = Files(source)
    for files_ in circles({name: files.imports(name) for name in files.texts}):
        folder = (source / files_[0][0]).relative_to(ROOT).as_posix() if files_[0] else ""
        if len(files_) > MOST_IN_CIRCLE and folder not in ONE_TYPE:
            yield f"{len(files_)} files of {folder} import in a circle: {', '.join(map('/'.join, files_))}"


def main():
    arrows = allowed()
    faults = []
    for package in packages():
        faults += wrong_crates(package, arrows)
        source = pathlib.Path(package["manifest_path"]).parent / "src"
        faults += large_circles(source)
        graph = modules(source)
        if found := circle(graph):
            steps = [f"{a} -> {b} ({graph[a][b]})" for a, b in zip(found, found[1:])]
            faults.append(f"{package['name']}: its modules import in a circle: {', '.join(steps)}")
    for fault in faults:
        print(f"arrows: {fault}", file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
