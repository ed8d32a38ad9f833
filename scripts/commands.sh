#!/usr/bin/env bash
# Runs every command that the documents show in their fenced sh blocks, in order, as a reader
# of README.md would. It runs them in a separate folder, with the built program in place of
# `cargo run` and of an installed `fivebar`.
#
# A command whose comment says "on purpose" must end with status 1, every other command with
# status 0, and each output file that a command names must exist afterwards.
# `reason_not_to_run` lists the commands that cannot be run here. The script fails on a command
# that it can neither run nor find in this list.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/target-dir.sh

root=$PWD
program=$built/debug/fivebar
scratch=$built/commands

# Commands that are not run here, and why.
reason_not_to_run() {
    case "$1" in
    'cargo test') echo "ci.sh's step tests does this" ;;
    'cd verify/chip && cargo test') names_steps chip && echo "ci.sh's step chip does this" ;;
    *'verify/chip/Cargo.toml --bin board') echo "it runs until it is interrupted" ;;
    './ci.sh'*) names_steps ${1#./ci.sh} && echo "ci.sh is running" ;;
    'scripts/firmware.sh' | 'scripts/release.sh images '*) names_steps firmware && echo "ci.sh's step firmware does this" ;;
    'pip install ./python' | 'python python/'*)
        names_steps python && echo "ci.sh's step python does it in an environment of its own"
        ;;
    'cargo install '*) echo "it installs a program for the user" ;;
    'verify/fuzz/'*) names_steps fuzz && echo "ci.sh's step fuzz builds the targets and runs them" ;;
    'cargo run --features ros '*) names_steps ros && echo "ci.sh's step ros does this" ;;
    'scripts/mutants.sh'* | 'firmware/mistakes.py') echo "it takes hours" ;;
    'scripts/browser_arm.sh' | 'cargo run -p fivebar-browser'*) names_steps browser && echo "ci.sh's step browser does this" ;;
    'python3 -m http.server'*) echo "it runs until it is interrupted" ;;
    'probe-rs '*) echo "it needs a board on a debug probe" ;;
    'dfu-util '*) echo "it needs a board on USB" ;;
    'scripts/'*.sh*)
        local step=${1#scripts/}
        names_steps "${step%%.sh*}" 2>/dev/null && echo "ci.sh's step ${step%%.sh*} does this"
        ;;
    *) return 1 ;;
    esac
}

# Checks that ci.sh has these steps.
names_steps() {
    local step
    for step in "$@"; do
        grep -q "^$step() {" ci.sh || { echo "ci.sh has no step $step" >&2; return 1; }
    done
}

