"""Seeds mistakes into a copy of the sources, one at a time, and runs tests on it. Each mistake
must be caught. firmware/mistakes.py and verify/chip/mistakes.py hold the mistakes and name the tests."""
import filecmp
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Where cargo builds.
BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").absolute()


def without_target_dir(**variables):
    """This process's environment for a cargo that compiles a copy. The copy has a target folder of its own: in
    a shared one, cargo takes what was compiled from the copy for what was compiled from here."""
    return {**{key: value for key, value in os.environ.items() if key != "CARGO_TARGET_DIR"}, **variables}


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, **options)


def copy_sources(copy):
    """Brings the copy up to date with the files that git lists or would add."""
    listed = run("git", "ls-files", "--cached", "--others", "--exclude-standard", cwd=ROOT).stdout
    for file in filter(None, listed.split("\n")):
        source, target = ROOT / file, copy / file
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_symlink():
            target.unlink(missing_ok=True)
            target.symlink_to(source.readlink())
            continue
        # A copy gets the present time: with an old one, cargo would not see that it replaces a
        # file in which a mistake was seeded and compiled.
        if source.exists() and not (target.exists() and filecmp.cmp(source, target, shallow=False)):
            shutil.copy(source, target)


def seed(path, texts):
    """Puts the mistake in, given by pairs of old and new text; the text before."""
    before = text = path.read_text()
    for old, new in zip(texts[::2], texts[1::2]):
        text = text.replace(old, new)
    path.write_text(text)
    return before


def check_texts(mistakes, path_of):
    """Ends the program if an old text does not occur exactly once in its file, or if it was
    called with `--check`."""
    wrong = []
    for number, (_, file, *texts) in enumerate(mistakes, 1):
        text = (ROOT / path_of(file)).read_text()
        for old, new in zip(texts[::2], texts[1::2]):
            if text.count(old) != 1:
                wrong.append(f"{number}: {file} has {text.count(old)} times {old!r}")
            text = text.replace(old, new)
    if wrong or sys.argv[1:] == ["--check"]:
        raise SystemExit("\n".join(wrong) or 0)


def check(mistakes, copy, path_of, test, table, head):
    """Runs `test`, which returns its status and output, without a mistake and then with each:
    all of `mistakes`, or those whose numbers are on the command line.

    A mistake is what it is called, its file, and pairs of old and new text; `path_of` gives the
    file's path below the root. A run of all writes the file `table`, below `head`.
    """
    status, output = test()
    if status != 0:
        raise SystemExit("without a mistake:\n" + output[-2000:])
    rows, missed = [], []
    for number in [int(word) for word in sys.argv[1:]] or range(1, len(mistakes) + 1):
        name, file, *texts = mistakes[number - 1]
        path = copy / path_of(file)
        before = seed(path, texts)
        status, output = test()
        path.write_text(before)
        failed = sorted(set(re.findall(r"^test (\S+) \.\.\. FAILED", output, re.M)))
        if failed and "could not compile" not in output:
            found = f"`{failed[0].split('::')[-1]}`"
            found += f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        else:
            found = "nothing"
            missed.append(name)
            print(output[-1500:] if status != 0 else "")
        rows.append(f"| {number} | {name} | `{file}` | {found} |")
        print(rows[-1], flush=True)
    if not sys.argv[1:]:
        rows = ["| # | mistake | in | caught by |", "|---|---|---|---|", *rows]
        table.write_text(head + "\n".join(rows) + "\n")
    if missed:
        raise SystemExit(f"not caught: {', '.join(missed)}")
