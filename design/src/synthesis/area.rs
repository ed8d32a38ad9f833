//! Work areas: their sample points, and the cells that a proof covers them with.

use super::interval::Interval;
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Halvings of the steps from a sample to the lowest value near it. A step is then 10⁻⁵ of the area.
const HALVINGS: u32 = 12;
/// From how many samples the lowest value of a design is searched.
const STARTS: usize = 8;
/// The most steps of one length.
const MOST_STEPS: usize = 6;
/// The directions of the steps: along both numbers, and across, for a valley that is narrow there.
const SIDES: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
    [1.0, 1.0],
    [-1.0, -1.0],
    [1.0, -1.0],
    [-1.0, 1.0],
];

/// The shape of a work area. Its size scales it, its place moves it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Area {
    /// A ring about the middle of the base. Its size is its width, its place (0, inner radius).
    Annulus,
    /// An upright rectangle. Its size is its width, its place the middle of its lower side.
    Rectangle {
        /// Width by height.
        aspect: f64,
    },
    /// Paths of connected points, or single points, which only have to be reached. The size is the
    /// greater side of the box around them, the place the middle of the box's lower side.
    Paths(Vec<Vec<[f64; 2]>>),
}

/// An area with its size and its place [m] from the middle of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) size: f64,
    pub(super) place: [f64; 2],
}

/// Part of an area, from the middle of the base [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    Box([Interval; 2]),
    /// The box that is in a ring of these radii.
    InRing([Interval; 2], [f64; 2]),
    Segment([Vector2<f64>; 2]),
}

/// How close sample points are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Density {
    Search,
    Check,
}

impl Density {
    /// Intervals along a side, and along both sides of the grid inside.
    fn counts(self) -> [usize; 2] {
        match self {
            Self::Search => [24, 8],
            Self::Check => [120, 30],
        }
    }
}

impl Area {
    /// Paths from points in any position and size, also not finite ones, which are left out.
    pub fn paths(paths: &[Vec<[f64; 2]>]) -> Option<Self> {
        let points = || paths.iter().flatten();
        let bound = |axis: usize, pick: fn(f64, f64) -> f64| points().map(|p| p[axis]).reduce(pick);
        let [x0, x1] = [bound(0, f64::min)?, bound(0, f64::max)?];
        let [y0, y1] = [bound(1, f64::min)?, bound(1, f64::max)?];
        let size = (x1 - x0).max(y1 - y0);
        let unit = |&[x, y]: &[f64; 2]| [(x - 0.5 * (x0 + x1)) / size, (y - y0) / size];
        let of_size_one = paths.iter().map(|path| path.iter().map(unit).collect());
        (size > 0.0 && size.is_finite()).then(|| Self::Paths(of_size_one.collect()))
    }

    /// Points of the area of size 1: of a ring its share of the width and its direction [rad], of paths a number of
    /// [`Vertices`] and 0, else x and y from the place. Of a ring, the first points lie in one direction.
    pub(super) fn samples(&self, density: Density) -> Samples {
        let [side, inside] = density.counts();
        let along = |count: usize| (0..=count).map(move |i| i as f64 / count as f64);
        let points: Vec<[f64; 2]> = match self {
            Self::Annulus => along(inside)
                .flat_map(|turn| along(side).map(move |t| [t, FRAC_PI_2 + TAU * turn]))
                .collect(),
            Self::Rectangle { aspect } => {
                let height = 1.0 / aspect;
                let rims = along(side).flat_map(|t| {
                    [
                        [t - 0.5, 0.0],
                        [t - 0.5, height],
                        [-0.5, t * height],
                        [0.5, t * height],
                    ]
                });
                let grid =
                    along(inside).flat_map(|u| along(inside).map(move |v| [u - 0.5, v * height]));
                rims.chain(grid).collect()
            }
            Self::Paths(paths) => {
                let mut points = Vec::new();
                let mut first = 0.0;
                for path in paths {
                    points.extend(path.first().map(|_| [first, 0.0]));
                    for ends in path.windows(2) {
                        let [from, to] = [ends[0], ends[1]];
                        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
                        let count = (length * side as f64).ceil().max(1.0) as usize;
                        points.extend(along(count).skip(1).map(|t| [first + t, 0.0]));
                        first += 1.0;
                    }
                    first += path.first().map_or(0.0, |_| 1.0);
                }
                points
            }
        };
        let domain = match self {
            Self::Annulus => Domain::Annulus,
            Self::Rectangle { aspect } => Domain::Rectangle {
                height: 1.0 / aspect,
            },
            Self::Paths(paths) => Domain::Paths(Vertices::new(paths)),
        };
        Samples {
            points,
            in_one_direction: side + 1,
            spacing: 1.0 / inside as f64,
            domain,
        }
    }

