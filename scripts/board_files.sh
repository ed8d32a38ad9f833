#!/usr/bin/env bash
# Lists the files that name the second board, outside its own folders, documents and lock files apart: what another board touches.
# Fails if they are more than CONTRIBUTING.md says, or fewer.
#
#   scripts/board_files.sh
set -euo pipefail
cd "$(dirname "$0")/.."

# Not counted: its folder and its simulation, documents, lock files, this list, mistakes that are seeded into it, the targets of the
# crate kinematics, which needs no board, and the context of a patch.
mapfile -t files < <(git grep --untracked -lIiE 'rp2350|rp235x|pico|thumbv8m' -- . \
    ':!firmware/src/board/rp2350' ':!verify/pico' ':!*.md' ':!docs' ':!*Cargo.lock' ':!scripts/board_files.sh' ':!firmware/mistakes.py' \
    ':!scripts/c.sh' ':!scripts/targets.sh' ':!tests/fifth_kind')
said=$(tr '\n' ' ' <CONTRIBUTING.md | sed -n 's/.* \([0-9]*\) files of code and scripts name the RP2350.*/\1/p')
if [ "${#files[@]}" -ne "${said:-0}" ]; then
    printf '%s\n' "${files[@]}"
    echo "board_files: CONTRIBUTING.md says ${said:-nothing}, ${#files[@]} files name the RP2350" >&2
    exit 1
fi
echo "board_files: ${#files[@]} files name the RP2350"
