#!/usr/bin/env bash
# Builds the documentation; warnings are errors.
#
# A unit in brackets, as in "length [m]", looks to rustdoc like a link to an item of that
# name. The workspace therefore allows broken links, and this script reports those that are not
# units.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

units='turns|1|pixels|greys|bytes|codes|cycles|KiB|µm|A²|m²|m³|Pa|A|H|Hz|MHz|J|K|N|V|W|kg|m|mm|rad|s|ticks|us|Ω'
log=$(mktemp)
trap 'rm -f "$log"' EXIT

if ! RUSTDOCFLAGS="-D warnings --force-warn rustdoc::broken_intra_doc_links" \
    cargo doc --workspace --no-deps "${with_features[@]}" 2>"$log"; then
    grep -A 8 '^error' "$log" >&2
    exit 1
fi
if broken=$(grep -A 1 'unresolved link to' "$log" | grep -vE "^--|unresolved link to \`($units)\`" |
    grep -A 1 'unresolved link to'); then
    echo "$broken" >&2
    exit 1
fi
