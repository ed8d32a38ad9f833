"""Compiles all mutants of a crate into one program, for scripts/mutants.py.

In a copy of the sources, a mutated expression becomes `(if original {…} else if mutant 17 {…} …)`,
and a mutated function begins with `if mutant 17 { return …; }`. The environment variable MUTANT
chooses a mutant when a test program starts. Without it, no mutant is on, and the program writes to
the file MUTANTS_REACHED which ones its run reached.
"""
import collections
import json
import re

import tree_sitter
import tree_sitter_rust

import seeded_mistakes

ROOT = seeded_mistakes.ROOT
COPY = seeded_mistakes.BUILT / "mutants-tree"
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))
CHAIN = ("binary_expression", "compound_assignment_expr")
CONSTANT = "constant"
# The crates by their folders, with the tests that run for their mutants. Those of the program with connections
# take minutes, and wait for real time.
CRATES = {
    "firmware": ["--lib", "--tests"],
    "kinematics": ["--lib", "--tests"],
    "host/fivebar": ["--lib"],
}
SWITCH = """
/// Which mutant is switched on, and which were reached.
#[doc(hidden)]
#[allow(unsafe_code)]
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
            // SAFETY: a function of C's library that takes a function without arguments.
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
    """A piece of source text with the mutants in its place, each with its text."""

    def __init__(self, start, end, kind):
        self.start, self.end, self.kind, self.mutants = start, end, kind, []


def ancestors(node):
    while node is not None:
        yield node
        node = node.parent


class Source:
    """A file with its tree and the sites found in it."""

    def __init__(self, file):
        self.file, self.text = file, (ROOT / file).read_bytes()
        self.tree = PARSER.parse(self.text)
        self.line_starts = [0, *(match.end() for match in re.finditer(b"\n", self.text))]
        self.sites = {}

    def offset(self, place):
        """The byte of a line and column that count characters from one."""
        start = self.line_starts[place["line"] - 1]
        line = self.text[start:].split(b"\n", 1)[0].decode()
        return start + len(line[: place["column"] - 1].encode())

    def around(self, start, end):
        """The nodes around a range, from the inside, and the function; none in a constant."""
        outer = list(ancestors(self.tree.root_node.descendant_for_byte_range(start, end - 1)))
        function = next((node for node in outer if node.type == "function_item"), None)
        if any(node.type in ("const_item", "static_item", "const_block") for node in outer):
            function = None
        return outer, function

    def function_name(self, function):
        return function.child_by_field_name("name").text.decode()

    def add(self, mutant, place, text):
        site = self.sites.setdefault(place, Site(*place))
        site.mutants.append((mutant, text))

    def make_switchable_function(self, function):
        """A constant function cannot read which mutant is on, so in the copy it is none."""
        modifiers = next((c for c in function.children if c.type == "function_modifiers"), None)
        const = modifiers and re.search(rb"\bconst\b", modifiers.text)
        if const:
            start = modifiers.start_byte + const.start()
            place = (start, start + len(b"const"), "const")
            self.sites.setdefault(place, Site(*place))


def place_listed(source, mutant, constant_functions):
    """Finds the site of a mutant that cargo-mutants lists; none if it cannot compile."""
    start, end = (source.offset(mutant["span"][side]) for side in ("start", "end"))
    mutant["changes"] = [(start, end, mutant["replacement"].encode())]
    outer, function = source.around(start, end)
    if function is None or source.function_name(function) in constant_functions:
        return False
    wanted = {
        "BinaryOperator": CHAIN,
        "UnaryOperator": ("unary_expression",),
        "StructField": ("struct_expression",),
        "MatchArm": ("match_arm",),
    }
    kind, node = "expression", next((n for n in outer if n.type in wanted.get(mutant["genre"], ())), None)
    if mutant["genre"] == "FnValue":
        kind, node = "body", function.child_by_field_name("body")
    elif mutant["genre"] == "MatchArm":
        # cargo-mutants takes `_ if …` for an arm that takes what is left.
        if not any(arm.child_by_field_name("pattern").text == b"_" for arm in node.parent.named_children):
            return None
        kind, node = "arm", node.child_by_field_name("pattern")
    elif mutant["genre"] == "MatchArmGuard":
        node = outer[0]
    if node is None:
        return False  # In a chain of conditions with `let`.
    # As in the plain text, an operator can change what the others of its chain bind.
    while node.type in CHAIN and node.parent.type in CHAIN:
        node = node.parent
    text = source.text
    if mutant["genre"] in ("FnValue", "MatchArmGuard"):
        new = mutant["replacement"].encode()
    else:
        new = text[node.start_byte : start] + mutant["replacement"].encode() + text[end : node.end_byte]
    first, last = (start, end) if mutant["genre"] == "MatchArmGuard" else (node.start_byte, node.end_byte)
    source.add(mutant, (first, last, kind), new)
    source.make_switchable_function(function)
    return True


def place_mistake(source, mutant, constant_functions):
    """Finds the functions that a seeded mistake changes: pairs of old and new text."""
    by_function, functions = collections.defaultdict(list), {}
    mutant["changes"] = []
    for old, new in zip(mutant["texts"][::2], mutant["texts"][1::2]):
        start = source.text.index(old.encode())
        mutant["changes"].append((start, start + len(old.encode()), new.encode()))
        outer, function = source.around(start, start + len(old.encode()))
        if function is None or source.function_name(function) in constant_functions:
            return False
        body = function.child_by_field_name("body")
        if start < body.start_byte:
            return False
        functions[body.start_byte, body.end_byte] = function
        by_function[body.start_byte, body.end_byte].append(mutant["changes"][-1])
    for (start, end), changes in by_function.items():
        source.add(mutant, (start, end, "body"), changed(source.text, changes, start, end))
        source.make_switchable_function(functions[start, end])
    return True


def changed(text, changes, start=0, end=None):
    """A range of the text with changes: starts, ends and new texts."""
    out, position = b"", start
    for first, last, new in sorted(changes):
        out += text[position:first] + new
        position = last
    return out + text[position:end]


def number_mutants(sources):
    """Numbers in a row within a site, so that a range of numbers is one comparison."""
    number = 0
    for source in sources.values():
        source.order = sorted(source.sites.values(), key=lambda s: (s.start, -s.end, s.kind != "body"))
        for site in source.order:
            for mutant, _ in site.mutants:
                if "number" not in mutant:
                    mutant["number"], number = number, number + 1
                noted = site.mutants[0][0] if site.kind == "expression" else mutant
                mutant.setdefault("noted_as", []).append(noted["number"])
    return number


def marked(mutant, text):
    number = mutant["number"]
    return b"/*<%d>*/ %s /*</%d>*/" % (number, text, number)


def render(text, start, end, sites, left_out):
    """The text with its sites made switchable. What replaces a site is taken as it was written, so
    a site inside another one is in the other's original only."""
    out, position = b"", start
    while sites:
        site = sites[0]
        inside = [s for s in sites[1:] if s.end <= site.end]
        sites = sites[1 + len(inside) :]
        original = render(text, site.start, site.end, inside, left_out)
        mutants = [(m, new) for m, new in site.mutants if m["number"] not in left_out]
        out += text[position : site.start]
        if site.kind != "const":
            out += switched(site, original, mutants) if mutants else original
        position = site.end
    return out + text[position:end]


