#!/usr/bin/env python3
"""Runs the mutants that cargo-mutants lists, all compiled into one program (switchable.py): a build
for each would take days. scripts/mutants.sh installs what this needs and calls it.

A first run of each test notes which mutants it reaches. Only these tests run for a mutant, until
one fails. Mutants in constants cannot be switched at run time and are built one at a time.
"""
import argparse
import collections
import concurrent.futures
import importlib.util
import json
import os
import pathlib
import re
import resource
import subprocess
import sys

import seeded_mistakes
import switchable
from switchable import CONSTANT, COPY, ROOT

REPORT = seeded_mistakes.BUILT / "mutants"
# A mutant that allocates without end fails, too.
MEMORY = 4 << 30
SURVIVES = "survives"
TIMEOUT = "no verdict in time"


class Test:
    """A test, the mutants that it reaches, and the processor's seconds that it takes."""

    def __init__(self, program, name, folder):
        self.program, self.name, self.folder, self.kills = program, name, folder, 0
        self.reached, self.seconds = b"", 0.0
        self.label = re.sub(r"-[0-9a-f]{16}$", "", pathlib.Path(program).name) + "::" + name

    def run(self, seconds, **variables):
        """The exit status within these seconds of the processor, which a busy machine does not
        shorten."""

        def limits():
            os.nice(5)
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

        environment = {
            **os.environ,
            "PROPTEST_MAX_SHRINK_ITERS": "0",
            "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "1",
            "RUST_BACKTRACE": "0",
            "RUST_TEST_THREADS": "1",
            **variables,
        }
        command = [self.program, "--exact", self.name]
        options = {"cwd": COPY / self.folder, "env": environment, "preexec_fn": limits}
        try:
            return subprocess.run(command, capture_output=True, timeout=40 * seconds, **options).returncode
        except subprocess.TimeoutExpired:
            return TIMEOUT

    def record(self):
        """Runs without a mutant, and notes which ones are reached."""
        file = REPORT / "reached"
        file.write_bytes(b"")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        if self.run(600, MUTANTS_REACHED=str(file)) != 0:
            raise SystemExit(f"{self.label} fails without a mutant")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.reached = file.read_bytes()


def tests_of(programs, folder):
    for program in programs:
        listing = seeded_mistakes.run(program, "--list", "--format", "terse").stdout
        for name in re.findall(r"^(.*): test$", listing, re.M):
            yield Test(program, name, folder)


def judge(mutant, tests):
    """What a mutant comes to: the label of the first test that it fails, or that it survives."""
    noted = mutant.get("noted_as")
    able = [test for test in tests if noted is None or any(test.reached[n : n + 1] == b"\1" for n in noted)]
    # What is quick comes first, and what has caught others.
    for test in sorted(able, key=lambda test: test.seconds / (1 + test.kills)):
        variables = {"MUTANT": str(mutant["number"])} if noted else {}
        status = test.run(int(3 * test.seconds) + 3, **variables)
        if status == TIMEOUT:
            return TIMEOUT
        if status != 0:
            test.kills += 1
            return test.label
    return SURVIVES


def judge_constant(mutant, source, crate, tests):
    """Builds one mutant in the place of its file."""
    switchable.write(mutant["file"], switchable.changed(source.text, mutant["changes"]))
    _, errors = switchable.build(crate)
    return "does not compile" if errors else judge(mutant, tests)


def list_mutants(crate, files):
    words = [word for file in files for word in ("--file", file)]
    command = ["cargo", "mutants", "--list", "--json", "--package", switchable.package_of(crate), *words]
    listed = seeded_mistakes.run(*command, cwd=ROOT)
    if listed.returncode != 0:
        raise SystemExit(listed.stderr)
    mutants = json.loads(listed.stdout)
    return sorted(mutants, key=lambda m: (m["file"], *(m["span"]["start"][key] for key in ("line", "column"))))


def list_mistakes():
    """Those of firmware/mistakes.py in the controller, as mutants."""
    spec = importlib.util.spec_from_file_location("mistakes", ROOT / "firmware/mistakes.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return [
        {"name": f"{number}: {name}", "file": module.path_of(file), "texts": texts}
        for number, (name, file, *texts) in enumerate(module.MISTAKES, 1)
        if module.path_of(file).startswith("firmware/")
    ]


