//! Sequence of attempts at a sound result.
//!
//! Two things can go wrong, each with its own remedy.
//!
//! First, patches may not fit together because there are too few samples on sharp edges. Edges then become shorter there or,
//! where there is no room for that, all sharp edges are sampled more densely. If that fails, the sharp edges there are
//! smoothed over, and finally all of them.
//!
//! Second, samples on the two sides of a thin wall may be joined so that triangles intersect, or those along a thin rod may
//! be too few to go around it. Samples are then drawn again, more densely there.
//!
//! A result that is still unsound is mended (`mend.rs`). Only if that does not help, or if there are too many such places,
//! does everything start over, with finer edges there and with the short sharp edges and narrow patches that had been left
//! out there.

pub(in crate::pipeline) mod finished;
pub(in crate::pipeline) mod mend;
pub(in crate::pipeline) mod optimization;
pub(in crate::pipeline) mod rods;
pub(in crate::pipeline) mod triangulation;

/// Maximum number of complete runs.
pub(in crate::pipeline) const MOST_RUNS: u64 = 3;

/// Maximum number of attempts per run that keep all sharp edges, and that keep any. Attempts in between smooth over the
/// sharp edges along which patches do not fit together.
const MOST_WITH_ALL_CURVES: usize = 3;
const MOST_WITH_CURVES: usize = 6;

/// Factor by which the samples on curves increase where edges cannot become shorter.
const CLOSER: f64 = 1.4;

/// If more triangles than this share, and than this number, intersect, are slivers or are bridges, isolated places are not
/// to blame: there are too few vertices for walls so close together.
const MOST_OF_TRIANGLES: f64 = 0.05;
const MOST_IN_PLACES: usize = 60;

/// Largest share of faulty triangles for which places are mended and a third run is made. Above it, the places merge and
/// hardly any of them improves.
const MOST_TO_MEND: f64 = 0.01;

/// Score of the outcome of an attempt: lower is better, and topology counts first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::pipeline) struct Score {
    /// Whether the topology differs from the expected one.
    pub other_topology: bool,
    /// Triangles that intersect others where the surface does not.
    pub self_intersections: usize,
    /// Slivers of the whole mesh.
    pub slivers: usize,
    /// Triangles where the input has no surface.
    pub bridges: usize,
}

impl Score {
    pub(in crate::pipeline) const SOUND: Score =
        Score { other_topology: false, self_intersections: 0, slivers: 0, bridges: 0 };

    /// Returns whether a result with `triangles` triangles is unsound at few enough places to be mended.
    pub(in crate::pipeline) fn is_of_places(&self, triangles: usize) -> bool {
        self.found() > 0 && !self.is_more_than(MOST_TO_MEND, triangles)
    }

    fn is_more_than(&self, share: f64, triangles: usize) -> bool {
        self.found() > MOST_IN_PLACES.max((share * triangles as f64) as usize)
    }

    fn found(&self) -> usize {
        self.self_intersections.max(self.slivers).max(self.bridges)
    }
}

/// Parameters of an attempt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::pipeline) struct Attempt {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of samples on feature curves per spacing of their length.
    pub curve_density: f64,
}

/// Remedy for patches that do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::pipeline) enum Remedy {
    /// Edges become shorter there, or all curves are sampled more densely.
    Finer,
    /// The sharp edges there are smoothed over.
    WithoutTornCurves,
    /// All sharp edges are smoothed over.
    Smooth,
}

/// The attempts at one result.
#[derive(Debug, Clone)]
pub(in crate::pipeline) struct Attempts {
    seed: u64,
    run: u64,
    /// Attempts so far in this run at making patches fit together, and the number of samples on curves per spacing.
    with_curves: usize,
    curve_density: f64,
    keeps_curves: bool,
    /// Whether samples were drawn again, more densely where there were too few.
    are_closer: bool,
}

impl Attempts {
    /// Starts the attempts with the random numbers of `seed`, for a surface with or without sharp edges.
    pub(in crate::pipeline) fn new(seed: u64, has_curves: bool) -> Attempts {
        Attempts { seed, run: 0, with_curves: 1, curve_density: 1.0, keeps_curves: has_curves, are_closer: false }
    }

    /// Returns the parameters of the current attempt.
    pub(in crate::pipeline) fn current(&self) -> Attempt {
        // Far from the seeds that users choose.
        let seed = self.seed.wrapping_add(self.run << 48);
        Attempt { seed, curve_density: self.curve_density }
    }

    /// Returns whether any sharp edges are kept.
    pub(in crate::pipeline) fn keeps_curves(&self) -> bool {
        self.keeps_curves
    }

