//! Specifications of `fivebar design`: areas, sizes and what is refused.

use fivebar_design::synthesis::{Area, Objective, Specification, Stock};
use fivebar_files::design_spec::parse;
use fivebar_files::source::FileError;
use std::path::Path;

const JOBS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/jobs");

fn spec(area: &str, objective: &str) -> Result<Specification, FileError> {
    let text = format!(
        "symmetric = false\nbase = [0.0, 0.2]\nlink_sum = 0.5\n[area]\n{area}\n[require]\ndexterity = 0.3\n\
         [objective]\n{objective}\n"
    );
    parse("spec.toml", &text, Path::new(JOBS))
}

#[test]
fn every_kind_of_area_has_its_shape_and_size() {
    let sum = "minimise = \"link_sum\"";
    for (area, shape, size) in [
        ("kind = \"annulus\"\nwidth = 0.1", Area::Annulus, 0.1),
        (
            "kind = \"square\"\nside = 0.2",
            Area::Rectangle { aspect: 1.0 },
            0.2,
        ),
        (
            "kind = \"rectangle\"\nwidth = 0.2\nheight = 0.1",
            Area::Rectangle { aspect: 2.0 },
            0.2,
        ),
        (
            "kind = \"points\"\npoints = [[0.1, 0.1], [0.3, 0.2]]",
            Area::Paths(vec![vec![[-0.5, 0.0]], vec![[0.5, 0.5]]]),
            0.2,
        ),
    ] {
        let spec = spec(area, sum).unwrap();
        match (&spec.area, &shape) {
            (Area::Paths(found), Area::Paths(expected)) => {
                for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                    assert!((found[0] - expected[0]).abs() < 1e-12);
                    assert!((found[1] - expected[1]).abs() < 1e-12);
                }
            }
            (found, expected) => assert_eq!(found, expected),
        }
        let Objective::LinkSum(found) = spec.objective else {
            panic!("{:?}", spec.objective);
        };
        assert!((found - size).abs() < 1e-12, "{area}");
    }
}

#[test]
fn a_drawing_is_the_path_of_its_job() {
    let drawing = "kind = \"drawing\"\nfile = \"petal.gcode\"";
    let spec = spec(drawing, "maximise = \"size\"").unwrap();
    let Area::Paths(paths) = &spec.area else {
        panic!("{:?}", spec.area);
    };
    let points = paths.iter().flatten();
    let greatest = points
        .map(|p| p[1].max(2.0 * p[0].abs()))
        .fold(0.0, f64::max);
    assert!((greatest - 1.0).abs() < 1e-9, "{greatest}");
    let error = |file: &str| {
        let drawing = format!("kind = \"drawing\"\nfile = \"{file}\"");
        self::spec(&drawing, "maximise = \"size\"").unwrap_err()
    };
    assert_eq!(error("none.gcode").line, Some(6));
}

