//! Changes to a built linkage: clearances of its pins, and bars whose mass follows from their
//! length.

use super::check::{LinkageError, not_negative};
use super::clearance::Clearance;
use super::group::{Group, LinkId};
use super::model::{Element, Linkage};
use super::section::BarSection;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl<S: Scalar> Element<S> {
    /// The offsets of its pins [m], in the order of its joints; zero for a slide.
    #[inline]
    pub(super) fn clearance_offsets(&self) -> [Vector2<S>; 3] {
        self.clearances
            .map(|gap| gap.map_or(Vector2::zeros(), |gap| gap.offset()))
    }
}

impl<S: Scalar> Linkage<S> {
    /// For each joint the index of its element and its index in that element, in the order
    /// of [`Linkage::joint_links`].
    fn joint_indices(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let elements = self.elements.iter().enumerate();
        elements
            .flat_map(|(index, element)| (0..element.group.pins().len()).map(move |k| (index, k)))
    }

    /// Whether each joint is a pin, in the order of [`Linkage::joint_links`].
    pub fn pins(&self) -> impl Iterator<Item = bool> + '_ {
        let elements = self.elements.iter();
        elements.flat_map(|element| element.group.pins().iter().copied())
    }

    /// The clearance of each joint, in the order of [`Linkage::joint_links`].
    pub fn clearances(&self) -> impl Iterator<Item = Option<Clearance<S>>> + '_ {
        let indices = self.joint_indices();
        indices.map(|(element, k)| self.elements[element].clearances[k])
    }

    /// Moves a joint's pin away from the centre of its bearing. `joint_index` is one in the
    /// order of [`Linkage::joint_links`].
    ///
    /// # Errors
    /// `NotAPin` for a slide or an index beyond the last joint, `Clearance` for a radius below
    /// zero or a number that is not finite.
    pub fn set_clearance(
        &mut self,
        joint_index: usize,
        clearance: Clearance<S>,
    ) -> Result<(), LinkageError> {
        let (element, k) = self
            .joint_indices()
            .nth(joint_index)
            .ok_or(LinkageError::NotAPin)?;
        let element = &mut self.elements[element];
        if !element.group.pins()[k] {
            return Err(LinkageError::NotAPin);
        }
        if !clearance.angle.is_finite() || not_negative(clearance.radius).is_err() {
            return Err(LinkageError::Clearance);
        }
        element.clearances[k] = Some(clearance);
        Ok(())
    }

    /// Makes a link a slender bar: in a dyad from its first to its second joint, in a crank
    /// from the pivot to the first other point. Add the points of a crank before.
    ///
    /// # Errors
    /// `Inertia` for numbers below zero or not finite, `NotABar` for a link without a length.
    pub fn set_section(
        &mut self,
        link: LinkId,
        section: BarSection<S>,
    ) -> Result<(), LinkageError> {
        not_negative(section.area)?;
        not_negative(section.density)?;
        let end = self.bar_end(link).ok_or(LinkageError::NotABar)?;
        let named = &mut self.links[link.0];
        named.section = Some(section);
        named.inertia = section.bar(end);
        Ok(())
    }

    /// Computes the inertia of the bars again, from their present lengths.
    pub(super) fn update_bar_inertias(&mut self) {
        for link in 0..self.links.len() {
            let section = self.links[link].section;
            if let Some((section, end)) = section.zip(self.bar_end(LinkId(link))) {
                self.links[link].inertia = section.bar(end);
            }
        }
    }

    /// The end of a link's bar [m], in the link's frame.
    fn bar_end(&self, link: LinkId) -> Option<Vector2<S>> {
        let mut elements = self.elements.iter();
        let element = elements.find(|element| element.links().any(|own| own == link))?;
        let index = link.0 - element.first_link.0;
        let length = match &element.group {
            Group::Rrr { dyad, .. } => dyad.lengths[index],
            Group::Rrp { dyad, .. } if index == 0 => dyad.length,
            Group::Crank { .. } => {
                let own = self.points.iter().filter(|point| point.link == link);
                return own
                    .filter_map(|point| point.local)
                    .find(|local| local.length_squared() > S::ZERO);
            }
            _ => return None,
        };
        Some(Vector2::new(length, S::ZERO))
    }
}
