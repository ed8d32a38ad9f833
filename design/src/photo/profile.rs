//! Where a stroke's ink lies on a short line across it.

use super::picture::{DARKER, Picture};
use super::view::View;
use nalgebra::Vector2;

/// Pixels between two samples of a line.
const STEP: f64 = 0.5;
/// Most samples of a line.
const MOST: f64 = 400.0;
/// Share of the samples that are darker than the paper's grey.
const PAPER: f64 = 0.8;
/// From this share of the greatest darkness on, a sample is of a line; from the other on, it has weight in
/// the line's middle.
const LINE: f64 = 0.5;
const WEIGHT: f64 = 0.2;
/// From this ratio of their ink on, two strokes on one line are not told apart.
const SECOND: f64 = 0.5;

/// The middle of the ink on the line through `place` along `normal`, from −`half` to `half` [m], weighted
/// with its darkness. None without a stroke, with two, or with one that the end of the line cuts.
pub(super) fn ink_middle(
    picture: &Picture,
    view: &View,
    [place, normal]: [Vector2<f64>; 2],
    half: f64,
) -> Option<f64> {
    let pixel = view.pixel_size(place)?;
    let count = (half / (STEP * pixel)).ceil().clamp(4.0, MOST);
    let step = half / count;
    let steps = count as i32;
    let offset = |index: usize| f64::from(index as i32 - steps) * step;
    let greys = (0..=2 * steps as usize)
        .map(|index| picture.at(view.pixel(place + normal * offset(index))?))
        .collect::<Option<Vec<f64>>>()?;
    let mut sorted = greys.clone();
    sorted.sort_by(f64::total_cmp);
    let paper = sorted[(PAPER * (sorted.len() - 1) as f64) as usize];
    let greatest = paper - sorted[0];
    if greatest < (1.0 - DARKER) * paper {
        return None;
    }
    let dark: Vec<f64> = greys.iter().map(|grey| paper - grey).collect();
    let mut lines: Vec<(f64, f64)> = Vec::new();
    let mut index = 0;
    while index < dark.len() {
        if dark[index] < LINE * greatest {
            index += 1;
            continue;
        }
        let has_weight = |index: &usize| dark[*index] > WEIGHT * greatest;
        let first = (0..index).rev().take_while(has_weight).last();
        let first = first.unwrap_or(index);
        let last = (index..dark.len()).take_while(has_weight).last()?;
        if first == 0 || last + 1 == dark.len() {
            return None;
        }
        let weights = (first..=last).map(|index| (index, dark[index] - WEIGHT * greatest));
        let (ink, moment) = weights.fold((0.0, 0.0), |(ink, moment), (index, weight)| {
            (ink + weight, moment + weight * offset(index))
        });
        lines.push((ink, moment / ink));
        index = last + 1;
    }
    lines.sort_by(|a, b| b.0.total_cmp(&a.0));
    match lines[..] {
        [(_, middle)] => Some(middle),
        [(ink, middle), (second, _), ..] if second < SECOND * ink => Some(middle),
        _ => None,
    }
}
