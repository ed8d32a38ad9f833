#!/usr/bin/env python3
"""Runs the mutants that cargo-mutants lists, all compiled into one program: a build for each would
take days. scripts/mutants.sh installs what this needs and calls it.

In a copy of the sources, each mutated expression becomes `(if original {…} else if mutant 17 {…} …)`,
and the environment variable MUTANT chooses one when a test program starts. A first run of each
test notes which mutants it reaches; only these tests run for a mutant, until one fails.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import resource
import subprocess
import sys

import tree_sitter
import tree_sitter_rust

import seeded_mistakes

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPY = ROOT / "target/mutants-tree"
REPORT = ROOT / "target/mutants"
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))
CHAIN = ("binary_expression", "compound_assignment_expr")
# A mutant that allocates without end fails, too.
MEMORY = 4 << 30
SURVIVES = "survives"
SWITCH = """
/// Which mutant is switched on, and which were reached.
#[doc(hidden)]
pub mod mutant {
    extern crate std;
    use core::sync::atomic::{AtomicU8, AtomicU32, Ordering::Relaxed};

    const COUNT: usize = @COUNT@;
    const RECORD: u32 = u32::MAX;
    static ACTIVE: AtomicU32 = AtomicU32::new(RECORD);
    static REACHED: [AtomicU8; COUNT] = [const { AtomicU8::new(0) }; COUNT];

    unsafe extern "C" {
        fn atexit(function: extern "C" fn()) -> i32;
    }

    #[used]
    #[unsafe(link_section = ".init_array")]
    static START: extern "C" fn() = start;

    extern "C" fn start() {
        let number = std::env::var("MUTANT").ok().and_then(|text| text.parse().ok());
        ACTIVE.store(number.unwrap_or(RECORD), Relaxed);
        if number.is_none() {
            // SAFETY: the function is one of C's library and takes a function without arguments.
            unsafe { atexit(end) };
        }
    }

    extern "C" fn end() {
        if let Ok(file) = std::env::var("MUTANTS_REACHED") {
            let reached = core::array::from_fn::<u8, COUNT, _>(|i| REACHED[i].load(Relaxed));
            let _ = std::fs::write(file, reached);
        }
    }

    /// Whether this mutant is switched on.
    #[inline]
    pub fn on(mutant: u32) -> bool {
        any(mutant, mutant + 1)
    }

    /// Whether one of these mutants is switched on.
    #[inline]
    pub fn any(first: u32, end: u32) -> bool {
        let active = ACTIVE.load(Relaxed);
        if active == RECORD {
            REACHED[first as usize].store(1, Relaxed);
        }
        (first..end).contains(&active)
    }
}
"""


class Site:
    """A piece of source text with the mutants in its place, which have numbers in a row."""

    def __init__(self, start, end, kind):
        self.start, self.end, self.kind, self.mutants = start, end, kind, []


def ancestors(node):
    while node is not None:
        yield node
        node = node.parent


def find_site(tree, text, mutant):
    """The range that a mutant replaces as a whole, its kind, and the text in its place; or a word
    for why it cannot be switched on at run time."""
    start, end = mutant["start"], mutant["end"]
    node = tree.root_node.descendant_for_byte_range(start, end - 1)
    outer = list(ancestors(node))
    function = next((n for n in outer if n.type == "function_item"), None)
    if function is None or any(n.type in ("const_item", "static_item", "const_block") for n in outer):
        return "constant"
    modifiers = next((c for c in function.children if c.type == "function_modifiers"), None)
    if modifiers is not None and b"const" in modifiers.text:
        return "constant"

    def replaced(piece):
        return text[piece.start_byte : start] + mutant["replacement"].encode() + text[end : piece.end_byte]

    genre = mutant["genre"]
    if genre == "BinaryOperator":
        chain = next((n for n in outer if n.type in CHAIN), None)
        while chain is not None and chain.parent.type in CHAIN:
            chain = chain.parent
        if chain is None:
            return "not found"
        return chain.start_byte, chain.end_byte, "expression", replaced(chain)
    if genre == "UnaryOperator":
        unary = next(n for n in outer if n.type == "unary_expression")
        if unary.start_byte != start:
            return "not found"
        return unary.start_byte, unary.end_byte, "expression", replaced(unary)
    if genre == "StructField":
        struct = next(n for n in outer if n.type == "struct_expression")
        return struct.start_byte, struct.end_byte, "expression", replaced(struct)
    if genre == "MatchArmGuard":
        return start, end, "expression", mutant["replacement"].encode()
    if genre == "MatchArm":
        pattern = next(n for n in outer if n.type == "match_arm").child_by_field_name("pattern")
        return pattern.start_byte, pattern.end_byte, "arm", b""
    if genre == "FnValue":
        body = function.child_by_field_name("body")
        return body.start_byte, body.end_byte, "body", mutant["replacement"].encode()
    return "not found"


def marked(mutant):
    number = mutant["number"]
    return b"/*<%d>*/ %s /*</%d>*/" % (number, mutant["text"], number)


def render(text, start, end, sites, left_out):
    """The text with its sites made switchable. What replaces a site is taken as it was written, so
    a site inside another one is in the other's original only."""
    out, position = b"", start
    while sites:
        site = sites[0]
        inside = [s for s in sites[1:] if s.end <= site.end]
        sites = sites[1 + len(inside) :]
        original = render(text, site.start, site.end, inside, left_out)
        mutants = [m for m in site.mutants if m["number"] not in left_out]
        out += text[position : site.start] + (switched(site, original, mutants) if mutants else original)
        position = site.end
    return out + text[position:end]


