#!/usr/bin/env bash
# Warns of source files of more than 600 lines: look whether such a file has more than one topic.
set -euo pipefail
cd "$(dirname "$0")/.."
long=$(git ls-files '*.rs' '*.sh' '*.py' | xargs wc -l | awk '$1 > 600 && $2 != "total"')
if [ -n "$long" ]; then
    echo "warning: files of more than 600 lines; has each one topic?" >&2
    echo "$long" >&2
fi
