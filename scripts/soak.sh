#!/usr/bin/env bash
# Long runs from seeds; docs/verify/soak.md has the results so far. A broken rule ends a run with the
# seed that repeats it.
#
#   scripts/soak.sh sessions FIRST_SEED SECONDS   sessions of random orders, samples and faults
#   scripts/soak.sh robots FIRST_SEED SECONDS     SECONDS of simulated random jobs on each arm
#   scripts/soak.sh board FIRST_SEED TICKS        random jobs on the emulated board, bit by bit;
#                                                 needs the images of scripts/firmware.sh
#   scripts/soak.sh links                         a job over bad links: the table
#   scripts/soak.sh arms FIRST_SEED COUNT         commissioning of random simulated arms
#   scripts/soak.sh belts FIRST_SEED COUNT        random arms on belts against their predictions
#   scripts/soak.sh faults FIRST_SEED COUNT       single faults of brushed arms in every state; writes
#                                                 docs/verify/data/fault_campaign_brushed.csv
#   scripts/soak.sh kinds FIRST_SEED COUNT        COUNT trials of every fault on every kind of drive in
#                                                 every state; writes docs/verify/fault-campaign.md
#   scripts/soak.sh steppers                      2000 random jobs on random arms with steppers: are they drawn?
#   scripts/soak.sh coverage                      whether 95 % intervals of calibrations and identifications hold 95 %;
#                                                 writes docs/verify/data/coverage.csv
#   scripts/soak.sh serve MINUTES                 clients of the live page come and go: memory
set -euo pipefail
cd "$(dirname "$0")/.."

soak() { cargo test --quiet --package fivebar-tests "$@" --nocapture --include-ignored; }

case ${1:-} in
    sessions)
        cargo run --quiet --package fivebar-stress --example campaign -- "$2" "$3"
        ;;
    robots)
        SOAK_SEED=$2 SOAK_SECONDS=$3 soak --test soak -- robots::
        ;;
    board)
        SOAK_SEED=$2 SOAK_TICKS=$3 soak --features emulator --test soak -- board::random_jobs
        ;;
    links)
        soak --test soak -- links::every
        ;;
    arms)
        ARMS_SEED=$2 ARMS_COUNT=$3 cargo test --quiet --package fivebar --test commands -- \
            --nocapture --ignored --exact \
            random_arms::many_random_arms_end_named_or_within_twice_their_own_prediction
        ;;
    belts)
        BELTS_SEED=$2 BELTS_COUNT=$3 soak --test belts -- campaign::many
        ;;
    faults)
        FAULTS_SEED=$2 FAULTS_COUNT=$3 soak --test fault_campaign -- many_random_faults
        ;;
    kinds)
        FAULTS_SEED=$2 FAULTS_COUNT=$3 soak --test fault_campaign -- every_fault_on_every_kind
        ;;
    steppers)
        cargo test --quiet --package fivebar-sim --test runs -- --ignored --exact \
            stepper_campaign::tables::the_whole_campaign_is_drawn_as_the_page_has_it
        ;;
    coverage)
        soak --test commissioning -- coverage::data::the_results
        ;;
    serve)
        SOAK_MINUTES=$2 cargo test --quiet --package fivebar --test machine -- \
            --nocapture --ignored --exact soak::memory_stays_flat_while_clients_come_and_go
        ;;
    *)
        sed -n '2,/^set/p' "$0" | sed '$d; s/^# \{0,1\}//' >&2
        exit 2
        ;;
esac