def switched(site, original, mutants):
    if site.kind == "expression":
        numbers = (site.mutants[0]["number"], site.mutants[-1]["number"] + 1)
        out = b"(if !crate::mutant::any(%d, %d) { %s\n}" % (*numbers, original)
        for m in mutants[:-1]:
            out += b" else if crate::mutant::on(%d) { %s\n}" % (m["number"], marked(m))
        return out + b" else { %s\n})" % marked(mutants[-1])
    if site.kind == "body":
        for m in mutants:
            original = b"{\nif crate::mutant::on(%d) { return %s; }" % (m["number"], marked(m)) + original[1:]
        return original
    # An arm that is deleted has a condition that does not hold.
    pattern, *condition = re.split(rb"\sif\s", original, maxsplit=1)
    left = b"%s if !crate::mutant::on(%d)" % (pattern, mutants[0]["number"])
    return left + b"".join(b" && (%s)" % text for text in condition)


def offset(text, place):
    """The byte offset of a line and column that count characters from one."""
    lines = text.split(b"\n")
    line = lines[place["line"] - 1].decode()
    before = sum(len(line) + 1 for line in lines[: place["line"] - 1])
    return before + len(line[: place["column"] - 1].encode())


def list_mutants(package, files):
    words = [word for file in files for word in ("--file", file)]
    listed = seeded_mistakes.run("cargo", "mutants", "--list", "--json", "--package", package, *words, cwd=ROOT)
    if listed.returncode != 0:
        raise SystemExit(listed.stderr)
    return json.loads(listed.stdout)


def find_sites(mutants):
    """The sites by file. Numbers the mutants; those that cannot be switched get the reason."""
    by_file = collections.defaultdict(dict)
    trees = {}
    for mutant in mutants:
        file = mutant["file"]
        if file not in trees:
            text = (ROOT / file).read_bytes()
            trees[file] = text, PARSER.parse(text)
        text, tree = trees[file]
        mutant["start"], mutant["end"] = (offset(text, mutant["span"][side]) for side in ("start", "end"))
        found = find_site(tree, text, mutant)
        if isinstance(found, str):
            mutant["outcome"] = found
        else:
            *place, mutant["text"] = found
            by_file[file].setdefault(tuple(place), Site(*place)).mutants.append(mutant)
    number = 0
    for file, sites in by_file.items():
        by_file[file] = sorted(sites.values(), key=lambda s: (s.start, -s.end, s.kind != "body"))
        for site in by_file[file]:
            for mutant in site.mutants:
                mutant["number"], mutant["site"] = number, site.mutants[0]
                number += 1
    return by_file, number