def run_crate(crate, mutants, place, options):
    package = switchable.package_of(crate)
    programs, sources = switchable.compile_all(crate, mutants, place)
    tests = list(tests_of(programs, crate))
    for test in tests:
        test.record()
    print(f"{package}: {len(tests)} tests, {sum(test.seconds for test in tests):.0f} s", flush=True)

    def run(mutant):
        if "outcome" not in mutant and re.search(options.only, mutant["name"]):
            mutant["outcome"] = judge(mutant, tests)
            if mutant["outcome"] == SURVIVES:
                print("survives:", mutant["name"], flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(run, mutants))
    for mutant in mutants:
        if options.constants and mutant.get("outcome") == CONSTANT and re.search(options.only, mutant["name"]):
            switched_file = (COPY / mutant["file"]).read_bytes()
            mutant["outcome"] = judge_constant(mutant, sources[mutant["file"]], crate, tests)
            switchable.write(mutant["file"], switched_file)
            print(f"{mutant['outcome']}: {mutant['name']}", flush=True)
    return [{key: m.get(key, "not run") for key in ("name", "file", "outcome")} for m in mutants]


def summarise(report):
    """Prints what each folder comes to; the survivors that scripts/mutants.txt does not justify."""
    # A line of the list justifies one survivor, so that it does not hide another one in the same
    # function. Names are without line and column, which change with every edit.
    lines = (ROOT / "scripts/mutants.txt").read_text().splitlines()
    justified = collections.Counter(line.rsplit(" | ", 1)[0] for line in lines)
    rows, unjustified = collections.defaultdict(collections.Counter), []
    for mutant in report:
        outcome = mutant["outcome"]
        if outcome == SURVIVES:
            name = re.sub(r":\d+:\d+:", ":", mutant["name"], count=1)
            if justified[name] > 0:
                justified[name] -= 1
                outcome = "justified"
            else:
                unjustified.append(mutant["name"])
        elif "::" in outcome:
            outcome = "caught"
        elif outcome != "does not compile":
            outcome = "not run"
        rows["/".join(mutant["file"].split("/")[:3])][outcome] += 1
    rows["all"] = sum(rows.values(), collections.Counter())
    print("| folder | mutants | do not compile | not run | caught | justified | survive | score |")
    print("|---|---|---|---|---|---|---|---|")
    for folder, n in rows.items():
        tried = n["caught"] + n["justified"] + n[SURVIVES]
        score = f"{100 * n['caught'] / tried:.1f} %" if tried else "–"
        columns = [n[key] for key in ("does not compile", "not run", "caught", "justified", SURVIVES)]
        print(f"| `{folder}` |", " | ".join(map(str, [sum(n.values()), *columns, score])), "|")
    return unjustified


def main():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--jobs", type=int, default=1, help="tests that run at the same time")
    options.add_argument("--only", default="", help="runs mutants whose names match this pattern")
    options.add_argument("--constants", action="store_true", help="also those that need a build each")
    options.add_argument("--mistakes", action="store_true", help="those of firmware/mistakes.py instead")
    options.add_argument("files", nargs="*", help="files and patterns")
    options = options.parse_args()
    seeded_mistakes.copy_sources(COPY)
    REPORT.mkdir(parents=True, exist_ok=True)
    report = []
    if options.mistakes:
        report = run_crate("firmware", list_mistakes(), switchable.place_mistake, options)
        for mutant in report:
            print(f"{mutant['name']} | {mutant['outcome']}")
    for crate in switchable.CRATES:
        files = [file for file in options.files if file.startswith(crate + "/")]
        if files:
            report += run_crate(crate, list_mutants(crate, files), switchable.place_listed, options)
    (REPORT / "outcomes.json").write_text(json.dumps(report, indent=1))
    for name in (unjustified := summarise(report)):
        print("mutants: survives, and scripts/mutants.txt does not justify it:", name, file=sys.stderr)
    return 1 if unjustified else 0


if __name__ == "__main__":
    sys.exit(main())