def switched(site, original, mutants):
    if site.kind == "expression":
        numbers = (site.mutants[0][0]["number"], site.mutants[-1][0]["number"] + 1)
        out = b"(if !crate::mutant::any(%d, %d) { %s\n}" % (*numbers, original)
        for m, new in mutants[:-1]:
            out += b" else if crate::mutant::on(%d) { %s\n}" % (m["number"], marked(m, new))
        return out + b" else { %s\n})" % marked(*mutants[-1])
    if site.kind == "body":
        for m, new in mutants:
            original = b"{\nif crate::mutant::on(%d) { return %s; }" % (m["number"], marked(m, new)) + original[1:]
        return original
    # An arm that is deleted has a condition that does not hold.
    pattern, *condition = re.split(rb"\sif\s", original, maxsplit=1)
    left = b"%s if !crate::mutant::on(%d)" % (pattern, mutants[0][0]["number"])
    return left + b"".join(b" && (%s)" % text for text in condition)


def write(file, text):
    path = COPY / file
    if not path.exists() or path.read_bytes() != text:
        path.write_bytes(text)


def write_sources(crate, sources, count, left_out):
    for source in sources.values():
        write(source.file, render(source.text, 0, len(source.text), source.order, left_out))
    lib = f"{crate}/src/lib.rs"
    write(lib, (ROOT / lib).read_bytes() + SWITCH.replace("@COUNT@", str(count)).encode())


