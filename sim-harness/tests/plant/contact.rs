//! Contact of a journal and its bearing: the rebound by the contact laws, and a published
//! benchmark, a slider-crank with a worn piston pin.

use fivebar_plant::contact::{Contact, Restitution};
use fivebar_plant::contact::{DormandPrince45, Eccentricity, HybridSystem, Journal, Phase};
use nalgebra::{SVector, Vector2};
use serde_json::Value;

/// A pin of 1 kg that hits a fixed bearing. The state is its position and velocity.
struct Thrown {
    journal: Journal,
    phase: Phase,
    rebound: Option<f64>,
}

fn eccentricity(x: &Vector2<f64>) -> Eccentricity {
    Eccentricity {
        offset: Vector2::new(x.x, 0.0),
        rate: Vector2::new(x.y, 0.0),
        pin_spin: 0.0,
        bearing_spin: 0.0,
    }
}

impl HybridSystem<2> for Thrown {
    fn rates(&self, x: &Vector2<f64>) -> Vector2<f64> {
        let contact = self.journal.contact_force(self.phase, &eccentricity(x));
        Vector2::new(x.y, contact.map_or(0.0, |contact| contact.force.x))
    }
    fn guard(&self, x: &Vector2<f64>) -> bool {
        self.journal.guard(self.phase, Vector2::new(x.x, 0.0))
    }
    fn transition(&mut self, x: &Vector2<f64>) {
        if matches!(self.phase, Phase::Contact { .. }) {
            self.rebound = Some(-x.y);
        }
        self.phase = self.journal.next_phase(self.phase, &eccentricity(x));
    }
    fn record(&mut self, _: &Vector2<f64>, _: f64) {}
}

/// The pin's speed after the impact as a share of its speed before.
fn rebound(law: Restitution, restitution: f64, speed: f64) -> f64 {
    let contact = Contact {
        law,
        restitution,
        ..Contact::default()
    };
    let clearance = 1e-4;
    let mut thrown = Thrown {
        journal: Journal::new(&contact, clearance).unwrap(),
        phase: Phase::Flight,
        rebound: None,
    };
    let mut x = Vector2::new(0.0, speed);
    let mut method = DormandPrince45::new(Vector2::new(1e-12, 1e-8 * speed));
    // Until the impact, and then until the pin has left the bearing.
    method.advance(&mut thrown, &mut x, clearance / speed);
    while thrown.rebound.is_none() {
        method.advance(&mut thrown, &mut x, 1e-4);
        assert!(x.x < 2.0 * clearance, "the pin passes through the bearing");
    }
    thrown.rebound.unwrap() / speed
}

#[test]
fn the_rebound_follows_from_the_law_at_any_speed() {
    use Restitution::{Flores, HuntCrossley, LankaraniNikravesh};
    for (law, expected) in [
        (HuntCrossley, [0.5813, 0.6630, 0.7680, 0.9090]),
        (LankaraniNikravesh, [0.6842, 0.7252, 0.7960, 0.9132]),
        (Flores, [0.2562, 0.4704, 0.6832, 0.8939]),
    ] {
        for (e, expected) in [0.3, 0.5, 0.7, 0.9].into_iter().zip(expected) {
            let d = law.hysteresis(e);
            for speed in [0.05, 0.5] {
                let back = rebound(law, e, speed);
                assert!((back - expected).abs() < 1e-4, "{law:?}, {e}: {back}");
                // ln((1 + D)/(1 − D e′)) = D (1 + e′)
                let identity = ((1.0 + d) / (1.0 - d * back)).ln() - d * (1.0 + back);
                assert!(identity.abs() < 1e-4, "{law:?}, {e}: {identity:e}");
            }
        }
    }
}

#[test]
fn a_perfectly_elastic_contact_returns_the_whole_speed() {
    let back = rebound(Restitution::Flores, 1.0, 0.2);
    assert!((back - 1.0).abs() < 1e-6, "{back}");
}

#[test]
fn a_clearance_that_leaves_no_pin_is_refused() {
    for clearance in [0.0, -1e-6, 4e-3, f64::NAN] {
        assert!(Journal::new(&Contact::default(), clearance).is_err());
    }
}

/// A crank with constant speed, a rod pinned to it, and a slider on the x axis. The clearance
/// is between rod (bearing) and slider (pin). State: θ, φ, x, φ̇, ẋ.
struct SliderCrank {
    crank: f64,
    rod: f64,
    rod_mass: f64,
    rod_inertia: f64,
    slider_mass: f64,
    omega: f64,
    journal: Journal,
    phase: Phase,
    time: f64,
    first: Impact,
}

/// The first impact.
#[derive(Debug, Default)]
struct Impact {
    time: f64,
    theta: f64,
    speed: f64,
    peak: f64,
    penetration: f64,
    parted: Option<(f64, f64)>,
}

type Crank = SVector<f64, 5>;

fn direction(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}
fn perp(r: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-r.y, r.x)
}