    /// Cells that cover the area.
    pub(super) fn cells(&self, Placed { size, place }: Placed) -> Vec<Cell> {
        let [x, y] = place;
        match self {
            Self::Annulus => {
                let radii = [y, y + size];
                let halves = [Interval::new(-radii[1], 0.0), Interval::new(0.0, radii[1])];
                let quarter = |h: Interval| halves.map(|v| Cell::InRing([h, v], radii));
                halves.map(quarter).concat()
            }
            Self::Rectangle { aspect } => vec![Cell::Box([
                Interval::new(x - 0.5 * size, x + 0.5 * size),
                Interval::new(y, y + size / aspect),
            ])],
            Self::Paths(paths) => {
                let at = |p: &[f64; 2]| Vector2::new(x + size * p[0], y + size * p[1]);
                let mut cells = Vec::new();
                for path in paths {
                    cells.extend(path.first().map(|p| Cell::Segment([at(p), at(p)])));
                    cells.extend(
                        path.windows(2)
                            .map(|p| Cell::Segment([at(&p[0]), at(&p[1])])),
                    );
                }
                cells
            }
        }
    }
}

/// Sample points of an area of size 1.
pub(super) struct Samples {
    points: Vec<[f64; 2]>,
    in_one_direction: usize,
    /// Distance of neighbours inside, as a share of the domain.
    spacing: f64,
    domain: Domain,
}

/// What the two numbers of a sample mean.
enum Domain {
    /// The share of the width, and the direction [rad].
    Annulus,
    /// x and y of a rectangle as wide as 1.
    Rectangle { height: f64 },
    /// The number of a vertex, or between two numbers the share of the way between both; and 0.
    Paths(Vertices),
}

/// The vertices of all paths, numbered through.
struct Vertices {
    points: Vec<[f64; 2]>,
    /// The first and the last number of each path.
    ends: Vec<[f64; 2]>,
}

impl Vertices {
    fn new(paths: &[Vec<[f64; 2]>]) -> Self {
        let mut next = 0.0;
        let ends = paths.iter().filter(|path| !path.is_empty()).map(|path| {
            let first = next;
            next += path.len() as f64;
            [first, next - 1.0]
        });
        Self {
            ends: ends.collect(),
            points: paths.concat(),
        }
    }

    fn at(&self, number: f64) -> [f64; 2] {
        let from = (number as usize).min(self.points.len() - 1);
        let to = (from + 1).min(self.points.len() - 1);
        let share = number - from as f64;
        std::array::from_fn(|axis| {
            let [from, to] = [self.points[from][axis], self.points[to][axis]];
            from + share * (to - from)
        })
    }

    /// The ends of the path on which this number is.
    fn ends(&self, number: f64) -> [f64; 2] {
        let path = self.ends.partition_point(|[_, last]| *last < number);
        self.ends.get(path).copied().unwrap_or([number; 2])
    }
}

impl Domain {
    /// The ranges of both numbers, of paths those of the point's path.
    fn ranges(&self, point: [f64; 2]) -> [[f64; 2]; 2] {
        match self {
            Self::Annulus => [[0.0, 1.0], [FRAC_PI_2, FRAC_PI_2 + TAU]],
            Self::Rectangle { height } => [[-0.5, 0.5], [0.0, *height]],
            Self::Paths(vertices) => [vertices.ends(point[0]), [0.0; 2]],
        }
    }
}

impl Samples {
    /// The points. About a coaxial arm one direction of a ring is as all others.
    pub(super) fn points(&self, base: f64) -> &[[f64; 2]] {
        match matches!(self.domain, Domain::Annulus) && base == 0.0 {
            true => &self.points[..self.in_one_direction],
            false => &self.points,
        }
    }

