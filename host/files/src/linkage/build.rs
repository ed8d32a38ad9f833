//! Builds the linkage of a file, or reports the key that is wrong.

use super::DrivenLinkage;
use super::file::{ElementFile, GuideFile, LinkFile, LinkageFile, PointFile};
use super::limits::{LARGEST, largest, name, sizes};
use crate::refusal::Key;
use crate::source::{FileError, Source};
use fivebar_design::linkage::dyad::{Prp, Rpp, Rpr, Rrp, Rrr};
use fivebar_design::linkage::{BarSection, DriveLaw, Group, Guide, LinkId, Linkage, PointId};
use fivebar_kinematics::dynamics::Link;
use nalgebra::Vector2;
use std::collections::HashMap;

/// Reads a linkage from the text of a file.
pub(super) fn linkage(source: &Source<'_>) -> Result<DrivenLinkage, FileError> {
    let file: LinkageFile = source.parse_no_robot("a linkage")?;
    sizes(source, &file)?;
    let linkage = Linkage::new(Vector2::from(file.gravity))
        .map_err(|error| source.refuse(Key::Top("gravity"), error))?;
    let mut builder = Builder {
        source,
        file: &file,
        linkage,
        points: HashMap::new(),
        links: HashMap::new(),
        laws: Vec::new(),
    };
    builder.build()?;
    let Builder { linkage, laws, .. } = builder;
    largest(source, &linkage)?;
    let tolerance = file.tolerance.checked(source, &linkage)?;
    Ok(DrivenLinkage {
        tolerance,
        linkage,
        laws,
        duration: file.sweep.duration,
        steps: file.sweep.steps,
        name: file.name,
    })
}

/// The linkage under construction, with the points and links defined so far.
struct Builder<'a, 's> {
    source: &'a Source<'s>,
    file: &'a LinkageFile,
    linkage: Linkage<f64>,
    points: HashMap<&'a str, PointId>,
    links: HashMap<&'a str, LinkId>,
    laws: Vec<DriveLaw>,
}

