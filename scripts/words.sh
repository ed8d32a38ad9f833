#!/usr/bin/env bash
# Fails if a word of a list occurs in the repository, and names the plain word that takes its place.
#
#   scripts/words.sh                 by scripts/words.txt, which explains its lines
#   scripts/words.sh LIST            by another list
set -euo pipefail
cd "$(dirname "$0")/.."

list=${1:-scripts/words.txt}
texts=('*.md' '*.rs' '*.py' '*.ipynb' '*.sh' '*.js' '*.html' '*.css' '*.toml' '*.yml' ':!scripts/words.sh')
count=0
found=0
while IFS= read -r line; do
    # kind | expression | plain; in the expression \| stands for |.
    [[ $line =~ ^(text|name)\ \|\ (.*[^\\])\ \|\ (.*)$ ]] || {
        echo "words: $list: not 'text | EXPRESSION | PLAIN' or 'name | …': $line" >&2
        exit 2
    }
    kind=${BASH_REMATCH[1]} expression=${BASH_REMATCH[2]//\\|/|} plain=${BASH_REMATCH[3]}
    count=$((count + 1))
    case $kind in
    text) search=(--ignore-case -e "\\b($expression)\\b" -- "${texts[@]}") ;;
    name) search=(-e "\\b($expression)\\b" -- '*.rs') ;;
    esac
    status=0
    lines=$(git grep -nIP "${search[@]}") || status=$?
    # git grep: 0 found, 1 nothing found, else the expression is wrong.
    [ "$status" -le 1 ] || exit 2
    if [ -n "$lines" ]; then
        found=1
        printf 'words: write %s:\n%s\n' "$plain" "$lines" >&2
    fi
done < <(grep -v '^#' "$list")
[ "$count" -gt 0 ] || { echo "words: $list has no words" >&2; exit 2; }
exit "$found"
