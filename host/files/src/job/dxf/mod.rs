//! DXF drawings as jobs: lines, polylines, arcs, circles, ellipses, splines and blocks of these, each layer with
//! its pen.
//!
//! The plane is that of x and y as the file has it. Entities that are not read are noted by their
//! names.

mod blocks;
mod curves;
mod entity;

use super::drawing::{self, Pen, Stroke, within_earth};
use super::{Job, JobError, JobOptions, Placement, Step, Warning, WarningKind};
use crate::budget::Budget;
use blocks::{Block, Frame};
use curves::Spline;
use entity::{Entity, entities};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Most kinds of entities that are named as left out.
const MOST_KINDS: usize = 20;
/// A normal is ±z up to this.
const UPRIGHT: f64 = 1e-6;

pub(super) fn interpret(
    text: &str,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let unreadable = |why| JobError::Drawing(format!("the DXF cannot be read: {why}"));
    let entities = entities(text.trim_start()).map_err(unreadable)?;
    let mut drawing = Drawing {
        tolerance: options.tolerance,
        unit: None,
        hidden: BTreeSet::new(),
        blocks: BTreeMap::new(),
        pens: Vec::new(),
        pen_of: BTreeMap::new(),
        budget: Budget::points(),
        left_out: BTreeMap::new(),
    };
    drawing.file(&entities).map_err(unreadable)?;
    let left_out = drawing.left_out.into_iter().map(|(name, count)| Warning {
        count,
        ..Warning::at(0, WarningKind::LeftOut(name))
    });
    let mut notes: Vec<Warning> = left_out.collect();
    if drawing.unit.is_none() {
        let what = "the DXF states no unit ($INSUNITS): its numbers are read as millimetres";
        notes.push(Warning::at(0, WarningKind::Drawing(what.into())));
    }
    let job = drawing::job(drawing.pens, notes, placement, options)?;
    if job.steps.iter().any(Step::draws) {
        Ok(job)
    } else {
        let reason = "the DXF has no visible lines, polylines, arcs, circles, ellipses or splines";
        Err(JobError::Drawing(reason.into()))
    }
}

/// A drawing that is being read.
struct Drawing<'a> {
    /// Greatest distance of lines from curves [m].
    tolerance: f64,
    /// Metres per unit, if it is stated.
    unit: Option<f64>,
    /// The layers that are off or frozen.
    hidden: BTreeSet<&'a str>,
    blocks: BTreeMap<&'a str, Block<'a>>,
    pens: Vec<Pen>,
    /// The numbers of the pens by their layers.
    pen_of: BTreeMap<&'a str, usize>,
    /// Points, and entities of blocks that are drawn again.
    budget: Budget,
    /// What is not drawn, with its count.
    left_out: BTreeMap<String, u32>,
}

