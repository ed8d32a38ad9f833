//! Names of the parts of a linkage, made from the names of links.

use fivebar_design::linkage::{Group, LinkId, Linkage};

/// The driven links, each with the unit of its coordinate.
pub fn driven_links(linkage: &Linkage<f64>) -> impl Iterator<Item = (&str, &'static str)> {
    linkage.elements().iter().filter_map(|element| {
        let unit = match element.group {
            Group::Crank { .. } => "rad",
            Group::Slider { .. } => "m",
            _ => return None,
        };
        let link = element.links().next()?;
        Some((linkage.links()[link.index()].name.as_str(), unit))
    })
}

/// The dyads: index of the element, and the names of its two links.
pub fn dyads(linkage: &Linkage<f64>) -> Vec<(usize, String)> {
    let elements = linkage.elements().iter().enumerate();
    elements
        .filter(|(_, element)| !element.group.is_driven())
        .map(|(i, element)| (i, links_of(linkage, element.links())))
        .collect()
}

/// The names of links, joined: "coupler–rocker".
pub fn links_of(linkage: &Linkage<f64>, links: impl Iterator<Item = LinkId>) -> String {
    let names: Vec<_> = links
        .map(|link| linkage.links()[link.index()].name.as_str())
        .collect();
    names.join("–")
}

/// The names of the reactions, such as "crank on coupler", in the order of a motion's
/// reactions.
pub fn reaction_names(linkage: &Linkage<f64>) -> Vec<String> {
    let name = |link: LinkId| &linkage.links()[link.index()].name;
    let joints = linkage.joint_links();
    joints
        .map(|(from, on)| format!("{} on {}", name(from), name(on)))
        .collect()
}
