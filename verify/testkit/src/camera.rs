//! A camera over a sheet of paper with strokes of ink: pictures that a comparison must read back.

use std::collections::HashMap;
use std::f64::consts::TAU;

type Point = [f64; 2];

/// A sheet with strokes.
#[derive(Clone, Debug)]
pub struct Paper {
    /// The strokes as they were drawn, each as a line through points [m].
    pub strokes: Vec<Vec<Point>>,
    /// The width of the pen [m].
    pub pen: f64,
    /// The grey of the ink, and that of the paper in the light and at the darkest corner.
    pub greys: [f64; 3],
}

/// A camera over the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The point of the sheet in the middle of the picture [m].
    pub target: Point,
    /// Distance from that point [m].
    pub distance: f64,
    /// Tilts about the picture's x and y, and the turn of the picture [rad].
    pub turns: [f64; 3],
    /// Focal length [pixels].
    pub focal: f64,
    /// Radial distortion of the lens: w = u (1 + k |u|²) in halves of the diagonal.
    pub lens: f64,
    /// Standard deviation of the blur [pixels].
    pub blur: f64,
    /// Standard deviation of the noise [greys].
    pub noise: f64,
}

/// Side of the squares in which strokes are looked up [m].
const SQUARE: f64 = 1e-3;

impl Camera {
    /// The picture, row by row from the top.
    pub fn picture(&self, paper: &Paper) -> Vec<u8> {
        let ink = Ink::of(paper);
        let [width, height] = self.size;
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
        };
        let mut picture = Vec::with_capacity(width * height);
        let [black, bright, dark] = paper.greys;
        for row in 0..height {
            let across = [0, width].map(|column| self.place([column as f64, row as f64 + 0.5]));
            let [left, right] = across;
            let sigma = self.blur * (right[0] - left[0]).hypot(right[1] - left[1]) / width as f64;
            for column in 0..width {
                let pixel = [column as f64 + 0.5, row as f64 + 0.5];
                let place = self.place(pixel);
                let share = 0.5 * (pixel[0] / width as f64 + pixel[1] / height as f64);
                let light = bright + (dark - bright) * share;
                let away = ink.distance(place);
                // The part of the blurred pixel that is over the line.
                let half = 0.5 * paper.pen;
                let cover = normal((half - away) / sigma) - normal((-half - away) / sigma);
                // Three uniform numbers have the variance 1/4.
                let noise = 2.0 * self.noise * (uniform() + uniform() + uniform());
                let grey = light + (black - light) * cover + noise;
                picture.push(grey.round().clamp(0.0, 255.0) as u8);
            }
        }
        picture
    }

    /// The point of the sheet at a pixel [m].
    fn place(&self, pixel: Point) -> Point {
        let middle = self.size.map(|size| 0.5 * size as f64);
        let radius = middle[0].hypot(middle[1]);
        let w = [0, 1].map(|axis| (pixel[axis] - middle[axis]) / radius);
        let seen = w[0].hypot(w[1]);
        // u (1 + k u²) = |w|, by Newton's method.
        let u = (0..6).fold(seen, |u, _| {
            u - (u + self.lens * u.powi(3) - seen) / (1.0 + 3.0 * self.lens * u * u)
        });
        let scale = if seen > 0.0 { u / seen } else { 1.0 };
        let ray = [
            w[0] * scale * radius / self.focal,
            -w[1] * scale * radius / self.focal,
            -1.0,
        ];
        let [about_x, about_y, about_z] = self.turns;
        let turn = |v: [f64; 3]| {
            let v = rotated(v, 0, about_x);
            let v = rotated(v, 1, about_y);
            rotated(v, 2, about_z)
        };
        let back = turn([0.0, 0.0, self.distance]);
        let ray = turn(ray);
        let reach = -back[2] / ray[2];
        [0, 1].map(|axis| self.target[axis] + back[axis] + reach * ray[axis])
    }
}

/// A vector turned about an axis.
fn rotated(v: [f64; 3], axis: usize, angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut turned = v;
    turned[a] = cos * v[a] - sin * v[b];
    turned[b] = sin * v[a] + cos * v[b];
    turned
}

/// The normal distribution, by the logistic function.
fn normal(x: f64) -> f64 {
    1.0 / (1.0 + (-1.702 * x).exp())
}

/// The strokes by the squares that they are near.
struct Ink(HashMap<[i64; 2], Vec<[Point; 2]>>);

impl Ink {
    fn of(paper: &Paper) -> Self {
        let mut squares: HashMap<_, Vec<[Point; 2]>> = HashMap::new();
        for stroke in &paper.strokes {
            for ends in stroke.windows(2) {
                let direction = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
                let parts = (direction[0].hypot(direction[1]) / (0.5 * SQUARE))
                    .ceil()
                    .max(1.0);
                let at =
                    |part: f64| [0, 1].map(|axis| ends[0][axis] + direction[axis] * part / parts);
                for part in 0..parts as usize {
                    let piece = [at(part as f64), at(part as f64 + 1.0)];
                    let [x, y] = square(piece[0]);
                    for near in (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y])) {
                        squares.entry(near).or_default().push(piece);
                    }
                }
            }
        }
        Self(squares)
    }

    /// The distance of the nearest stroke, as far as 1 mm [m].
    fn distance(&self, place: Point) -> f64 {
        let pieces = self.0.get(&square(place)).into_iter().flatten();
        pieces
            .map(|piece| distance(place, piece))
            .fold(SQUARE, f64::min)
    }
}

fn square(place: Point) -> [i64; 2] {
    place.map(|x| (x / SQUARE).floor() as i64)
}

/// The distance of a point from a line between two points.
fn distance(place: Point, [from, to]: &[Point; 2]) -> f64 {
    let direction = [to[0] - from[0], to[1] - from[1]];
    let off = [place[0] - from[0], place[1] - from[1]];
    let square = direction[0] * direction[0] + direction[1] * direction[1];
    let along = ((off[0] * direction[0] + off[1] * direction[1]) / square.max(f64::MIN_POSITIVE))
        .clamp(0.0, 1.0);
    (off[0] - along * direction[0]).hypot(off[1] - along * direction[1])
}

/// A circle as a line through points [m].
pub fn circle(centre: Point, radius: f64) -> Vec<Point> {
    let point = |step: usize| {
        let (sin, cos) = (TAU * step as f64 / 90.0).sin_cos();
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..=92).map(point).collect()
}
