"""Compares how the checker reads each instruction of an image with LLVM's disassembler.

    compare_llvm.py <the checker's lines> <the lines of llvm-objdump -d>
"""

import re
import sys

CONDITIONS = "eq|ne|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
MEMORY = r"v?(ldr|str|ldm|stm|push|pop)|tb[bh]$"


def disassembly(path):
    """Name and operands of each instruction, by address."""
    found = {}
    for line in open(path, encoding="utf-8"):
        match = re.match(r"^ ([0-9a-f]{7,8}):\s+(\S+)\s*([^@<]*)", line)
        if match and not match[2].startswith("."):
            name = match[2].removesuffix(".w")
            found[int(match[1], 16)] = (name, match[3].strip())
    return found


def flow(name, operands):
    """Where the program goes, in the checker's words."""
    target = re.search(r"0x([0-9a-f]+)", operands)
    address = int(target[1], 16) if target else 0
    to_pc = re.split(r"[ ,]", operands)[0] == "pc"
    loads_pc = re.search(r"\bpc\b", operands) and re.match(r"pop|ldm", name)
    if name == "b":
        return f"Jump({address})"
    if re.fullmatch(rf"b({CONDITIONS})|cbn?z", name):
        return f"Branch({address})"
    if re.fullmatch(rf"bl({CONDITIONS})?", name):
        return f"Call({address})"
    if name.startswith("blx"):
        return "CallRegister"
    if loads_pc or re.match(r"bx", name) and operands == "lr":
        return "Return"
    if re.match(r"bx|ldr", name) and (to_pc or name.startswith("bx")):
        return "Computed"
    if name.startswith("mov") and to_pc:
        return "Jumps"
    if name in ("tbb", "tbh"):
        return "Table"
    if re.fullmatch(r"it[te]*", name):
        return "IfThen"
    return {"udf": "Trap", "trap": "Trap", "wfi": "Sleep", "wfe": "Sleep"}.get(name, "Next")


def stack(name, operands):
    """What happens to the stack pointer, in the checker's words."""
    registers = re.search(r"\{(.*)\}", operands)
    if registers and re.match(r"v?(push|pop)", name):
        size = 8 if re.match(r"d\d", registers[1]) else 4
        move = "Push" if "push" in name else "Pop"
        return f"{move}({size * len(registers[1].split(','))})"
    for pattern, move in ((r"\[sp, #-(\d+)\]!", "Push"), (r"\[sp\], #(\d+)", "Pop")):
        if match := re.search(pattern, operands):
            return f"{move}({match[1]})"
    if name == "msr" and operands.startswith("msp"):
        return "Restart"
    if re.match(r"sp\b", operands) and not re.match(r"cmp|cmn|tst|v?ldm|v?stm", name):
        constant = re.fullmatch(r"sp(?:, sp)?, #(\d+)", operands)
        if constant and re.match(r"add|sub", name):
            return f"{'Pop' if name.startswith('add') else 'Push'}({constant[1]})"
        return "Unknown"
    return "Unknown" if "sp!" in operands else "Keep"


def sets_flags(name, operands):
    """Whether the flags must be known to change; other instructions may be said to, too."""
    if name == "vmrs":
        return "apsr" in operands.lower()
    return bool(re.match(r"cmp|cmn|tst|teq", name))


def main():
    listing = disassembly(sys.argv[2])
    count, differences = 0, []
    for line in open(sys.argv[1], encoding="utf-8"):
        address, accesses, flags, way, effect = line.strip().split("|")
        address = int(address, 16)
        name, operands = listing.get(address, ("?", ""))
        count += 1
        expected = flow(name, operands)
        # In an if-then block LLVM shows the block's condition in a jump's name.
        goes = {expected, expected.replace("Branch", "Jump")}
        same = (
            (way in goes or way.split(" ")[0] == expected)
            and effect == stack(name, operands)
            and (flags == "true" or not sets_flags(name, operands))
            and (accesses != "0") == bool(re.match(MEMORY, name))
        )
        if not same:
            differences.append(f"{address:#x}: {name} {operands}: {line.strip()}")
    print(f"{count} instructions, {len(differences)} read differently")
    print("\n".join(differences[:20]))
    return 1 if differences or count < 1000 else 0


if __name__ == "__main__":
    sys.exit(main())