# Prints a line for every command: its file and line, the command, its comment, separated by
# tabs.
commands() {
    git ls-files '*.md' | while read -r file; do
        awk '
            /^ *```/ {
                fence = $0
                sub(/^ *```/, "", fence)
                inside = inside ? "" : (fence == "" ? "text" : fence)
                if (inside ~ /^(bash|shell|console|zsh)$/) inside = "sh"
                next
            }
            inside == "sh" {
                sub(/^ +/, "")
                if (whole == "") line = FNR
                whole = whole $0
                if (sub(/\\$/, "", whole)) next
                comment = match(whole, /(^| +)#.*/) ? substr(whole, RSTART, RLENGTH) : ""
                sub(/(^| +)#.*/, "", whole)
                if (whole != "") printf "%s:%d\t%s\t%s\n", FILENAME, line, whole, comment
                whole = ""
            }' "$file"
    done
}

fail() {
    echo "commands: $1" >&2
    exit 1
}

# Starts a command that listens, and waits at most 10 s for a line with this pattern in its log.
start_server() {
    local command=$1 pattern=$2 log=$3
    # What the server before it said would be taken for its own words.
    rm -f "$log"
    $command --listen 127.0.0.1:0 >"$log" 2>&1 </dev/null &
    server=$!
    trap 'kill "$server" 2>/dev/null || true' EXIT
    for _ in $(seq 100); do
        grep -qs "$pattern" "$log" && break
        sleep 0.1
    done
}

# Starts the server, requests its page by the printed link, which must come within 10 s, and stops
# the server. The link's token becomes a cookie.
serve() {
    local place=$1 address token reply
    start_server "$2" 'is at http' serve.log
    address=$(sed -n 's|.* is at http://\([^/]*\)/.*|\1|p' serve.log)
    token=$(sed -n 's|.*?token=||p' serve.log)
    [ -n "$address" ] && [ -n "$token" ] || fail "$place: no page within 10 s: $(cat serve.log)"
    exec 3<>"/dev/tcp/${address%:*}/${address#*:}"
    printf 'GET / HTTP/1.1\r\nHost: %s\r\nCookie: fivebar%s=%s\r\nConnection: close\r\n\r\n' \
        "$address" "${address#*:}" "$token" >&3
    read -r reply <&3
    exec 3>&-
    kill "$server"
    trap - EXIT
    [[ $reply == *' 200 '* ]] || fail "$place: the page answers $reply"
}

# Starts the bridge, asks for its version at the printed address, and stops it.
bridge() {
    local place=$1 address reply
    # The port is any free one.
    start_server "$(sed -E 's| --listen( [0-9][^ ]*)?||' <<<"$2")" '^127' bridge.log
    address=$(sed -n 's|^\(127[0-9.:]*\) .*|\1|p' bridge.log)
    [ -n "$address" ] || fail "$place: no address within 10 s: $(cat bridge.log)"
    exec 3<>"/dev/tcp/${address%:*}/${address#*:}"
    printf 'M115\n' >&3
    while read -r -t 10 reply <&3; do
        [[ $reply == FIRMWARE_NAME:* ]] && break
    done
    exec 3>&-
    kill "$server"
    trap - EXIT
    [[ $reply == FIRMWARE_NAME:* ]] || fail "$place: the bridge answers $reply"
}

# Runs a command that needs a board, with a port that does not exist. The command must read all
# its other input and then refuse the port.
without_port() {
    local place=$1 command=$2 said
    command=$(sed -E 's| --port [^ ]+| --port /dev/no-such-port|' <<<"$command")
    if said=$(bash -c "$command" 2>&1 </dev/null) || [[ $said != *'no port /dev/no-such-port'* ]]; then
        fail "$place: stops before it opens the port: $said"
    fi
}

run() {
    local place=$1 command=$2 wanted=0 status=0
    [[ $3 == *'on purpose'* ]] && wanted=1
    # `fivebar new` asks questions; the input accepts every default with the Enter key.
    bash -o pipefail -c "$command" >run.log 2>&1 < <(yes '' | head -n 50) || status=$?
    [ "$status" -eq "$wanted" ] || fail "$place: $command: status $status for $wanted: $(tail -n 5 run.log)"
    while read -r _ file; do
        [ -e "$file" ] || fail "$place: $command: $file is not there afterwards"
    done < <(grep -oE -- '(--out|--log) [^ ]+' <<<"$command")
}

build_program
rm -rf "$scratch"
mkdir -p "$scratch"
ln -s "$root/host" "$scratch/host"

declare -A seen
count=0
skipped=0
while IFS=$'\t' read -r place shown comment; do
    command=$(sed -E -e "s#cargo run( --features [a-z,]+)?( --( |\$)|\$)#$program\3#" \
        -e "s#(^|\| )fivebar( |\$)#\1$program\2#" <<<"$shown")
    started=$SECONDS
    if why=$(reason_not_to_run "$shown"); then
        skipped=$((skipped + 1))
        echo "commands: $place: not run, $why: $shown"
        continue
    fi
    if [ -n "${seen[$shown]:-}" ]; then
        echo "commands: $place: run already: $shown"
        continue
    fi
    seen[$shown]=yes
    cd "$scratch"
    if [[ $command == "$program"*' --port '* && $command != *' --port simulated '* ]]; then
        without_port "$place" "$command"
    elif [[ $command == "$program serve"* ]]; then
        serve "$place" "$command"
    elif [[ $command == "$program bridge"* ]]; then
        bridge "$place" "$command"
    elif [[ $command =~ ^(echo\ \'[^\']*\'\ \|\ )?"$program"( |$) || $command == 'cp '* ]]; then
        run "$place" "$command" "$comment"
    else
        fail "$place: scripts/commands.sh cannot run this command and does not list it: $shown"
    fi
    cd "$root"
    count=$((count + 1))
    echo "commands: $place: $((SECONDS - started)) s: $shown"
done < <(commands)
[ "$count" -gt 20 ] || fail "only $count commands were found"
echo "commands: $count run, $skipped not"
