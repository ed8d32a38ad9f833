#!/usr/bin/env bash
# Runs a fuzz target that verify/fuzz/build.sh has built: verify/fuzz/run.sh session -max_total_time=600
#
# It begins with the committed corpus and seeds. What it finds goes to verify/fuzz/corpus, which is not
# committed; inputs that break something go to verify/fuzz/artifacts.
set -euo pipefail
cd "$(dirname "$0")"
name=$1
shift
target=$(rustc -vV | sed -n 's/^host: //p')
mkdir -p "corpus/$name" "artifacts/$name"
case $name in
    decode) length=600 ;;
    session | points) length=400 ;;
    settings_pages) length=4096 ;;
    svg | dxf | hpgl | table | picture) length=1000000 ;;
    *) length=6000 ;;
esac
exec nice -n 10 "${CARGO_TARGET_DIR:-target}/$target/release/$name" -artifact_prefix="artifacts/$name/" \
    -max_len="$length" -timeout=20 -rss_limit_mb=1024 -print_final_stats=1 \
    "$@" "corpus/$name" "seeds/$name"
