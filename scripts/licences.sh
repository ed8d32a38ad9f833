#!/usr/bin/env bash
# Checks the licence of every dependency against the list in deny.toml, those of the fuzz
# targets, the interface for C, the Python package and the simulated chip included, and the vendored uPlot.
set -euo pipefail
cd "$(dirname "$0")/.."

allowed=$(sed -n '/^allow = \[/,/^\]/s/^ *"\(.*\)",.*$/\1/p' deny.toml)

# An SPDX expression passes if one alternative of every part joined by AND is allowed.
passes() {
    local part choice found
    while IFS= read -r part; do
        found=no
        while IFS= read -r choice; do
            if grep -qxF -- "$choice" <<<"$allowed"; then found=yes; fi
        done < <(sed 's, OR ,\n,g; s,/,\n,g' <<<"$part" | sed 's/^[( ]*//; s/[) ]*$//')
        [ "$found" = yes ] || return 1
    done < <(sed 's/ AND /\n/g' <<<"$1")
}

list() { cargo tree --workspace --all-features --edges normal,build,dev --prefix none --format '{p}|{l}' "$@"; }
count=0
refused=0
while IFS='|' read -r package licence; do
    count=$((count + 1))
    if ! passes "$licence"; then
        echo "licences: $package is under '$licence', which deny.toml does not allow" >&2
        refused=1
    fi
done < <({
    list --target x86_64-unknown-linux-gnu
    list --target thumbv7em-none-eabihf
    list --manifest-path verify/leg_m0/Cargo.toml --target thumbv6m-none-eabi
    # Of the tests' simulated STM32F405 the dependencies; the crate itself is under GPL-2.0-or-later.
    git ls-files '*/Cargo.lock' | while read -r lock; do
        list --manifest-path "${lock%lock}toml"
    done | grep -v '^fivebar-chip '
} | sed '/^$/d; s/ (\*)$//; s/ (.*)|/|/' | sort -u)
[ "$refused" -eq 0 ]
[ "$count" -gt 20 ] || { echo "licences: cargo tree listed only $count packages" >&2; exit 1; }
# uPlot is vendored, unchanged, with its licence (MIT).
passes MIT
(cd host/report/src/html/uplot && sha256sum --check --quiet SHA256SUMS)
echo "licences: $count packages, all under licences that deny.toml allows"
