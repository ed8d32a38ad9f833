# Sourced in the repository's root. `built` is the folder into which cargo builds: CARGO_TARGET_DIR, made absolute
# because some scripts change their folder, or else target.
if [ -n "${CARGO_TARGET_DIR:-}" ]; then
    [[ $CARGO_TARGET_DIR == /* ]] || export CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR
fi
built=${CARGO_TARGET_DIR:-$PWD/target}

# Builds the program with all of its features, as every step of ci.sh does, so that each crate is compiled once.
with_features=(--features fivebar/mcap,fivebar/png)
build_program() { cargo build --quiet "${with_features[@]}" --bin fivebar "$@"; }
