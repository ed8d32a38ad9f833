"""Seeds mistakes into a copy of the sources, one at a time, and runs tests on it. Each mistake
must be caught. firmware/mistakes.py and verify/chip/mistakes.py hold the mistakes and name the tests."""
import csv
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

# What caught a mistake that no test caught.
NOTHING = "nothing"


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


def read(table):
    """The rows of the table by the mistakes' numbers: each is what it is called, its file and what caught it."""
    if not table.exists():
        return {}
    with table.open(newline="") as text:
        return {int(number): row for number, *row in list(csv.reader(text))[1:]}


def check_texts(mistakes, path_of, table, page):
    """Ends the program if an old text does not occur exactly once in its file, if the table has not the mistakes, or the
    page not their number; or if it was called with `--check`."""
    wrong = []
    rows = read(table)
    for number, (name, file, *texts) in enumerate(mistakes, 1):
        text = (ROOT / path_of(file)).read_text()
        for old, new in zip(texts[::2], texts[1::2]):
            if text.count(old) != 1:
                wrong.append(f"{number}: {file} has {text.count(old)} times {old!r}")
            text = text.replace(old, new)
        if number in rows and rows[number][:2] != [name, file]:
            wrong.append(f"{number}: {table.name} has {rows[number]} for {name}, {file}")
    caught = sum(row[2] != NOTHING for row in rows.values())
    says = f"{len(mistakes)} mistakes are in the script; {len(rows)} were tried, and {caught} of them caught."
    if " ".join(says.split()) not in " ".join(page.read_text().split()):
        wrong.append(f"{page.name} should say: {says}")
    if sys.argv[1:] == ["--check"]:
        raise SystemExit("\n".join(wrong) or 0)
    if wrong:
        print(*wrong, sep="\n")


def check(mistakes, copy, path_of, test, table):
    """Tries mistakes: all of them, or those whose numbers are on the command line. A row of `table`, a CSV file, says which
    test caught each.

    A mistake is what it is called, its file, and pairs of old and new text; `path_of` gives the file's path below the root.
    `test` takes that path and the name of the test that caught the mistake when it was tried before, and returns the status and
    the output of that test; or without a name, those of all. Without a mistake, all tests must pass.
    """
    rows, missed = read(table), []
    numbers = [int(word) for word in sys.argv[1:]] or range(1, len(mistakes) + 1)
    for path in sorted({path_of(mistakes[number - 1][1]) for number in numbers}):
        status, output = test(path, "")
        if status != 0:
            raise SystemExit("without a mistake:\n" + output[-2000:])
    for number in numbers:
        name, file, *texts = mistakes[number - 1]
        path = copy / path_of(file)
        before = seed(path, texts)
        tests = {rows[number][2].split(" ")[0] if number in rows else "", ""}
        for near in sorted(tests - {NOTHING}, reverse=True):
            status, output = test(path_of(file), near)
            failed = sorted(set(re.findall(r"^test (\S+) \.\.\. FAILED", output, re.M)))
            if failed and "could not compile" not in output:
                break
        path.write_text(before)
        if failed and "could not compile" not in output:
            # In the tables of tests, a row's name comes before that of its image.
            found = failed[0].removeprefix("table::").split("::")
            found = found[0] if "table::" in failed[0] else found[-1]
            found += f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        else:
            found = NOTHING
            missed.append(name)
            print(output[-1500:] if status != 0 else "")
        rows[number] = [name, file, found]
        print(number, *rows[number], sep=" | ", flush=True)
        with table.open("w", newline="") as out:
            writer = csv.writer(out, lineterminator="\n")
            writer.writerow(("number", "mistake", "file", "caught_by"))
            writer.writerows([number, *row] for number, row in sorted(rows.items()))
    if missed:
        raise SystemExit(f"not caught: {', '.join(missed)}")
