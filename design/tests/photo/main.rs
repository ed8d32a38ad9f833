//! Photographs of drawings with known errors, from cameras with perspective and lenses that bend lines.

use fivebar_design::photo::{
    Comparison, Lens, MARK_STEP, MarkDistance, PhotoError, Photograph, Picture, compare,
    local_points, measured_marks,
};
use fivebar_testkit::{Camera, Paper, circle};
use nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};
use std::f64::consts::TAU;

type Strokes = Vec<Vec<Vector2<f64>>>;

/// The marks' places [m], the first one first.
const MARKS: [[f64; 2]; 4] = [[-0.06, 0.11], [0.12, 0.105], [0.118, 0.235], [-0.055, 0.24]];

/// A drawing of waves and circles, 150 mm wide and 100 mm high.
fn drawing() -> Strokes {
    let wave = |count: usize, at: &dyn Fn(f64) -> [f64; 2]| {
        let point = |step: usize| Vector2::from(at(step as f64 / count as f64));
        (0..=count).map(point).collect::<Vec<_>>()
    };
    let mut strokes: Strokes = Vec::new();
    for row in 0..7 {
        let y = 0.125 + 0.016 * f64::from(row);
        strokes.push(wave(400, &|s| {
            [-0.045 + 0.15 * s, y + 0.002 * (9.0 * s).sin()]
        }));
    }
    for column in 0..6 {
        let x = -0.04 + 0.028 * f64::from(column);
        strokes.push(wave(300, &|s| {
            [x + 0.003 * (7.0 * s).cos(), 0.12 + 0.105 * s]
        }));
    }
    let ring = circle([0.03, 0.17], 0.03);
    strokes.push(ring.into_iter().map(Vector2::from).collect());
    strokes
}

/// The error of the arm at a place [m]: waves, and a share of the place itself.
#[derive(Clone, Copy)]
struct Field {
    size: f64,
    stretch: f64,
}

impl Field {
    fn at(self, q: Vector2<f64>) -> Vector2<f64> {
        let wave = |a: f64, b: f64, phase: f64| (TAU * (a * q.x + b * q.y) + phase).sin();
        self.size * Vector2::new(wave(11.0, 4.0, 0.3), wave(-5.0, 13.0, 1.0))
            + self.stretch * Vector2::new(q.x - 0.03, 0.0)
    }
}

/// The drawing on paper: strokes with the field in them, and the marks with `of_marks`.
fn paper(field: Field, of_marks: Field) -> Paper {
    let moved = |field: Field| move |q: &Vector2<f64>| (q + field.at(*q)).into();
    let mut strokes: Vec<Vec<[f64; 2]>> = drawing()
        .iter()
        .map(|stroke| stroke.iter().map(moved(field)).collect())
        .collect();
    for (index, mark) in MARKS.into_iter().enumerate() {
        let centre = moved(of_marks)(&Vector2::from(mark));
        let circles = if index == 0 { 3 } else { 2 };
        strokes.extend((1..=circles).map(|n| circle(centre, MARK_STEP * f64::from(n))));
    }
    Paper {
        strokes,
        pen: 0.5e-3,
        greys: [60.0, 235.0, 150.0],
    }
}

fn camera(lens: f64, turn: f64) -> Camera {
    // Held upright, the camera is turned by a quarter.
    let size = match turn.sin().abs() < 0.7 {
        true => [2000, 1500],
        false => [1500, 2000],
    };
    Camera {
        size,
        target: [0.03, 0.172],
        distance: 0.36,
        turns: [0.3, -0.2, turn],
        focal: 2500.0,
        lens,
        blur: 1.0,
        noise: 4.0,
    }
}

fn photograph(camera: &Camera, paper: &Paper) -> Picture {
    let [width, height] = camera.size;
    Picture::new(width, height, camera.picture(paper)).unwrap()
}

fn compared(picture: &Picture, lens: Lens) -> Result<Comparison, PhotoError> {
    compare(&Photograph {
        picture,
        strokes: &drawing(),
        marks: MARKS.map(Vector2::from),
        measured: None,
        lens,
        window: 1.5e-3,
    })
}

/// The greatest difference of a map from what was drawn [m].
fn worst(found: &Comparison, expected: impl Fn(Vector2<f64>) -> Vector2<f64>) -> f64 {
    let off = found.deviations.iter();
    let off = off.map(|d| (d.error - d.normal.dot(&expected(d.place))).abs());
    off.fold(0.0, f64::max)
}

const EXACT: Field = Field {
    size: 0.0,
    stretch: 0.0,
};