    /// Returns the next remedy for patches that did not fit together, if any is left. `are_curves_torn` says whether the
    /// sharp edges at fault are known.
    pub(in crate::pipeline) fn remedy(&mut self, are_curves_torn: bool) -> Option<Remedy> {
        if !self.keeps_curves {
            return None;
        }
        let made = self.with_curves;
        self.with_curves += 1;
        if made < MOST_WITH_ALL_CURVES {
            return Some(Remedy::Finer);
        }
        self.keeps_curves = made < MOST_WITH_CURVES && are_curves_torn;
        Some(if self.keeps_curves { Remedy::WithoutTornCurves } else { Remedy::Smooth })
    }

    /// Samples curves more densely from now on.
    pub(in crate::pipeline) fn sample_curves_closer(&mut self) {
        self.curve_density *= CLOSER;
    }

    /// Returns whether samples may be drawn again, more densely where there are too few: once, in the first run.
    pub(in crate::pipeline) fn may_draw_again(&self) -> bool {
        self.run == 0 && !self.are_closer
    }

    /// Draws samples again. The patches of the new samples get the full number of attempts.
    pub(in crate::pipeline) fn draw_again(&mut self) {
        (self.are_closer, self.with_curves) = (true, 1);
    }

    /// Returns whether to make another run after a result with `triangles` triangles; `best` is the best score so far.
    pub(in crate::pipeline) fn after_run(&mut self, best: Score, triangles: usize) -> bool {
        // If the second run has not come close, a third one will not either.
        let most = if self.run == 0 { MOST_OF_TRIANGLES } else { MOST_TO_MEND };
        let is_done = best == Score::SOUND || best.is_more_than(most, triangles);
        if is_done || self.run + 1 == MOST_RUNS {
            return false;
        }
        (self.run, self.with_curves) = (self.run + 1, 1);
        true
    }

    /// Number of the current run, from 1.
    pub(in crate::pipeline) fn run(&self) -> u64 {
        self.run + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: Score = Score::SOUND;
    const TORN: Score = Score { other_topology: true, ..SOUND };
    const INTERSECTING: Score = Score { self_intersections: 8, ..SOUND };

    #[test]
    fn curves_are_kept_for_some_attempts_then_those_that_are_torn_are_smoothed_over_and_at_last_all() {
        let remedies = |has_curves: bool, are_torn: bool| {
            let mut attempts = Attempts::new(0, has_curves);
            std::iter::from_fn(|| attempts.remedy(are_torn)).collect::<Vec<Remedy>>()
        };
        use Remedy::{Finer, Smooth, WithoutTornCurves};
        let torn = [WithoutTornCurves; MOST_WITH_CURVES - MOST_WITH_ALL_CURVES];
        assert_eq!(remedies(true, true), [[Finer; MOST_WITH_ALL_CURVES - 1].as_slice(), &torn, &[Smooth]].concat());
        assert_eq!(remedies(true, false), [[Finer; MOST_WITH_ALL_CURVES - 1].as_slice(), &[Smooth]].concat());
        assert_eq!(remedies(false, true), []);
    }

    #[test]
    fn sharp_edges_that_were_smoothed_over_are_not_kept_in_another_run() {
        let mut attempts = Attempts::new(0, true);
        while attempts.remedy(false).is_some() {}
        assert!(attempts.after_run(INTERSECTING, 1000) && !attempts.keeps_curves());
    }

    #[test]
    fn samples_are_drawn_again_once_and_their_patches_get_as_many_attempts() {
        let mut attempts = Attempts::new(3, true);
        while attempts.remedy(true) == Some(Remedy::Finer) {}
        assert!(attempts.may_draw_again());
        attempts.draw_again();
        assert!(!attempts.may_draw_again());
        assert_eq!(attempts.remedy(true), Some(Remedy::Finer));
        let mut attempts = Attempts::new(3, true);
        assert!(attempts.after_run(INTERSECTING, 1000) && !attempts.may_draw_again());
    }

    #[test]
    fn no_two_runs_have_the_same_seed_and_there_is_an_end_to_them() {
        let mut attempts = Attempts::new(3, true);
        let mut seeds = vec![attempts.current().seed];
        while attempts.after_run(INTERSECTING, 1000) {
            seeds.push(attempts.current().seed);
        }
        assert_eq!(seeds[0], 3);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len() as u64, MOST_RUNS);
    }

    #[test]
    fn what_is_whole_or_intersects_everywhere_is_not_made_again() {
        let again = |score: Score, triangles: usize| Attempts::new(3, true).after_run(score, triangles);
        let crossed = |n: usize| Score { self_intersections: n, ..SOUND };
        assert!(!again(SOUND, 1000) && again(TORN, 1000) && again(Score { slivers: 3, ..SOUND }, 1000));
        assert!(again(crossed(60), 1000) && !again(crossed(61), 1000));
        assert!(again(crossed(500), 10_000) && !again(crossed(501), 10_000));
        let mut attempts = Attempts::new(3, true);
        assert_eq!([300, 101].map(|n| attempts.after_run(crossed(n), 10_000)), [true, false]);
    }
}
