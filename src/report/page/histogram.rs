//! Histograms as SVG.

use crate::quality::fields::all_angles;
use crate::report::page::shown::Shown;
use crate::report::rows::percent;
use std::fmt::Write;

/// Size of the plot, and of the margins that hold its labels.
const WIDTH: f64 = 460.0;
const HEIGHT: f64 = 120.0;
const LEFT: f64 = 44.0;
const BOTTOM: f64 = 24.0;
const TOP: f64 = 8.0;
const RIGHT: f64 = 18.0;

/// The quantity on the horizontal axis, and its bins.
struct Axis {
    title: &'static str,
    unit: &'static str,
    from: f64,
    to: f64,
    bins: usize,
    /// Positions and texts of the labels.
    ticks: Vec<(f64, String)>,
}

impl Axis {
    fn bin(&self, x: f64) -> usize {
        let share = (x - self.from) / (self.to - self.from);
        // Values beyond either end are counted in the last bin there.
        ((share * self.bins as f64).max(0.0) as usize).min(self.bins - 1)
    }

    /// Returns the percentage of all values in each bin.
    fn shares(&self, values: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut counts = vec![0usize; self.bins];
        values.into_iter().for_each(|x| counts[self.bin(x)] += 1);
        let all = counts.iter().sum::<usize>().max(1) as f64;
        counts.into_iter().map(|n| 100.0 * n as f64 / all).collect()
    }
}

/// Returns the histograms of all meshes, one SVG per figure.
pub(super) fn histograms(shown: &[Shown]) -> String {
    let tick = |x: f64, unit: &str| (x, format!("{x}{unit}"));
    let angles = Axis {
        title: "Angles",
        unit: "of all triangles",
        from: 0.0,
        to: 180.0,
        bins: 60,
        ticks: [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0].map(|x| tick(x, "°")).into(),
    };
    let quality = Axis {
        title: "Quality Q",
        unit: "of all triangles",
        from: 0.0,
        to: 1.0,
        bins: 50,
        ticks: [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].map(|x| tick(x, "")).into(),
    };
    let is_run = shown.iter().any(|s| s.role == "output");
    let mut lengths = Axis {
        title: "Edge length",
        unit: if is_run { "relative to the target; for the input, to its mean" } else { "relative to the mean" },
        from: 0.0,
        to: 2.5,
        bins: 50,
        ticks: [0.0, 0.5, 1.0, 1.5, 2.0].map(|x| tick(x, "")).into(),
    };
    lengths.ticks.push((2.5, "≥ 2.5".into()));
    let valences = Axis {
        title: "Valences",
        unit: "of interior vertices",
        from: 2.5,
        to: 9.5,
        bins: 7,
        ticks: (3..=9)
            .map(|n| (f64::from(n), ["≤ 3", "4", "5", "6", "7", "8", "≥ 9"][n as usize - 3].into()))
            .collect(),
    };
    let all = |of: &dyn Fn(&Shown) -> Vec<f64>, axis: &Axis| -> Vec<Vec<f64>> {
        shown.iter().map(|s| axis.shares(of(s))).collect()
    };
    let of_valence = |s: &Shown| s.valences.iter().flatten().map(|&n| f64::from(n)).collect();
    [
        lines(&angles, shown, &all(&|s| all_angles(s.mesh).into_flattened(), &angles)),
        lines(&quality, shown, &all(&|s| s.qualities.clone(), &quality)),
        lines(&lengths, shown, &all(&|s| s.lengths.clone(), &lengths)),
        bars(&valences, shown, &all(&of_valence, &valences)),
    ]
    .concat()
}

/// Returns the CSS class that gives each mesh its colour.
pub(super) fn class(shown: &[Shown], number: usize) -> String {
    let inputs = shown.iter().filter(|s| s.report.is_none()).count();
    match number.checked_sub(inputs) {
        None => "input".into(),
        Some(n) => format!("m{}", n % 6),
    }
}

