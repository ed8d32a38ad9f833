#!/usr/bin/env python3
"""Fails if a document links to a file or a heading that does not exist, if a text names a document of docs/
that does not exist, if CONTRIBUTING.md names a file that does not exist, or if docs/SUMMARY.md or docs/README.md
leaves a document out."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def listed(*patterns):
    output = subprocess.check_output(["git", "ls-files", "-z", *patterns], cwd=ROOT, text=True)
    return [ROOT / name for name in output.split("\0") if name and (ROOT / name).is_file()]


def without_code(text):
    return re.sub(r"^ *```.*?^ *```", "", text, flags=re.DOTALL | re.MULTILINE)


def anchors(document):
    """The names that GitHub and mdBook give to the headings of a document."""
    headings = re.findall(r"^#+ +(.*)$", without_code(document.read_text()), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def main():
    wrong = []
    for document in listed("*.md"):
        text = without_code(document.read_text())
        for target in re.findall(r"\]\(([^()\s]+)\)", text):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            aim = (document.parent / path).resolve() if path else document
            if not aim.exists():
                wrong.append(f"{document.relative_to(ROOT)}: no file {target}")
            elif anchor and anchor not in anchors(aim):
                wrong.append(f"{document.relative_to(ROOT)}: no heading {target}")
    for source in listed("*.md", "*.rs", "*.py", "*.sh", "*.js", "*.toml", "*.txt"):
        for name in re.findall(r"\bdocs/[\w/.-]+\.(?:md|svg|png)\b", source.read_text()):
            if not (ROOT / name).exists():
                wrong.append(f"{source.relative_to(ROOT)}: no document {name}")
    for name in re.findall(r"`([\w.-]+/[\w/.-]+)`", (ROOT / "CONTRIBUTING.md").read_text()):
        if not (ROOT / name).exists():
            wrong.append(f"CONTRIBUTING.md: no file {name}")
    for index in ("docs/SUMMARY.md", "docs/README.md"):
        text = (ROOT / index).read_text()
        for document in listed("docs/*/*.md"):
            if f"({document.relative_to(ROOT / 'docs')})" not in text:
                wrong.append(f"{index}: {document.relative_to(ROOT)} is missing")
    if wrong:
        sys.exit("links: " + "\nlinks: ".join(wrong))


main()