#[test]
fn keys_of_other_kinds_and_missing_sizes_are_refused() {
    let sum = "minimise = \"link_sum\"";
    let size = "maximise = \"size\"";
    for (area, objective, reason) in [
        ("kind = \"annulus\"", sum, "`width` of [area] is missing"),
        (
            "kind = \"square\"\nwidth = 0.1",
            sum,
            "`width` of [area] does not belong",
        ),
        ("kind = \"rectangle\"", size, "or give `aspect`"),
        (
            "kind = \"rectangle\"\naspect = 1.5",
            sum,
            "`width` of [area] is missing",
        ),
        (
            "kind = \"points\"\npoints = [[0.1, 0.1]]",
            size,
            "two unlike points",
        ),
        (
            "kind = \"annulus\"\nwidth = -1.0",
            size,
            "must be more than 0",
        ),
        (
            "kind = \"annulus\"",
            "front = 2",
            "`maximise` of [objective] must be given",
        ),
        (
            "kind = \"annulus\"",
            "maximise = \"size\"\nfront = 0",
            "1 to 200",
        ),
    ] {
        let error = spec(area, objective).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
}

#[test]
fn either_requirement_alone_suffices_and_none_is_refused() {
    let required = |require: &str| {
        let text = format!(
            "symmetric = true\nbase = [0.0, 0.0]\nlink_sum = 0.3\n[area]\nkind = \"annulus\"\n[require]\n{require}\n\
             [objective]\nmaximise = \"size\"\n"
        );
        let spec = parse("spec.toml", &text, Path::new(JOBS));
        spec.map(|spec| [spec.dexterity, spec.sine])
            .map_err(|error| error.to_string())
    };
    assert_eq!(required("sine = 0.4"), Ok([0.0, 0.4]));
    assert_eq!(required("dexterity = 0.3"), Ok([0.3, 0.0]));
    assert_eq!(required("dexterity = 0.3\nsine = 0.4"), Ok([0.3, 0.4]));
    assert_eq!(
        required("dexterity = 0.3\ncrank = [0.5, 2.5]"),
        Ok([0.3, 0.0])
    );
    for (require, reason) in [
        ("", "`dexterity` of [require] is missing, and `sine`, too"),
        (
            "sine = 0.0",
            "`dexterity` of [require] is missing, and `sine`, too",
        ),
        (
            "dexterity = 0.0",
            "`dexterity` of [require] must be more than 0",
        ),
        (
            "sine = 0.4\ncrank = [0.5, 4.0]",
            "`crank` of [require] must be [least, greatest] of θ1",
        ),
        (
            "sine = 0.4\ncrank = [2.0, 1.0]",
            "`crank` of [require] must be [least, greatest] of θ1",
        ),
        (
            "sine = 1.0",
            "`sine` of [require] must be at least 0 and less than 1",
        ),
    ] {
        let refused = required(require).unwrap_err();
        assert!(
            refused.starts_with("spec.toml, line ") && refused.contains(reason),
            "{refused}"
        );
    }
}

#[test]
fn lengths_in_stock_are_a_step_or_a_list() {
    let stock = |stock: &str| {
        let objective = format!("maximise = \"size\"\n{stock}");
        spec("kind = \"annulus\"", &objective).map(|spec| spec.stock)
    };
    assert_eq!(stock("").unwrap(), Stock::default());
    assert_eq!(Stock::step(1e-3).unwrap(), Stock::default());
    assert_eq!(
        stock("[stock]\nstep = 0.005").unwrap(),
        Stock::step(5e-3).unwrap()
    );
    assert_eq!(
        stock("[stock]\nlengths = [0.2, 0.1]").unwrap(),
        Stock::list(&[0.1, 0.2]).unwrap()
    );
    for (text, reason) in [
        ("[stock]", "`step` of [stock] must be given"),
        (
            "[stock]\nstep = 0.001\nlengths = [0.1]",
            "`step` of [stock] must be given",
        ),
        (
            "[stock]\nstep = 0.0",
            "`step` of [stock] must be 0.0001 to 20.0 m",
        ),
        (
            "[stock]\nlengths = [0.1, -0.1]",
            "`lengths` of [stock] must be one",
        ),
        (
            "[stock]\nlengths = []",
            "`lengths` of [stock] must be one length or more",
        ),
        (
            "[stock]\nlengths = [100.0]",
            "`lengths` of [stock] must be one",
        ),
    ] {
        let error = stock(text).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}

#[test]
fn a_payload_has_each_motor_alone_and_with_each_gear_the_cheapest_first() {
    let payload = "[payload]\nmass = 0.5\nspeed = 1.0\nacceleration = 5.0\nlink_density = 0.3\n";
    let motor = "[[motor]]\nname = \"M\"\ntorque = 0.5\nspeed = 100.0\ninertia = 1e-5\nprice = 20.0\nmass = 0.3\n";
    let gear = "[[gear]]\nname = \"G\"\nratio = 10.0\nefficiency = 0.8\ntorque = 3.0\nprice = 30.0\nmass = 0.2\n";
    let with = |more: &str| {
        let objective = format!("maximise = \"size\"\n{more}");
        let spec = spec("kind = \"annulus\"", &objective);
        spec.map(|spec| spec.payload)
            .map_err(|error| error.to_string())
    };
    let found = with(&format!("{payload}{motor}{gear}")).unwrap().unwrap();
    let [alone, geared] = &found.drives[..] else {
        panic!("{found:?}")
    };
    assert_eq!(alone.name, "M");
    assert_eq!(
        (&*geared.name, geared.torque, geared.speed),
        ("M with G", 4.0, 10.0)
    );
    assert_eq!(
        (geared.torque_limit, geared.price, geared.mass),
        (3.0, 50.0, 0.5)
    );
    assert!((geared.inertia - 1e-3).abs() < 1e-15);
    for (more, reason) in [
        (payload.to_owned(), "needs [[motor]]"),
        (motor.to_owned(), "`mass` of [payload] is missing"),
        (
            format!("{payload}{motor}{}", gear.replace("0.8", "80.0")),
            "`efficiency` of [[gear]] 1 must be 0.01 to 1.0",
        ),
        (
            format!(
                "{}{motor}",
                payload.replace("acceleration = 5.0", "acceleration = -5.0")
            ),
            "`acceleration` of [payload] must be 0.0 to 10000.0 m/s²",
        ),
    ] {
        let error = with(&more).unwrap_err();
        assert!(error.contains(reason), "{error}");
    }
}