/// Draws an outline for each mesh; the area below is filled if there are at most two meshes, and always for the input.
fn lines(axis: &Axis, shown: &[Shown], series: &[Vec<f64>]) -> String {
    let top = top(series);
    let step = WIDTH / axis.bins as f64;
    let mut inside = String::new();
    for (number, shares) in series.iter().enumerate() {
        let mut path = format!("M{:.1} {:.1}", LEFT, TOP + HEIGHT);
        for (k, share) in shares.iter().enumerate() {
            let _ = write!(path, "V{:.1}H{:.1}", y(*share, top), LEFT + (k + 1) as f64 * step);
        }
        let _ = write!(path, "V{:.1}", TOP + HEIGHT);
        let fill = if series.len() <= 2 || shown[number].report.is_none() { " area" } else { "" };
        let _ = write!(inside, "<path class=\"{}{fill}\" d=\"{path}\"/>", class(shown, number));
    }
    chart(axis, top, shown, &inside)
}

/// Draws a bar for each mesh in each bin.
fn bars(axis: &Axis, shown: &[Shown], series: &[Vec<f64>]) -> String {
    let top = top(series);
    let step = WIDTH / axis.bins as f64;
    let width = 0.8 * step / series.len() as f64;
    let mut inside = String::new();
    for (number, shares) in series.iter().enumerate() {
        for (k, share) in shares.iter().enumerate().filter(|s| *s.1 > 0.0) {
            let x = LEFT + (k as f64 + 0.1) * step + number as f64 * width;
            let (y, class) = (y(*share, top), class(shown, number));
            let (height, share) = (TOP + HEIGHT - y, percent(*share));
            let _ = write!(
                inside,
                "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\">\
                 <title>{share}</title></rect>"
            );
        }
    }
    chart(axis, top, shown, &inside)
}

/// The largest percentage, but at least one percent.
fn top(series: &[Vec<f64>]) -> f64 {
    series.iter().flatten().copied().fold(1.0, f64::max)
}

fn y(share: f64, top: f64) -> f64 {
    TOP + HEIGHT * (1.0 - share / top)
}

/// The largest of 1, 2, 5, 10, 20 and 50 that fits on the axis at least twice.
fn grid(top: f64) -> f64 {
    [50.0, 20.0, 10.0, 5.0, 2.0].into_iter().find(|step| 2.0 * step <= top).unwrap_or(1.0)
}

fn chart(axis: &Axis, top: f64, shown: &[Shown], inside: &str) -> String {
    let Axis { title, unit, from, to, .. } = axis;
    let (right, base) = (LEFT + WIDTH, TOP + HEIGHT);
    let mut out = format!(
        "<figure class=\"chart\"><figcaption><b>{title}</b> {unit}</figcaption>\
         <svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{title} {unit}, a histogram of {} meshes\">",
        right + RIGHT,
        base + BOTTOM,
        shown.len()
    );
    let step = grid(top);
    let mut share = step;
    while share <= top {
        let y = y(share, top);
        let _ = write!(
            out,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>\
             <text class=\"y\" x=\"{:.1}\" y=\"{:.1}\">{share} %</text>",
            LEFT - 5.0,
            y + 3.5
        );
        share += step;
    }
    out.push_str(inside);
    let _ = write!(out, "<line class=\"axis\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{base}\" y2=\"{base}\"/>");
    for (at, label) in &axis.ticks {
        let x = LEFT + WIDTH * (at - from) / (to - from);
        let _ = write!(out, "<text class=\"x\" x=\"{x:.1}\" y=\"{:.1}\">{label}</text>", base + 15.0);
    }
    out.push_str("</svg></figure>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_a_bin() {
        let axis = Axis { title: "", unit: "", from: 0.0, to: 10.0, bins: 5, ticks: vec![] };
        assert_eq!(axis.shares([-3.0, 0.0, 1.9, 2.0, 9.9, 10.0, 12.0, 5.0]), [37.5, 12.5, 12.5, 0.0, 37.5]);
        assert_eq!(axis.shares([]), [0.0; 5]);
    }

    #[test]
    fn the_grid_has_two_lines_or_more() {
        assert_eq!([1.0, 4.0, 9.0, 55.0, 100.0].map(grid), [1.0, 2.0, 2.0, 20.0, 50.0]);
    }
}
