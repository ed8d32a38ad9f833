#!/usr/bin/env bash
# Runs every check that must pass before a change is merged. CI runs this script too.
#
#   ./ci.sh            every step but those of `by_name`; works from a fresh clone on a fresh machine
#   ./ci.sh tests      one step, or several, by name
set -euo pipefail
cd "$(dirname "$0")"
source scripts/target-dir.sh
exec </dev/null
export CARGO_TERM_COLOR=${CARGO_TERM_COLOR:-never}
# A run from nothing compiles each crate once: data for a second compilation would only fill the disk.
export CARGO_INCREMENTAL=0

format() { cargo fmt --all --check; }
lint() {
    local features=("${with_features[@]}" --features fivebar-tests/emulator)
    cargo clippy --workspace --all-targets --quiet "${features[@]}" -- -D warnings
    cargo clippy --workspace --test machine --quiet "${features[@]}" -- -D warnings
}
docs() { scripts/docs.sh; }
# Whether the mistakes that are seeded into the firmware, and the patch that adds a kind of drive, still find their places.
mistakes() {
    firmware/mistakes.py --check
    verify/chip/mistakes.py --check
    scripts/fifth_kind.sh --check
}
licences() { scripts/licences.sh; }
# Status 77: this machine cannot check it. That is no failure and no pass, and the last line says so.
advisories() { scripts/advisories.sh || { [ $? -eq 77 ] && not_checked+=(advisories); }; }
actions() { scripts/actions.sh; }
links() { scripts/links.py; }
arrows() {
    scripts/arrows.py
    scripts/board_files.sh
}
words() { scripts/words.sh; }
file_lengths() { scripts/file-lengths.sh; }
tests() { cargo test "${with_features[@]}"; }
# The rows of the documents' tables that `cargo test` leaves out, and the whole exploration of the controller. By name
# only: a release needs them, a push does not.
# The hostile files are also read in their full length, by the optimised readers that the program has, and a fifth kind of
# drive is added to a copy of the sources.
tables() {
    cargo test "${with_features[@]}" -- --ignored whole_table
    cargo test --release --package fivebar-files --test hostile -- --ignored
    cargo test --manifest-path verify/chip/Cargo.toml --test crystals -- --ignored whole_table
    scripts/fifth_kind.sh
}
# The program on a machine: these tests measure times, so nothing else runs beside them.
machine() { cargo test "${with_features[@]}" --test machine; }
# Each published crate as a package, compiled from its own archive. Each run takes a new target folder, because
# cargo unpacks an archive once for each path and version: at a known path it would compile the crates of an older run.
# Only here the program has no optional features: it names the one that a log needs.
package() {
    mkdir -p "$built"
    local folder
    folder=$(mktemp -d "$built/package-XXXXXX")
    CARGO_TARGET_DIR=$folder CARGO_PROFILE_DEV_DEBUG=0 cargo package --quiet --allow-dirty --package fivebar-kinematics \
        --package fivebar-design --package fivebar-firmware --package fivebar-plant \
        --package fivebar-files --package fivebar-sim --package fivebar-report --package fivebar
    local said
    said=$("$folder/debug/fivebar" sim host/files/jobs/petal.gcode --out "$folder/out" --log "$folder/run.mcap" 2>&1) && return 1
    [[ $said == *"--features mcap"* ]] && [ ! -e "$folder/out" ] || { echo "package: without mcap: $said" >&2; return 1; }
    rm -rf "$folder"
}
# A sample: it compiles a copy of the sources.
mutants() { scripts/mutants.sh --sample; }
# They install a toolchain or a tool.
msrv() { scripts/msrv.sh; }
semver() { scripts/semver.sh || { [ $? -eq 77 ] && not_checked+=(semver); }; }
peers() { scripts/peers.sh; }
browser() { scripts/browser.sh; }
python() { scripts/python.sh; }
ros() { scripts/ros.sh; }
senders() { scripts/senders.sh; }
emulated_senders() { scripts/senders.sh --emulated; }
targets() { scripts/targets.sh; }
c() { scripts/c.sh; }
setup() { scripts/toolchain.sh; }
firmware() {
    scripts/firmware.sh
    scripts/bounds.sh
}
chip() { scripts/chip.sh; }
pico() { scripts/pico.sh; }
bring_up() { scripts/bring_up.sh; }
emulated() {
    local features=("${with_features[@]}" --features fivebar-tests/emulator)
    cargo test "${features[@]}" \
        --test images --test instructions --test emulated_boards --test emulated_drives --test emulated_faults \
        --test emulated_homing --test emulated_live --test emulated_port --test emulated_streams --test production_image --test stack --test live_page
    cargo test "${features[@]}" --test soak -- board:: replay::
}
# Builds the fuzz targets and runs each over its committed inputs.
fuzz() {
    verify/fuzz/build.sh files
    for target in verify/fuzz/fuzz_targets/*.rs; do
        verify/fuzz/run.sh "$(basename "$target" .rs)" -runs=0
    done
}
commands() { scripts/commands.sh; }
demo() { cargo run --quiet "${with_features[@]}" -- --out "$built/demonstration"; }

all=(format file_lengths words links arrows actions mistakes licences advisories targets c setup firmware lint docs tests demo commands peers python browser emulated_senders chip emulated machine bring_up senders)
# These compile nearly everything once more, in another way. A release needs them; a push takes them as jobs of their own.
by_name=(pico ros fuzz package mutants msrv semver)
# A whole run does these beside the steps after `firmware`, because many steps keep only one of two cores busy. They
# build in folders of their own, or with the features of the other steps: the program in `target` is theirs.
beside=(chip emulated emulated_senders)
# These come last and alone: they talk with an arm that moves in real time.
alone=(machine bring_up senders)

# A whole run needs some 40 GB: a full disk shows as a failure of any step.
free() { df --output=avail --human-readable . | tail -1 | tr -d ' '; }

not_checked=()
run() {
    local step started
    for step in "$@"; do
        echo "==> $step"
        started=$SECONDS
        "$step"
        if [[ " ${not_checked[*]} " == *" $step "* ]]; then
            echo "==> $step: NOT CHECKED"
        else
            echo "==> $step: passed in $((SECONDS - started)) s, $(free) left on the disk"
        fi
    done
}

# All steps; those beside the others begin when the images are built.
run_all() {
    local log=$built/ci-beside.log step lane
    for step in "${all[@]}"; do
        [[ " ${beside[*]} ${alone[*]} " != *" $step "* ]] || continue
        run "$step"
        if [ "$step" = firmware ]; then
            set -m # A process group of its own, which ends with this script.
            # Nice, because tests of the other steps measure how soon an arm stops.
            (renice -n 10 -p $BASHPID >/dev/null; run "${beside[@]}") >"$log" 2>&1 &
            lane=$!
            set +m
            trap "kill -- -$lane 2>/dev/null || true" EXIT
        fi
    done
    echo "==> beside: ${beside[*]}"
    wait "$lane" || { cat "$log"; exit 1; }
    cat "$log"
    run "${alone[@]}"
}

for step in "$@"; do
    if ! declare -F "$step" >/dev/null; then
        echo "ci.sh: there is no step '$step'; the steps are: ${all[*]}" >&2
        exit 2
    fi
done
if [ $# -gt 0 ]; then
    steps=("$@")
    run "$@"
else
    steps=("${all[@]}")
    run_all
fi
echo "ci.sh: $((${#steps[@]} - ${#not_checked[@]})) steps passed in $SECONDS s${not_checked:+, NOT CHECKED: ${not_checked[*]}}"