#[test]
fn the_map_is_what_was_put_into_the_strokes() {
    let field = Field {
        size: 0.35e-3,
        stretch: 0.0,
    };
    for (lens, turn) in [(0.0, 0.0), (-0.06, 1.7), (0.05, -3.0)] {
        let picture = photograph(&camera(lens, turn), &paper(field, EXACT));
        let found = compared(&picture, Lens::Unknown).unwrap();
        let off = worst(&found, |q| field.at(q));
        println!(
            "k {lens}: off {:.1} µm, k found {:.4}, {} points, pixel {:.3} mm, lens moves {:.2} mm",
            1e6 * off,
            found.lens,
            found.deviations.len(),
            1e3 * found.pixel,
            1e3 * found.lens_shift
        );
        assert!(off < 0.1e-3, "{off}");
        assert!((found.lens - lens).abs() < 4e-3, "{}", found.lens);
        assert!(found.measured > 0.6 * found.drawn, "{} m", found.measured);
        let known = compared(&picture, Lens::Known(lens)).unwrap();
        assert!(worst(&known, |q| field.at(q)) < 0.07e-3);
        // Without the lens the map is wrong.
        let bent = compared(&picture, Lens::Known(0.0));
        let wrong = bent.map_or(f64::INFINITY, |bent| worst(&bent, |q| field.at(q)));
        assert!(lens == 0.0 || wrong > 0.3e-3, "{wrong}");
    }
}

#[test]
fn an_exact_drawing_has_no_errors() {
    let picture = photograph(&camera(-0.04, 0.15), &paper(EXACT, EXACT));
    let found = compared(&picture, Lens::Unknown).unwrap();
    println!(
        "rms {:.1} µm, worst {:?}",
        1e6 * found.rms,
        found.greatest()
    );
    assert!(found.rms < 0.015e-3, "{}", found.rms);
    assert!(found.greatest().unwrap().error.abs() < 0.06e-3);
}

#[test]
fn what_four_drawn_marks_take_shows_with_measured_ones() {
    // The drawing and its marks are 0.5 % too wide.
    let field = Field {
        size: 0.0,
        stretch: 5e-3,
    };
    let picture = photograph(&camera(-0.05, 0.2), &paper(field, field));
    let drawn = compared(&picture, Lens::Unknown).unwrap();
    assert!(drawn.rms < 0.03e-3, "{}", drawn.rms);
    let places = MARKS.map(Vector2::from);
    let real = places.map(|q| q + field.at(q));
    let pairs = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];
    let distances = pairs.map(|between| MarkDistance {
        between,
        length: (real[between[0]] - real[between[1]]).norm(),
    });
    let found = compare(&Photograph {
        picture: &picture,
        strokes: &drawing(),
        marks: places,
        measured: Some(measured_marks(places, &distances).unwrap()),
        lens: Lens::Unknown,
        window: 1.5e-3,
    })
    .unwrap();
    // The map may differ from the field by a translation and a turn.
    let mean = Vector2::new(0.03, 0.172);
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let row = |n: Vector2<f64>, q: Vector2<f64>| {
        Vector3::new(n.x, n.y, n.y * (q.x - mean.x) - n.x * (q.y - mean.y))
    };
    for d in &found.deviations {
        let row = row(d.normal, d.place);
        normal += row * row.transpose();
        right += row * (d.normal.dot(&field.at(d.place)) - d.error);
    }
    let placement = normal.cholesky().unwrap().solve(&right);
    let off = found.deviations.iter().map(|d| {
        (d.error + row(d.normal, d.place).dot(&placement) - d.normal.dot(&field.at(d.place))).abs()
    });
    let off = off.fold(0.0, f64::max);
    println!("off {:.1} µm, rms {:.1} µm", 1e6 * off, 1e6 * found.rms);
    assert!(off < 0.1e-3, "{off}");
    assert!(found.rms > 0.1e-3, "{}", found.rms);
}

#[test]
fn errors_of_drawn_marks_are_missing_in_the_map_and_nothing_else() {
    let field = Field {
        size: 0.25e-3,
        stretch: 2e-3,
    };
    let picture = photograph(&camera(-0.03, 0.1), &paper(field, field));
    let found = compared(&picture, Lens::Unknown).unwrap();
    // The homography that moves the four marks as the field does, by its eight linear equations.
    let (mut matrix, mut wanted) = (SMatrix::<f64, 8, 8>::zeros(), SVector::<f64, 8>::zeros());
    for (index, mark) in MARKS.map(Vector2::from).into_iter().enumerate() {
        let moved = mark + field.at(mark);
        for axis in 0..2 {
            let row = 2 * index + axis;
            for (column, value) in [mark.x, mark.y, 1.0].into_iter().enumerate() {
                matrix[(row, 3 * axis + column)] = value;
            }
            matrix[(row, 6)] = -moved[axis] * mark.x;
            matrix[(row, 7)] = -moved[axis] * mark.y;
            wanted[row] = moved[axis];
        }
    }
    let h = matrix.lu().solve(&wanted).unwrap();
    let of_marks = |q: Vector2<f64>| {
        let divisor = h[6] * q.x + h[7] * q.y + 1.0;
        let x = (h[0] * q.x + h[1] * q.y + h[2]) / divisor;
        Vector2::new(x, (h[3] * q.x + h[4] * q.y + h[5]) / divisor) - q
    };
    let off = worst(&found, |q| field.at(q) - of_marks(q));
    println!("off {:.1} µm, k found {:.4}", 1e6 * off, found.lens);
    assert!(off < 0.1e-3, "{off}");
}