impl<'a> Drawing<'a> {
    fn file(&mut self, entities: &'a [Entity<'a>]) -> Result<(), String> {
        let mut section = "";
        let mut rest = entities.iter();
        while let Some(entity) = rest.next() {
            match (section, entity.kind) {
                (_, "SECTION") => {
                    section = entity.text(2).unwrap_or_default();
                    if section == "HEADER" {
                        self.header(entity)?;
                    }
                }
                (_, "ENDSEC") => section = "",
                ("TABLES", "LAYER") => self.layer(entity)?,
                ("BLOCKS", "BLOCK") => {
                    let inside = rest.as_slice();
                    let ends = |it: &Entity<'_>| ["ENDBLK", "ENDSEC"].contains(&it.kind);
                    let count = inside.iter().take_while(|it| !ends(it)).count();
                    let block = Block::new(entity, &inside[..count])?;
                    self.blocks.entry(block.name).or_insert(block);
                    rest = inside[count..].iter();
                }
                ("ENTITIES", _) => {
                    let inside = rest.as_slice();
                    let count = inside.iter().take_while(|it| it.kind != "ENDSEC").count();
                    let first = entities.len() - inside.len() - 1;
                    self.all(&entities[first..=first + count], &Frame::DRAWING)?;
                    rest = inside[count..].iter();
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The entities of the drawing or of a block.
    fn all(&mut self, entities: &'a [Entity<'a>], frame: &Frame<'a>) -> Result<(), String> {
        let mut rest = entities.iter();
        while let Some(entity) = rest.next() {
            match entity.kind {
                "POLYLINE" => {
                    let vertices = rest.as_slice();
                    let count = vertices.iter().take_while(|it| it.kind == "VERTEX").count();
                    self.polyline(entity, &vertices[..count], frame)?;
                    rest = vertices[count..].iter();
                }
                "SEQEND" => {}
                "INSERT" => self.insert(entity, frame)?,
                _ => self.entity(entity, frame)?,
            }
        }
        Ok(())
    }

    /// A block, once or in columns and rows.
    fn insert(&mut self, insert: &Entity<'a>, frame: &Frame<'a>) -> Result<(), String> {
        let Some(view) = self.view(insert, frame)? else {
            return Ok(());
        };
        let name = insert.text(2).unwrap_or_default();
        let Some(&block) = self.blocks.get(name) else {
            self.leave_out("INSERT of a block that is not in the file");
            return Ok(());
        };
        let counts = frame.counts(insert)?;
        let [columns, rows] = counts;
        self.budget
            .take(columns * rows * (1 + block.entities.len()))?;
        for copy in frame.copies(insert, &block, counts, view.mirrors)? {
            self.all(block.entities, &copy)?;
        }
        Ok(())
    }

    /// The variables: each is a group 9 with its name, and its value.
    fn header(&mut self, header: &Entity<'_>) -> Result<(), String> {
        let mut groups = header.groups.iter();
        groups.find(|group| **group == (9, "$INSUNITS"));
        let Some(&(code, value)) = groups.next() else {
            return Ok(());
        };
        self.unit = match header.parsed(code, value)? as i64 {
            0 => None,
            1 => Some(25.4e-3),
            2 => Some(0.3048),
            4 => Some(1e-3),
            5 => Some(1e-2),
            6 => Some(1.0),
            8 => Some(25.4e-9),
            9 => Some(25.4e-6),
            10 => Some(0.9144),
            13 => Some(1e-6),
            14 => Some(0.1),
            _ => {
                return Err(format!(
                    "its unit is {value}; set millimetres ($INSUNITS 4)"
                ));
            }
        };
        Ok(())
    }

    fn layer(&mut self, layer: &'a Entity<'a>) -> Result<(), String> {
        let is_off = layer.number(62)?.is_some_and(|colour| colour < 0.0);
        if let Some(name) = layer.text(2)
            && (is_off || layer.flags(70)? & 1 != 0)
        {
            self.hidden.insert(name);
        }
        Ok(())
    }

    fn entity(&mut self, entity: &Entity<'a>, frame: &Frame<'a>) -> Result<(), String> {
        let Some(view) = self.view(entity, frame)? else {
            return Ok(());
        };
        let place = |codes: [i32; 2]| -> Result<[f64; 2], String> {
            view.place([entity.needed(codes[0])?, entity.needed(codes[1])?])
        };
        // Their points are the world's, whatever their normal.
        let world = view.world();
        let tolerance = self.tolerance / frame.growth().max(1.0);
        let budget = &mut self.budget;
        budget.take(2)?;
        let stroke: Stroke = match entity.kind {
            "LINE" => vec![
                world.place([entity.needed(10)?, entity.needed(20)?])?,
                world.place([entity.needed(11)?, entity.needed(21)?])?,
            ],
            "LWPOLYLINE" => {
                let mut vertices: Vec<([f64; 2], f64)> = Vec::new();
                for &(code, value) in &entity.groups {
                    match (code, vertices.last_mut()) {
                        (10, _) => vertices.push(([entity.parsed(code, value)?, 0.0], 0.0)),
                        (20, Some(last)) => last.0[1] = entity.parsed(code, value)?,
                        (42, Some(last)) => last.1 = entity.parsed(code, value)?,
                        _ => {}
                    }
                }
                view.polyline(vertices, entity.flags(70)? & 1 != 0, tolerance, budget)?
            }
            "CIRCLE" | "ARC" => {
                let angles = match entity.kind {
                    "ARC" => [entity.needed(50)?, entity.needed(51)?].map(f64::to_radians),
                    _ => [0.0, TAU],
                };
                let angles = match view.mirrors {
                    true => [TAU / 2.0 - angles[1], TAU / 2.0 - angles[0]],
                    false => angles,
                };
                let [radius, _] = world.place([entity.needed(40)?, 0.0])?;
                curves::arc(place([10, 20])?, radius, angles, tolerance, budget)?
            }
            "ELLIPSE" => {
                let center = world.place([entity.needed(10)?, entity.needed(20)?])?;
                let major = world.place([entity.needed(11)?, entity.needed(21)?])?;
                let ratio = entity.needed(40)?.clamp(-1.0, 1.0);
                let ratio = if view.mirrors { -ratio } else { ratio };
                let minor = [-ratio * major[1], ratio * major[0]];
                let from = entity.number(41)?.unwrap_or(0.0).rem_euclid(TAU);
                let sweep = (entity.number(42)?.unwrap_or(TAU) - from).rem_euclid(TAU);
                let sweep = if sweep < 1e-9 { TAU } else { sweep };
                let angles = [from, from + sweep];
                curves::ellipse(center, [major, minor], angles, tolerance, budget)?.collect()
            }
            "SPLINE" if entity.text(10).is_some() => {
                let [x, y] = [entity.numbers(10)?, entity.numbers(20)?];
                let points: Result<Vec<_>, String> = x
                    .iter()
                    .zip(&y)
                    .map(|(&x, &y)| world.place([x, y]))
                    .collect();
                let points = points?;
                let weights = match entity.numbers(41)? {
                    none if none.is_empty() => vec![1.0; points.len()],
                    weights => weights,
                };
                let spline = Spline {
                    degree: entity.flags(71)?.clamp(0, 99) as usize,
                    knots: entity.numbers(40)?,
                    points,
                    weights,
                };
                if !spline.is_valid() {
                    return Err(entity.wrong("its degree, knots, points and weights do not fit"));
                }
                spline.stroke(tolerance, budget)?
            }
            other => {
                self.leave_out(other);
                return Ok(());
            }
        };
        self.add(entity, stroke, frame)
    }

    fn polyline(
        &mut self,
        entity: &Entity<'a>,
        vertices: &[Entity<'_>],
        frame: &Frame<'a>,
    ) -> Result<(), String> {
        let Some(view) = self.view(entity, frame)? else {
            return Ok(());
        };
        let flags = entity.flags(70)?;
        if flags & (16 | 64) != 0 {
            self.leave_out("POLYLINE of a surface");
            return Ok(());
        }
        let mut points = Vec::new();
        for vertex in vertices {
            // 16: a point of the frame of a spline, beside those of its curve.
            if vertex.flags(70)? & 16 == 0 {
                let place = [vertex.needed(10)?, vertex.needed(20)?];
                points.push((place, vertex.number(42)?.unwrap_or(0.0)));
            }
        }
        let tolerance = self.tolerance / frame.growth().max(1.0);
        let budget = &mut self.budget;
        let stroke = view.polyline(points, flags & 1 != 0, tolerance, budget)?;
        self.add(entity, stroke, frame)
    }

    /// How the coordinates of an entity are read; none if it is not drawn.
    fn view(&mut self, entity: &Entity<'a>, frame: &Frame<'a>) -> Result<Option<View>, String> {
        let layer = frame.layer_of(entity);
        // 60: invisible; 67: on a sheet, not in the model.
        if entity.flags(60)? & 1 != 0 || self.hidden.contains(layer) {
            return Ok(None);
        }
        if entity.flags(67)? != 0 {
            self.leave_out("what lies on sheets");
            return Ok(None);
        }
        let normal = [210, 220].map(|code| entity.number(code));
        let [x, y] = normal.map(|it| it.map(|it| it.unwrap_or(0.0)));
        if x?.abs() > UPRIGHT || y?.abs() > UPRIGHT {
            self.leave_out("what is tilted in space");
            return Ok(None);
        }
        Ok(Some(View {
            unit: self.unit.unwrap_or(1e-3),
            mirrors: entity.number(230)?.is_some_and(|z| z < 0.0),
        }))
    }

    fn leave_out(&mut self, what: &str) {
        let is_known = self.left_out.contains_key(what);
        let what = match is_known || self.left_out.len() < MOST_KINDS {
            true => what,
            false => "entities of other kinds",
        };
        *self.left_out.entry(what.into()).or_default() += 1;
    }

    fn add(
        &mut self,
        entity: &Entity<'a>,
        mut stroke: Stroke,
        frame: &Frame<'a>,
    ) -> Result<(), String> {
        let unit = self.unit.unwrap_or(1e-3);
        for point in &mut stroke {
            let placed = frame.place(point.map(|metres| metres / unit));
            let [x, y] = placed.map(|it| within_earth(unit * it));
            *point = [x?, y?];
        }
        let name = frame.layer_of(entity);
        let index = *self.pen_of.entry(name).or_insert(self.pens.len());
        if index == self.pens.len() {
            let (name, strokes) = (name.into(), Vec::new());
            self.pens.push(Pen { name, strokes });
        }
        if stroke.len() > 1 {
            self.pens[index].strokes.push(stroke);
        }
        Ok(())
    }
}

/// How coordinates become metres.
#[derive(Clone, Copy)]
struct View {
    unit: f64,
    /// Whether the normal is −z, from which x is seen mirrored.
    mirrors: bool,
}

impl View {
    fn world(self) -> Self {
        Self {
            mirrors: false,
            ..self
        }
    }

    fn place(self, [x, y]: [f64; 2]) -> Result<[f64; 2], String> {
        let x = if self.mirrors { -x } else { x };
        let [x, y] = [x, y].map(|it| within_earth(self.unit * it));
        Ok([x?, y?])
    }

    /// Vertices, each with the bulge of the piece behind it, as points.
    fn polyline(
        self,
        vertices: Vec<([f64; 2], f64)>,
        is_closed: bool,
        tolerance: f64,
        budget: &mut Budget,
    ) -> Result<Stroke, String> {
        let mut stroke = Vec::new();
        let mut bulge = 0.0;
        let first = vertices.first().copied().filter(|_| is_closed);
        for (point, next) in vertices.into_iter().chain(first) {
            let to = self.place(point)?;
            budget.take(1)?;
            curves::bulge(&mut stroke, to, bulge, tolerance, budget)?;
            bulge = if self.mirrors { -next } else { next };
        }
        Ok(stroke)
    }
}