impl<'a> Builder<'a, '_> {
    fn build(&mut self) -> Result<(), FileError> {
        let file = self.file;
        self.links_of_points_exist()?;
        self.links.insert("ground", LinkId::GROUND);
        for (name, &at) in &file.ground {
            self.point(Key::Top("ground"), name, LinkId::GROUND, at)?;
        }
        self.points_on("ground", LinkId::GROUND)?;
        for (index, element) in file.element.iter().enumerate() {
            self.element(index, element)?;
        }
        for (index, load) in file.load.iter().enumerate() {
            let point = self.find(Key::Of("load", index, "point"), &load.point)?;
            self.linkage
                .set_load(point, load.mass, Vector2::from(load.force))
                .map_err(|error| self.source.refuse(Key::Of("load", index, "mass"), error))?;
        }
        for (index, element) in file.element.iter().enumerate() {
            self.sections(index, element)?;
        }
        if self.laws.is_empty() {
            let reason = "needs a driven link: one of kind \"crank\" or \"slider\"";
            return Err(self.source.refuse(Key::Top("element"), reason));
        }
        Ok(())
    }

    /// Sets the mass and inertia of links with a section; their points must be defined.
    fn sections(&mut self, index: usize, element: &ElementFile) -> Result<(), FileError> {
        let key = Key::Of("element", index, "links");
        for link in element.links() {
            let Some(section) = link.section else {
                continue;
            };
            let refuse = |reason: String| {
                let reason = format!("give `{}` a section: {reason}", link.name);
                self.source.refuse(key, reason)
            };
            if link.mass != 0.0 || link.inertia != 0.0 || link.com != [0.0; 2] {
                let reason = "mass, com and inertia follow from it, so leave them out";
                return Err(refuse(reason.into()));
            }
            let section = BarSection {
                area: section.area,
                density: section.density,
            };
            let shaped = self
                .linkage
                .set_section(self.links[link.name.as_str()], section);
            shaped.map_err(|error| refuse(error.to_string()))?;
        }
        Ok(())
    }

    fn links_of_points_exist(&self) -> Result<(), FileError> {
        let links = self.file.element.iter().flat_map(ElementFile::links);
        let names: Vec<&str> = links.map(|link| link.name.as_str()).collect();
        for (index, PointFile { link, .. }) in self.file.point.iter().enumerate() {
            if link != "ground" && !names.contains(&link.as_str()) {
                let known = listed(names.iter().chain([&"ground"]));
                let reason =
                    format!("names a link `{link}`, which does not exist; there are {known}");
                return Err(self.source.refuse(Key::Of("point", index, "link"), reason));
            }
        }
        Ok(())
    }

    /// Adds an element and its links.
    fn element(&mut self, index: usize, element: &'a ElementFile) -> Result<(), FileError> {
        let key = |name| Key::Of("element", index, name);
        match element {
            ElementFile::Crank { drive, .. } => self.drive(key("drive"), drive.law())?,
            ElementFile::Slider { drive, .. } => self.drive(key("drive"), drive.law())?,
            _ => {}
        }
        let group = self.group(index, element)?;
        let joint = element.joint().unwrap_or_default();
        let added = self.linkage.add_group(joint, group).map_err(|error| {
            self.source
                .refuse(key("kind"), format!("is refused: {error}"))
        })?;
        if let Some(id) = added.inner_pin() {
            self.claim_point(key("joint"), joint, id)?;
        }
        for (id, link) in added.links().zip(element.links()) {
            self.link(index, id, link)?;
        }
        Ok(())
    }

    /// The group of links that an element describes.
    fn group(&self, index: usize, element: &ElementFile) -> Result<Group<f64>, FileError> {
        let key = |name| Key::Of("element", index, name);
        Ok(match element {
            ElementFile::Crank { pivot, .. } => {
                let pivot = self.find(key("pivot"), pivot)?;
                Group::Crank { pivot }
            }
            ElementFile::Slider { guide, .. } => {
                let guide = self.guide(key("guide"), guide)?;
                Group::Slider { guide }
            }
            ElementFile::Rrr {
                ends,
                lengths,
                branch,
                ..
            } => Group::Rrr {
                dyad: Rrr {
                    lengths: *lengths,
                    side: *branch,
                },
                ends: self.ends(key("ends"), ends)?,
            },
            ElementFile::Rrp {
                end,
                length,
                guide,
                offset,
                branch,
                ..
            } => Group::Rrp {
                dyad: Rrp {
                    length: *length,
                    offset: *offset,
                    branch: *branch,
                },
                end: self.find(key("end"), end)?,
                guide: self.guide(key("guide"), guide)?,
            },
            ElementFile::Rpr {
                ends,
                offset,
                branch,
                ..
            } => Group::Rpr {
                dyad: Rpr {
                    offset: *offset,
                    branch: *branch,
                },
                ends: self.ends(key("ends"), ends)?,
            },
            ElementFile::Prp {
                guides: [guide1, guide2],
                offsets,
                ..
            } => Group::Prp {
                dyad: Prp { offsets: *offsets },
                guides: [
                    self.guide(key("guides"), guide1)?,
                    self.guide(key("guides"), guide2)?,
                ],
            },
            ElementFile::Rpp {
                end,
                direction,
                guide,
                ..
            } => Group::Rpp {
                dyad: Rpp {
                    direction: Vector2::from(*direction),
                },
                end: self.find(key("end"), end)?,
                guide: self.guide(key("guide"), guide)?,
            },
        })
    }

    /// Names a link, sets its mass and inertia, and adds the points that are fixed in it.
    fn link(&mut self, index: usize, id: LinkId, link: &'a LinkFile) -> Result<(), FileError> {
        let key = Key::Of("element", index, "links");
        name(self.source, key, &link.name)?;
        if self.links.insert(&link.name, id).is_some() {
            let reason = format!("name `{}`, which another link has", link.name);
            return Err(self.source.refuse(key, reason));
        }
        let inertia = Link {
            mass: link.mass,
            com: Vector2::from(link.com),
            inertia: link.inertia,
        };
        self.linkage
            .set_link(id, &link.name, inertia)
            .map_err(|error| {
                let reason = format!("of `{}` are not valid: {error}", link.name);
                self.source.refuse(key, reason)
            })?;
        self.points_on(&link.name, id)
    }

    fn points_on(&mut self, link: &str, id: LinkId) -> Result<(), FileError> {
        let file = self.file;
        for (index, point) in file.point.iter().enumerate() {
            if point.link == link {
                self.point(Key::Of("point", index, "name"), &point.name, id, point.at)?;
            }
        }
        Ok(())
    }

    fn point(
        &mut self,
        key: Key,
        name: &'a str,
        link: LinkId,
        at: [f64; 2],
    ) -> Result<(), FileError> {
        let id = self
            .linkage
            .add_point(name, link, Vector2::from(at))
            .map_err(|error| self.source.refuse(key, format!("`{name}`: {error}")))?;
        self.claim_point(key, name, id)
    }

    fn claim_point(&mut self, key: Key, point: &'a str, id: PointId) -> Result<(), FileError> {
        name(self.source, key, point)?;
        match self.points.insert(point, id) {
            None => Ok(()),
            Some(_) => {
                let reason = format!("`{point}` is the name of another point");
                Err(self.source.refuse(key, reason))
            }
        }
    }

    fn drive(&mut self, key: Key, law: DriveLaw) -> Result<(), FileError> {
        let DriveLaw {
            start,
            speed,
            amplitude,
            frequency,
            phase,
        } = law;
        let is_valid = |value: &f64| value.abs() <= LARGEST;
        if ![start, speed, amplitude, frequency, phase]
            .iter()
            .all(is_valid)
        {
            let reason = format!("must hold finite numbers below {LARGEST:e}");
            return Err(self.source.refuse(key, reason));
        }
        self.laws.push(law);
        Ok(())
    }

    fn ends(&self, key: Key, [first, second]: &[String; 2]) -> Result<[PointId; 2], FileError> {
        Ok([self.find(key, first)?, self.find(key, second)?])
    }

    fn guide(&self, key: Key, guide: &GuideFile) -> Result<Guide<f64>, FileError> {
        Ok(Guide {
            through: self.find(key, &guide.through)?,
            direction: Vector2::from(guide.direction),
        })
    }

    /// The point with this name, if it is defined so far.
    fn find(&self, key: Key, name: &str) -> Result<PointId, FileError> {
        if let Some(&id) = self.points.get(name) {
            return Ok(id);
        }
        let elements = self.file.element.iter();
        let mut later = elements.filter_map(ElementFile::joint);
        let known_later =
            later.any(|joint| joint == name) || self.file.point.iter().any(|p| p.name == name);
        let reason = if known_later {
            format!(
                "names `{name}`, which is known only once this or a later element is solved: \
                 an element can use points of earlier elements only, so change their order, or \
                 remove the circular reference"
            )
        } else {
            let known = listed(self.points.keys());
            format!(
                "names a point `{name}`, which the file does not define; defined so far: {known}"
            )
        };
        Err(self.source.refuse(key, reason))
    }
}

/// At most twelve names, sorted, for a message.
fn listed<'n>(names: impl Iterator<Item = &'n &'n str>) -> String {
    let mut names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    names.sort_unstable();
    if names.len() > 12 {
        names.truncate(12);
        names.push("…".into());
    }
    if names.is_empty() {
        return "none".into();
    }
    names.join(", ")
}
