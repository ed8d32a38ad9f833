//! `docs/verify/stepper-motion.md` states of each case of `docs/verify/data/torque_reserve.csv`, which
//! `scripts/torque_reserve.py` writes, what its jobs say.

const DOCUMENT: &str = include_str!("../../../docs/verify/stepper-motion.md");
const DATA: &str = include_str!("../../../docs/verify/data/torque_reserve.csv");
/// The cases, as the document names them.
const CASES: [(&str, &str); 4] = [
    ("benchtop", "`benchtop_stepper`"),
    ("longer", "longer links, gears of 3"),
    ("more unknown", "`benchtop_stepper`, more unknown"),
    ("overload", "longer links, overload"),
];
/// Jobs of each case.
const JOBS: usize = 200;
/// The case that shows that the jobs can lose steps.
const OVERLOAD: &str = "overload";

/// The rows of a case by the names of their columns.
struct Case(Vec<Vec<&'static str>>);

impl Case {
    fn of(name: &str) -> Self {
        let rows = DATA.lines().skip(1).map(|line| line.split(',').collect());
        Self(rows.filter(|row: &Vec<&str>| row[0] == name).collect())
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let index = DATA.lines().next().and_then(|head| {
            let mut names = head.split(',');
            names.position(|it| it == name)
        });
        let index = index.unwrap_or_else(|| panic!("no column {name}"));
        let number = |row: &Vec<&str>| row[index].parse().expect("a number");
        self.0.iter().map(number).collect()
    }

    fn columns(&self, names: [&str; 2]) -> Vec<f64> {
        names.map(|name| self.column(name)).concat()
    }

    /// Of each job that is drawn with both shares, the time with the measured one over that with the default one.
    fn ratios(&self) -> Vec<f64> {
        let [measured, default, drawn, too] = [
            "seconds_measured",
            "seconds_default",
            "drawn_measured",
            "drawn_default",
        ]
        .map(|name| self.column(name));
        (0..self.0.len())
            .filter(|&job| drawn[job] + too[job] > 1.5)
            .map(|job| measured[job] / default[job])
            .collect()
    }

    /// The row of the document's table.
    fn stated(&self, title: &str) -> String {
        let shares = self.columns(["share_1", "share_4"]);
        let [measured, default] =
            ["measured", "default"].map(|share| count(&self.column(&format!("lost_{share}"))));
        let ratios = self.ratios();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let jobs = self.0.len();
        let ([low, high], [quick, slow]) = (ends(&shares), ends(&ratios));
        format!(
            "| {title} | {low:.2} to {high:.2} | {measured} of {jobs} | {default} of {jobs} | {mean:.3} ({quick:.2} to {slow:.2}) |"
        )
    }
}

/// How many numbers are not 0.
fn count(numbers: &[f64]) -> usize {
    numbers.iter().filter(|number| **number != 0.0).count()
}

/// The least and the greatest number.
fn ends(numbers: &[f64]) -> [f64; 2] {
    let [least, most] = [f64::INFINITY, f64::NEG_INFINITY];
    let of = numbers.iter();
    of.fold([least, most], |[least, most], it| {
        [least.min(*it), most.max(*it)]
    })
}

#[test]
fn the_document_states_what_jobs_at_the_torque_in_reserve_say() {
    for (name, title) in CASES {
        let line = Case::of(name).stated(title);
        assert!(DOCUMENT.contains(&line), "missing: {line}");
    }
}

#[test]
fn the_text_states_what_the_table_shows() {
    let page = DOCUMENT.replace('\n', " ");
    let sound = || CASES.iter().filter(|(name, _)| *name != OVERLOAD);
    let faster = sound().map(|(name, _)| {
        let ratios = Case::of(name).ratios();
        100.0 * (1.0 - ratios.iter().sum::<f64>() / ratios.len() as f64)
    });
    let [least, most] = ends(&faster.collect::<Vec<_>>());
    let [_, share] = ends(&Case::of("benchtop").columns(["share_1", "share_4"]));
    for sentence in [
        format!("is {least:.0} to {most:.0} % faster in the mean"),
        format!("no more torque ({share:.2} on `benchtop_stepper`)"),
    ] {
        assert!(page.contains(&sentence), "missing: {sentence}");
    }
    // "Where a motor got less than 0.6, most jobs are slower."
    for (name, _) in sound() {
        let case = Case::of(name);
        let [one, four] = ["share_1", "share_4"].map(|name| case.column(name));
        let ratios = case.ratios();
        let weak: Vec<f64> = (0..ratios.len())
            .filter(|&job| one[job].min(four[job]) < 0.6)
            .map(|job| ratios[job])
            .collect();
        let slower = weak.iter().filter(|ratio| **ratio > 1.0).count();
        assert!(
            2 * slower >= weak.len(),
            "{name}: {slower} of {}",
            weak.len()
        );
    }
}

#[test]
fn no_job_at_the_torque_in_reserve_lost_steps_and_each_was_drawn() {
    for (name, _) in CASES {
        let case = Case::of(name);
        assert_eq!(case.0.len(), JOBS, "{name}");
        for (columns, most) in [(["torque_1", "torque_4"], 0.1), (["mass"; 2], 0.15)] {
            let off = ends(&case.columns(columns));
            assert!(off[0] >= -most && off[1] <= most, "{name}: {off:?}");
        }
        let lost = count(&case.column("lost_measured"));
        let drawn = count(&case.column("drawn_measured"));
        if name == OVERLOAD {
            assert!(lost > 0, "the jobs lose no steps in an overload either");
        } else {
            assert_eq!([lost, drawn], [0, JOBS], "{name}");
        }
    }
    let rows = DATA.lines().count() - 1;
    assert_eq!(JOBS * CASES.len(), rows, "a case is left out");
}