def write(path, text):
    if not path.exists() or path.read_bytes() != text:
        path.write_bytes(text)


def write_sources(crate, by_file, count, left_out):
    for file, sites in by_file.items():
        text = (ROOT / file).read_bytes()
        write(COPY / file, render(text, 0, len(text), sites, left_out))
    lib = f"{crate}/src/lib.rs"
    write(COPY / lib, (ROOT / lib).read_bytes() + SWITCH.replace("@COUNT@", str(count)).encode())


def build(package):
    """Builds the tests; their programs, and the errors as file and byte offset."""
    flags = {**os.environ, "RUSTFLAGS": "--cap-lints=allow", "CARGO_INCREMENTAL": "1"}
    flags.pop("CARGO_TARGET_DIR", None)
    command = ["cargo", "test", "--no-run", "--package", package, "--lib", "--tests", "--message-format=json"]
    done = seeded_mistakes.run(*command, cwd=COPY, env=flags)
    programs, errors = [], []
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message["reason"] == "compiler-artifact" and message.get("executable"):
            programs.append(message["executable"])
        if message["reason"] == "compiler-message" and message["message"]["level"] == "error":
            errors.append(message["message"])
    if done.returncode != 0 and not errors:
        raise SystemExit(done.stderr[-3000:])
    return programs, errors


def blamed(errors):
    """The mutants in whose text the compiler reports an error."""
    numbers, elsewhere = set(), []
    for error in errors:
        found = set()
        places = [span for span in error["spans"] if span["is_primary"]] + error["spans"]
        places += [span for child in error["children"] for span in child["spans"]]
        for span in places:
            while span and not str(COPY / span["file_name"]).startswith(str(COPY)):
                span = span["expansion"] and span["expansion"]["span"]
            path = COPY / span["file_name"]
            if not path.is_file():
                continue
            text = path.read_bytes()
            before = list(re.finditer(rb"/\*<(\d+)>\*/", text[: span["byte_end"]]))
            if before:
                number = int(before[-1][1])
                if text.index(b"/*</%d>*/" % number) >= span["byte_start"]:
                    found.add(number)
                    break
        numbers |= found
        if not found and error["spans"]:
            elsewhere.append(error["rendered"])
    return numbers, elsewhere


class Test:
    """A test, the mutants' expressions that it reaches, and the seconds that it takes."""

    def __init__(self, program, name):
        self.program, self.name, self.kills = program, name, 0
        self.label = re.sub(r"-[0-9a-f]{16}$", "", pathlib.Path(program).name) + "::" + name

    def run(self, limit, **variables):
        def limits():
            os.nice(19)
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

        environment = {
            **os.environ,
            "PROPTEST_MAX_SHRINK_ITERS": "0",
            "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "1",
            "RUST_BACKTRACE": "0",
            "RUST_TEST_THREADS": "1",
            **variables,
        }
        try:
            return subprocess.run(
                [self.program, "--exact", self.name],
                cwd=COPY / self.folder,
                env=environment,
                preexec_fn=limits,
                capture_output=True,
                timeout=40 * limit,
            ).returncode
        except subprocess.TimeoutExpired:
            return "timeout"


def record(programs, folder):
    tests = []
    for program in programs:
        listing = seeded_mistakes.run(program, "--list", "--format", "terse").stdout
        for name in re.findall(r"^(.*): test$", listing, re.M):
            test = Test(program, name)
            test.folder = folder
            file = REPORT / "reached"
            file.write_bytes(b"")
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            status = test.run(600, MUTANTS_REACHED=str(file))
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            test.seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            if status != 0:
                raise SystemExit(f"{test.label} fails without a mutant")
            test.reached = file.read_bytes()
            tests.append(test)
    return sorted(tests, key=lambda test: test.seconds)


