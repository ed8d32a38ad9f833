#!/usr/bin/env python3
"""Writes the flash of an RP2350's image as UF2, which a Pico 2 takes by drag and drop (the file format of Microsoft, UF2).

  firmware/src/board/rp2350/uf2.py IMAGE.elf IMAGE.uf2
"""

import os
import struct
import sys

FLASH = range(0x1000_0000, 0x1040_0000)
# Bytes of a block, and the family of programs for the Arm cores of an RP2350.
BLOCK = 256
FAMILY = 0xE48B_FF59
FAMILY_IS_STATED = 0x2000


def segments(elf):
    """Address and bytes of each part of the file that is loaded."""
    if elf[:5] != b"\x7fELF\x01":
        sys.exit("uf2: the image is no ELF file of 32 bits: give the file that scripts/firmware.sh builds")
    (first,), (size, count) = struct.unpack_from("<I", elf, 28), struct.unpack_from("<HH", elf, 42)
    for at in range(first, first + size * count, size):
        kind, offset, _, address, length = struct.unpack_from("<5I", elf, at)
        if kind == 1 and length > 0:
            yield address, elf[offset : offset + length]


def pages(elf):
    """The pages of the flash by their addresses, filled with ones."""
    flash = {}
    for address, data in segments(elf):
        if address not in FLASH or address + len(data) > FLASH.stop:
            sys.exit(f"uf2: {address:#x} is outside the flash: the image is for another chip")
        for place, byte in enumerate(data, address):
            flash.setdefault(place - place % BLOCK, bytearray(b"\xff" * BLOCK))[place % BLOCK] = byte
    return sorted(flash.items())


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, target = sys.argv[1:]
    with open(source, "rb") as file:
        blocks = pages(file.read())
    with open(target + ".part", "wb") as file:
        for number, (address, data) in enumerate(blocks):
            head = (0x0A32_4655, 0x9E5D_5157, FAMILY_IS_STATED, address, BLOCK, number, len(blocks), FAMILY)
            file.write(struct.pack("<8I", *head) + data.ljust(476, b"\0") + struct.pack("<I", 0x0AB1_6F30))
    os.replace(target + ".part", target)


main()