#[test]
fn places_where_strokes_cross_are_known_in_both_directions() {
    let field = Field {
        size: 0.3e-3,
        stretch: 0.0,
    };
    let picture = photograph(&camera(0.03, 0.0), &paper(field, EXACT));
    let found = compared(&picture, Lens::Unknown).unwrap();
    let points = local_points(&found);
    assert!(points.len() > 20, "{}", points.len());
    // Their pixels are those of the view without lens: of points that were moved by the field.
    let off = points.iter().filter_map(|point| {
        let wanted = found.pixel_of(point.place + field.at(point.place))?;
        Some((point.pixel - wanted).norm() * found.pixel)
    });
    let off = off.fold(0.0, f64::max);
    println!("{} points, off {:.1} µm", points.len(), 1e6 * off);
    assert!(off < 0.1e-3, "{off}");
}

#[test]
fn a_picture_without_marks_or_of_another_job_is_refused() {
    let blank = Picture::new(800, 600, vec![230; 800 * 600]).unwrap();
    assert!(matches!(
        compared(&blank, Lens::Unknown),
        Err(PhotoError::Marks(0, 0))
    ));
    let mut without_first = paper(EXACT, EXACT);
    let strokes = drawing().len();
    without_first.strokes.remove(strokes + 2);
    let picture = photograph(&camera(0.0, 0.0), &without_first);
    assert!(matches!(
        compared(&picture, Lens::Unknown),
        Err(PhotoError::Marks(4, 0))
    ));
    let mut three = paper(EXACT, EXACT);
    three.strokes.pop();
    let picture = photograph(&camera(0.0, 0.0), &three);
    assert!(matches!(
        compared(&picture, Lens::Unknown),
        Err(PhotoError::Marks(3, 1))
    ));
    let mut only_marks = paper(EXACT, EXACT);
    only_marks.strokes.drain(..strokes);
    let picture = photograph(&camera(0.0, 0.0), &only_marks);
    assert!(matches!(
        compared(&picture, Lens::Unknown),
        Err(PhotoError::OtherJob(share)) if share < 0.1
    ));
}

/// A drawing on paper that has grown by 0.5 % in x and 0.3 % in y, and its marks, with errors of the arm besides.
#[test]
fn paper_that_grows_shows_its_scale_in_x_and_y() {
    let growth = [5e-3, 3e-3];
    let grown = |[x, y]: [f64; 2]| [x * (1.0 + growth[0]), y * (1.0 + growth[1])];
    let field = Field {
        size: 0.1e-3,
        stretch: 0.0,
    };
    let mut paper = paper(field, EXACT);
    for point in paper.strokes.iter_mut().flatten() {
        *point = grown(*point);
    }
    let picture = photograph(&camera(0.0, 0.2), &paper);
    let places = MARKS.map(Vector2::from);
    let real = MARKS.map(|mark| Vector2::from(grown(mark)));
    let pairs = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];
    let distances = pairs.map(|between| MarkDistance {
        between,
        length: (real[between[0]] - real[between[1]]).norm(),
    });
    let found = |measured| {
        let compared = compare(&Photograph {
            picture: &picture,
            strokes: &drawing(),
            marks: places,
            measured,
            lens: Lens::Known(0.0),
            window: 1.5e-3,
        });
        compared.unwrap().scales
    };
    let scales = found(Some(measured_marks(places, &distances).unwrap())).unwrap();
    println!("{scales:?}");
    for ((factor, deviation), growth) in scales.factors.iter().zip(scales.deviations).zip(growth) {
        assert!(
            (factor - 1.0 - growth).abs() < 3.0 * deviation,
            "{scales:?}"
        );
        assert!((2e-5..4e-4).contains(&deviation), "{scales:?}");
    }
    // Marks that the arm drew grow with the paper.
    assert_eq!(found(None), None);
}