def judge(mutant, tests):
    """What a mutant comes to: the label of the first test that it fails, or "survives"."""
    able = [test for test in tests if test.reached and test.reached[mutant["site"]["number"]]]
    # What is quick comes first, and what has caught others.
    for test in sorted(able, key=lambda test: test.seconds / (1 + test.kills)):
        status = test.run(int(3 * test.seconds) + 3, MUTANT=str(mutant["number"]))
        if status == "timeout":
            return "no verdict: " + test.label
        if status != 0:
            test.kills += 1
            return test.label
    return SURVIVES


def run_crate(crate, files, options):
    package = f"fivebar-{crate}"
    mutants = list_mutants(package, files)
    by_file, count = find_sites(mutants)
    left_out = set()
    while True:
        write_sources(crate, by_file, count, left_out)
        programs, errors = build(package)
        if not errors:
            break
        numbers, elsewhere = blamed(errors)
        if not numbers:
            raise SystemExit("errors outside the mutants:\n" + "\n".join(elsewhere[:5]))
        print(f"{package}: {len(numbers)} mutants do not compile", flush=True)
        left_out |= numbers
    tests = record(programs, crate)
    print(f"{package}: {len(tests)} tests, {sum(test.seconds for test in tests):.0f} s", flush=True)
    runnable = []
    for mutant in mutants:
        if mutant.get("number") in left_out:
            mutant["outcome"] = "does not compile"
        elif "number" in mutant and re.search(options.only or "", mutant["name"]):
            runnable.append(mutant)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for mutant, outcome in zip(runnable, pool.map(lambda m: judge(m, tests), runnable)):
            mutant["outcome"] = outcome
            if outcome == SURVIVES:
                print("survives:", mutant["name"], flush=True)
    return [{key: m[key] for key in ("name", "file", "outcome") if key in m} for m in mutants]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--jobs", type=int, default=1)
    options.add_argument("--only", help="runs mutants whose names match this pattern")
    options.add_argument("files", nargs="+")
    options = options.parse_args()
    seeded_mistakes.copy_sources(COPY)
    REPORT.mkdir(parents=True, exist_ok=True)
    report = []
    for crate in ("firmware", "kinematics"):
        files = [file for file in options.files if file.startswith(crate + "/")]
        if files:
            report += run_crate(crate, files, options)
            (REPORT / "outcomes.json").write_text(json.dumps(report, indent=1))
    return summarise(report)


def summarise(report):
    """Prints what each folder comes to; fails if scripts/mutants.txt does not justify a survivor."""
    # A line of the list justifies one survivor, so that it does not hide another one in the same
    # function. Names are without line and column, which change with every edit.
    justified = collections.Counter(
        line.split(" | ")[0] for line in (ROOT / "scripts/mutants.txt").read_text().splitlines()
    )
    rows, open_ones = collections.defaultdict(collections.Counter), []
    for mutant in report:
        outcome = mutant.get("outcome", "not run")
        if outcome == SURVIVES:
            name = re.sub(r":\d+:\d+:", ":", mutant["name"], count=1)
            if justified[name] > 0:
                justified[name] -= 1
                outcome = "justified"
            else:
                open_ones.append(mutant["name"])
        elif "::" in outcome and not outcome.startswith("no verdict"):
            outcome = "caught"
        elif outcome != "does not compile":
            outcome = "not run"
        rows["/".join(mutant["file"].split("/")[:3])][outcome] += 1
    print("| folder | mutants | do not compile | not run | caught | justified | survive | score |")
    print("|---|---|---|---|---|---|---|---|")
    for folder, n in rows.items():
        tried = n["caught"] + n["justified"] + n[SURVIVES]
        score = f"{100 * n['caught'] / tried:.1f} %" if tried else "–"
        columns = [n[key] for key in ("does not compile", "not run", "caught", "justified", SURVIVES)]
        print(f"| `{folder}` |", " | ".join(map(str, [sum(n.values()), *columns, score])), "|")
    for name in open_ones:
        print("survives, and scripts/mutants.txt does not justify it:", name, file=sys.stderr)
    return 1 if open_ones else 0


if __name__ == "__main__":
    sys.exit(main())