def package_of(crate):
    return {"host/fivebar": "fivebar"}.get(crate, f"fivebar-{crate}")


def build(crate):
    """Builds the tests; gives their programs and the compiler's errors."""
    environment = seeded_mistakes.without_target_dir(RUSTFLAGS="--cap-lints=allow", CARGO_INCREMENTAL="1")
    command = ["cargo", "test", "--no-run", "--package", package_of(crate), *CRATES[crate], "--message-format=json"]
    done = seeded_mistakes.run(*command, cwd=COPY, env=environment)
    programs, errors = [], []
    for message in map(json.loads, done.stdout.splitlines()):
        if message["reason"] == "compiler-artifact" and message.get("executable"):
            programs.append(message["executable"])
        if message["reason"] == "compiler-message" and message["message"]["level"] == "error":
            errors.append(message["message"])
    if done.returncode != 0 and not errors:
        raise SystemExit(done.stderr[-3000:])
    return programs, errors


def blamed(error):
    """The mutant in whose text the compiler reports an error."""
    spans = [span for span in error["spans"] if span["is_primary"]] + error["spans"]
    spans += [span for child in error["children"] for span in child["spans"]]
    for span in spans:
        path = COPY / span["file_name"]
        text = path.read_bytes() if path.is_file() else b""
        before = list(re.finditer(rb"/\*<(\d+)>\*/", text[: span["byte_end"]]))
        if before and text.index(b"/*</%b>*/" % before[-1][1]) >= span["byte_start"]:
            return int(before[-1][1])
    return None


def compile_all(crate, mutants, place):
    """Builds the program of all mutants that can be switched. The others get their outcome:
    `CONSTANT`, or that they do not compile. Gives the test programs and the sources."""
    constant_functions, left_out = set(), set()
    while True:
        sources = {mutant["file"]: Source(mutant["file"]) for mutant in mutants}
        for mutant in mutants:
            for key in ("number", "noted_as", "outcome"):
                mutant.pop(key, None)
            placed = place(sources[mutant["file"]], mutant, constant_functions)
            if not placed:
                mutant["outcome"] = CONSTANT if placed is False else "does not compile"
        count = number_mutants(sources)
        calls = None
        while not calls:
            write_sources(crate, sources, count, left_out)
            programs, errors = build(crate)
            if not errors:
                for mutant in mutants:
                    if mutant.get("number") in left_out:
                        mutant["outcome"] = "does not compile"
                return programs, sources
            calls = {
                re.search(r"function `([^`]*)`", error["message"])[1].split("::")[-1]
                for error in errors
                if (error["code"] or {}).get("code") == "E0015"
            }
            numbers = {blamed(error) for error in errors} - {None}
            if not calls and not numbers - left_out:
                raise SystemExit("errors outside the mutants:\n" + errors[0]["rendered"])
            left_out |= numbers
        # These are called in constants, so they stay constant, and the numbers change.
        constant_functions |= calls
        left_out = set()
