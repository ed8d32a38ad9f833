#!/usr/bin/env bash
# Fails if a workflow uses an action by a tag or a branch, which its owner can move to other code: each is named
# by the 40 digits of a commit, with the tag in a comment. Fails also if no job of ci.yml runs one of ci.sh's steps.
#
#   scripts/actions.sh                 every workflow of the repository
#   scripts/actions.sh FILE...         these
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- .github/workflows/*.yml

pinned='uses: *[A-Za-z0-9_.-]+/[A-Za-z0-9_./-]+@[0-9a-f]{40} +# v[0-9][0-9.]*$'
uses=$(grep -nE '\buses:' "$@" /dev/null || true)
movable=$(grep -vE "$pinned" <<<"$uses" || true)
if [ -z "$uses" ]; then
    echo "actions: no workflow uses an action: $*" >&2
    exit 1
fi
if [ -n "$movable" ]; then
    echo "actions named by what can be moved, not by 'OWNER/NAME@COMMIT # vTAG':" >&2
    echo "$movable" >&2
    exit 1
fi
missing=()
groups=" $(sed -n 's/^ *steps: \([a-z_ ]*\)$/\1/p' .github/workflows/ci.yml | tr '\n' ' ') "
for step in $(sed -nE 's/^(all|by_name)=\((.*)\)$/\2/p' ci.sh); do
    [[ $groups == *" $step "* ]] || missing+=("$step")
done
if [ "${#missing[@]}" -gt 0 ]; then
    echo "actions: no job of ci.yml runs these steps of ci.sh: ${missing[*]}" >&2
    exit 1
fi