impl SliderCrank {
    fn eccentricity(&self, x: &Crank) -> Eccentricity {
        let (u, w) = (direction(x[0]), direction(x[1]));
        let end = u * self.crank + w * self.rod;
        let end_rate = perp(u) * (self.crank * self.omega) + perp(w) * (self.rod * x[3]);
        Eccentricity {
            offset: Vector2::new(x[2], 0.0) - end,
            rate: Vector2::new(x[4], 0.0) - end_rate,
            pin_spin: 0.0,
            bearing_spin: x[3],
        }
    }

    fn force(&self, x: &Crank) -> Vector2<f64> {
        let contact = self
            .journal
            .contact_force(self.phase, &self.eccentricity(x));
        contact.map_or_else(Vector2::zeros, |contact| contact.force)
    }
}

impl HybridSystem<5> for SliderCrank {
    fn rates(&self, x: &Crank) -> Crank {
        let force = self.force(x);
        let (u, w) = (direction(x[0]), direction(x[1]));
        // Moments about the crank pin, whose acceleration is −l₁ω² u. Without friction, the
        // force passes through the rod's end.
        let half = 0.5 * self.rod;
        let about_pin = self.rod_inertia + self.rod_mass * half * half;
        let inertial = u * (self.rod_mass * half * self.crank * self.omega * self.omega);
        let moment = perp(w).dot(&(inertial - force * self.rod));
        Crank::from([
            self.omega,
            x[3],
            x[4],
            moment / about_pin,
            force.x / self.slider_mass,
        ])
    }
    fn guard(&self, x: &Crank) -> bool {
        self.journal.guard(self.phase, self.eccentricity(x).offset)
    }
    fn transition(&mut self, x: &Crank) {
        let motion = self.eccentricity(x);
        match self.phase {
            Phase::Flight if self.first.speed == 0.0 => {
                self.first.time = self.time;
                self.first.theta = x[0];
                self.first.speed = motion.penetration_rate();
            }
            Phase::Contact { .. } if self.first.parted.is_none() => {
                self.first.parted = Some((self.time, -motion.penetration_rate()));
            }
            _ => (),
        }
        self.phase = self.journal.next_phase(self.phase, &motion);
    }
    fn record(&mut self, x: &Crank, step: f64) {
        self.time += step;
        if self.first.parted.is_none() {
            let offset = self.eccentricity(x).offset;
            self.first.penetration = self.first.penetration.max(self.journal.penetration(offset));
            self.first.peak = self.first.peak.max(self.force(x).norm());
        }
    }
}

#[test]
fn the_first_impact_of_the_worn_slider_crank_matches_the_benchmark() {
    let text = include_str!("../../../tests/data/clearance_contact.json");
    let data: Value = serde_json::from_str(text).unwrap();
    let benchmark = &data["slider_crank_first_impact"];
    let given = |key: &str| benchmark["params"][key].as_f64().unwrap();
    let case = &benchmark["cases"][0];
    let wanted = |key: &str| case[key].as_f64().unwrap();
    let contact = Contact {
        elastic_modulus: given("E"),
        poisson_ratio: given("nu"),
        bearing_radius: given("R_bearing"),
        restitution: wanted("restitution"),
        law: Restitution::LankaraniNikravesh,
        friction: 0.0,
    };
    let omega = wanted("rpm") * std::f64::consts::TAU / 60.0;
    let mut mechanism = SliderCrank {
        crank: given("l1"),
        rod: given("l2"),
        rod_mass: given("m_rod"),
        rod_inertia: given("J_rod"),
        slider_mass: given("m_slider"),
        omega,
        journal: Journal::new(&contact, wanted("c")).unwrap(),
        phase: Phase::Flight,
        time: 0.0,
        first: Impact::default(),
    };
    let straight = mechanism.crank + mechanism.rod;
    let swing = -omega * mechanism.crank / mechanism.rod;
    let mut x = Crank::from([0.0, 0.0, straight, swing, 0.0]);
    let mut method = DormandPrince45::new(Crank::from([1e-10, 1e-10, 1e-11, 1e-6, 1e-6]));
    // Short intervals, so that the greatest values are recorded accurately.
    for _ in 0..6000 {
        method.advance(&mut mechanism, &mut x, 5e-8);
    }
    let Impact {
        time,
        theta,
        speed,
        peak,
        penetration,
        parted,
    } = mechanism.first;
    let (end, parting) = parted.expect("the first contact ends");
    for (what, value, key) in [
        ("stiffness", mechanism.journal.stiffness(), "K"),
        ("time", time, "t_impact"),
        ("crank angle", theta.to_degrees(), "crank_deg"),
        ("speed", speed, "v_n"),
        ("peak force", peak, "F_max"),
        ("penetration", penetration, "delta_max"),
        ("duration", end - time, "contact_duration"),
        ("rebound", parting / speed, "v_sep_over_v_n"),
    ] {
        let error = value / wanted(key) - 1.0;
        println!("{what}: {value:e}, {error:+e} from the benchmark");
        assert!(error.abs() < 1e-5, "{what}: {value:e}, off by {error:e}");
    }
}