    /// Where a point is, from the middle of the base [m].
    pub(super) fn at(&self, [u, v]: [f64; 2], area: Placed) -> Vector2<f64> {
        let Placed {
            size,
            place: [x, y],
        } = area;
        let [u, v] = match &self.domain {
            Domain::Annulus => {
                let (sin, cos) = v.sin_cos();
                return Vector2::new(cos, sin) * (y + size * u);
            }
            Domain::Rectangle { .. } => [u, v],
            Domain::Paths(vertices) => vertices.at(u),
        };
        Vector2::new(x + size * u, y + size * v)
    }

    /// The samples with the lowest values, apart from each other by more than the neighbours inside: where the search for the
    /// lowest point between samples begins.
    pub(super) fn lowest(&self, base: f64, value: impl Fn([f64; 2]) -> f64) -> Vec<[f64; 2]> {
        let points = self.points(base);
        let mut valued: Vec<_> = points.iter().map(|&point| (value(point), point)).collect();
        valued.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut starts: Vec<[f64; 2]> = Vec::new();
        for (_, point) in valued {
            let is_near = |start: &[f64; 2]| {
                let spans = self.domain.ranges(point).map(|[low, high]| high - low);
                (0..2).all(|axis| {
                    (point[axis] - start[axis]).abs() <= 2.0 * self.spacing * spans[axis]
                })
            };
            if !starts.iter().any(is_near) {
                starts.push(point);
            }
            if starts.len() == STARTS {
                break;
            }
        }
        starts
    }

    /// A lower value near a sample, by steps that become shorter: in a search by few, to be quick; in a check the lowest.
    pub(super) fn lowest_near(
        &self,
        density: Density,
        mut point: [f64; 2],
        value: impl Fn([f64; 2]) -> f64,
    ) -> [f64; 2] {
        let (sides, most_steps) = match density {
            Density::Search => (&SIDES[..4], 1),
            Density::Check => (&SIDES[..], MOST_STEPS),
        };
        let ranges = self.domain.ranges(point);
        let spans = ranges.map(|[low, high]| high - low);
        let mut lowest = value(point);
        let mut share = match &self.domain {
            // From one vertex to the next.
            Domain::Paths(_) => 1.0 / spans[0].max(1.0),
            _ => self.spacing,
        };
        for _ in 0..HALVINGS {
            share *= 0.5;
            for _ in 0..most_steps {
                let from = point;
                for side in sides {
                    let tried = std::array::from_fn(|axis| {
                        let [low, high] = ranges[axis];
                        (point[axis] + side[axis] * share * spans[axis]).clamp(low, high)
                    });
                    if tried == point {
                        continue;
                    }
                    let value = value(tried);
                    if value < lowest {
                        (point, lowest) = (tried, value);
                    }
                }
                if point == from {
                    break;
                }
            }
        }
        point
    }
}

impl Cell {
    /// The box around the cell; none if no point of the box is in the area.
    pub(super) fn around(&self) -> Option<[Interval; 2]> {
        match *self {
            Self::Box(sides) => Some(sides),
            Self::InRing([x, y], [inner, outer]) => {
                let radius = x.square().add(y.square()).sqrt();
                (radius.high >= inner && radius.low <= outer).then_some([x, y])
            }
            Self::Segment([from, to]) => {
                Some([Interval::new(from.x, to.x), Interval::new(from.y, to.y)])
            }
        }
    }

    /// Both halves.
    pub(super) fn halves(&self) -> [Self; 2] {
        let split = |[x, y]: [Interval; 2]| {
            let parts = |i: Interval| [[i.low, i.middle()], [i.middle(), i.high]];
            let interval = |[low, high]: [f64; 2]| Interval::new(low, high);
            if x.width() > y.width() {
                parts(x).map(|part| [interval(part), y])
            } else {
                parts(y).map(|part| [x, interval(part)])
            }
        };
        match *self {
            Self::Box(sides) => split(sides).map(Self::Box),
            Self::InRing(sides, radii) => split(sides).map(|half| Self::InRing(half, radii)),
            Self::Segment([from, to]) => {
                let middle = (from + to) * 0.5;
                [Self::Segment([from, middle]), Self::Segment([middle, to])]
            }
        }
    }
}
