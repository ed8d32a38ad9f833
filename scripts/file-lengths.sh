#!/usr/bin/env bash
# Fails if a source file has more than 400 lines, because such a file has more than one topic.
set -euo pipefail
cd "$(dirname "$0")/.."
long=$(git ls-files '*.rs' '*.sh' '*.py' | xargs wc -l | awk '$1 > 400 && $2 != "total"')
if [ -n "$long" ]; then
    echo "files of more than 400 lines:" >&2
    echo "$long" >&2
    exit 1
fi
