//! The tables of docs/verify/stepper-motion.md, and its campaign.

use super::rival::Rival;
use super::{Arm, Outcome, SHARE};
use rayon::prelude::*;

/// The seed of the arms and jobs of both tables, and the seed of the jobs that a rival is tuned on.
const SEEDS: [u64; 2] = [3, 503];
/// Jobs that a rival is tuned on, and fresh ones that it is compared with.
const JOBS: [u64; 2] = [8, 20];
/// Seed, arms and jobs of each arm of the campaign.
const CAMPAIGN: [u64; 3] = [7, 100, 20];

const PAGE: &str = include_str!("../../../../docs/verify/stepper-motion.md");

/// The jobs of these arms, with this share of the torque.
fn drawn(seed: u64, arms: u64, jobs: u64, share: f64, leads_by_lag: bool) -> Vec<Outcome> {
    let arms = (0..arms)
        .into_par_iter()
        .map(|number| Arm::new(seed, number));
    arms.flat_map_iter(|arm| {
        let jobs = arm.jobs(seed, jobs);
        jobs.into_iter()
            .map(move |job| arm.by_torque(&job, share, leads_by_lag))
    })
    .collect()
}

/// Of many jobs.
struct Sum {
    lost: usize,
    not_drawn: usize,
    /// Of those that lost no step [full steps].
    farthest: f64,
    /// [s].
    time: f64,
}

impl Sum {
    fn of(outcomes: &[Outcome]) -> Self {
        let whole = outcomes.iter().filter(|it| !it.loses_steps());
        Self {
            lost: outcomes.iter().filter(|it| it.loses_steps()).count(),
            not_drawn: outcomes.iter().filter(|it| !it.is_drawn()).count(),
            farthest: whole.map(|it| it.farthest).fold(0.0, f64::max),
            time: outcomes.iter().map(|it| it.time).sum(),
        }
    }
}

#[test]
fn random_arms_draw_their_jobs_and_the_lag_brings_their_rotors_nearer_to_their_set_points() {
    let [seed, ..] = CAMPAIGN;
    let [led, behind] = [true, false].map(|leads_by_lag| drawn(seed, 3, 2, SHARE, leads_by_lag));
    assert_eq!(Sum::of(&led).not_drawn, 0, "{led:?}");
    let nearer = |(led, behind): (&Outcome, &Outcome)| led.farthest < behind.farthest;
    let nearer = led.iter().zip(&behind).filter(|pair| nearer(*pair)).count();
    assert!(nearer > led.len() / 2, "{led:?} {behind:?}");
}

#[test]
#[ignore = "minutes: scripts/soak.sh steppers"]
fn the_whole_campaign_is_drawn_as_the_page_has_it() {
    let [seed, arms, jobs] = CAMPAIGN;
    let outcomes = drawn(seed, arms, jobs, SHARE, true);
    let Sum {
        lost,
        not_drawn,
        farthest,
        time,
    } = Sum::of(&outcomes);
    let count = outcomes.len();
    println!(
        "{lost} lost steps, {not_drawn} of {count} not drawn; {farthest:.2} full steps, {time:.1} s"
    );
    for line in [
        format!("{} of {count} jobs were drawn", count - not_drawn),
        format!("farther than {farthest:.2} of a full step"),
    ] {
        assert!(PAGE.contains(&line), "{line}");
    }
}

#[test]
#[ignore = "a minute"]
fn whole_table_of_shares_and_leads_with_which_random_jobs_are_drawn() {
    let parts = [(true, 0.5), (true, 0.6), (true, 0.7), (false, 0.6)];
    let rows = parts.map(|(leads_by_lag, share)| {
        let outcomes = drawn(SEEDS[0], 8, 10, share, leads_by_lag);
        let Sum {
            lost,
            not_drawn,
            farthest,
            time,
        } = Sum::of(&outcomes);
        let lead = if leads_by_lag { "load and lag" } else { "load" };
        let count = outcomes.len();
        format!("| {lead} | {share} | {lost} of {count} | {not_drawn} of {count} | {time:.1} | {farthest:.2} |")
    });
    are_on_the_page(&rows);
}

#[test]
#[ignore = "minutes"]
fn whole_table_of_the_best_constant_accelerations() {
    let rows: Vec<String> = (0..3_u64)
        .into_par_iter()
        .map(|number| {
            let arm = Arm::new(SEEDS[0], number);
            let (tuning, fresh) = (arm.jobs(SEEDS[1], JOBS[0]), arm.jobs(SEEDS[0], JOBS[1]));
            let ours: Vec<Outcome> = fresh
                .par_iter()
                .map(|job| arm.by_torque(job, SHARE, true))
                .collect();
            let ours = Sum::of(&ours);
            assert_eq!(ours.not_drawn, 0);
            let rivals = [true, false].map(|leads| {
                let tuned = Rival::tuned(&arm, &tuning, leads);
                let (rival, not_drawn) = tuned.checked(&arm, &fresh);
                let (acceleration, time) = (rival.acceleration, rival.time(&arm, &fresh));
                format!("{acceleration:.0} | {not_drawn} | {:.2}", ours.time / time)
            });
            let Arm {
                size, gear_ratio, ..
            } = arm;
            format!(
                "| {size:.2} | {gear_ratio:.1} | {:.2} | {} |",
                ours.time,
                rivals.join(" | ")
            )
        })
        .collect();
    are_on_the_page(&rows);
}

fn are_on_the_page(rows: &[String]) {
    println!("{}", rows.join("\n"));
    for row in rows {
        assert!(PAGE.contains(row), "{row}");
    }
}
