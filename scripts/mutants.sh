#!/usr/bin/env bash
# Mutation testing with cargo-mutants: changes one operator or one function at a time and runs the
# crate's tests. Fails if a mutant survives that scripts/mutants.txt does not justify.
#
#   scripts/mutants.sh                                      all (hours)
#   scripts/mutants.sh firmware/src/safety/monitor.rs ...   these files
#   scripts/mutants.sh --sample                             the states and their transitions
set -euo pipefail
cd "$(dirname "$0")/.."

version=27.1.0
sample=(firmware/src/safety/state.rs firmware/src/controller/transitions.rs)
all=('firmware/src/safety/**' 'firmware/src/controller/**' 'firmware/src/session/**'
    'firmware/src/settings/**' 'firmware/src/storage/**' 'firmware/src/planner/**'
    'firmware/src/protocol/**' 'kinematics/src/control/**' 'kinematics/src/five_bar/**'
    'kinematics/src/dynamics/**')
case "${1:-}" in
    --sample) files=("${sample[@]}") ;;
    '') files=("${all[@]}") ;;
    *) files=("$@") ;;
esac

if [ "$(cargo mutants --version 2>/dev/null)" != "cargo-mutants $version" ]; then
    cargo install cargo-mutants --version "$version" --locked --debug --quiet
fi

# A copy is changed in place. It has a target folder of its own: in a shared one, cargo takes what
# was compiled from the copy for what was compiled from here.
root=$PWD
copy=target/mutants-tree
mkdir -p "$copy"
git ls-files -z | tar --create --null --files-from=- | tar --extract --touch --directory "$copy"
report=$root/target/mutants
rm -rf "$report"
mkdir -p "$report"
survivors=0
left=$report/justified.txt
cp scripts/mutants.txt "$left"
for crate in firmware kinematics; do
    chosen=()
    for file in "${files[@]}"; do
        [[ $file == "$crate"/* ]] && chosen+=(--file "$file")
    done
    [ ${#chosen[@]} -gt 0 ] || continue
    # Exit codes 2 and 3 report survivors and timeouts, which are looked at below.
    status=0
    (cd "$copy" && PROPTEST_MAX_SHRINK_ITERS=0 RUST_BACKTRACE=0 \
        cargo mutants --in-place --package "fivebar-$crate" "${chosen[@]}" --timeout 90 \
        --no-shuffle --colors never --output "$report/$crate" -- --lib --tests) || status=$?
    [ "$status" = 0 ] || [ "$status" = 2 ] || [ "$status" = 3 ] || exit "$status"
    # By name without line and column, which change with every edit. A line of the list justifies
    # one survivor, so that it does not hide another one in the same function.
    while IFS= read -r mutant; do
        name=$(sed -E 's/:[0-9]+:[0-9]+:/:/' <<<"$mutant")
        line=$(sed 's/ | .*//' "$left" | grep --line-number --fixed-strings --line-regexp -- "$name" | head -n 1 | cut -d: -f1) || true
        if [ -n "$line" ]; then
            sed -i "${line}s/.*//" "$left"
        else
            echo "mutants.sh: survives, and scripts/mutants.txt does not justify it: $mutant" >&2
            survivors=$((survivors + 1))
        fi
    done <"$report/$crate/mutants.out/missed.txt"
done
[ "$survivors" = 0 ]
