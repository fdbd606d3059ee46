//! Which attempts are made at a sound result, one after the other.
//!
//! Two things go wrong, and each has its remedy. Samples on sharp edges that are too few leave patches that do not fit
//! together: edges become shorter there, or, where there is no room for that, samples on all sharp edges closer; then the sharp
//! edges there are smoothed over, at last all. Samples of the two sides of a thin wall may be joined so that triangles intersect,
//! and those along a thin rod be too few to go around it: they are drawn again, closer there. Where the result is unsound even so it
//! is mended (`pipeline/mend.rs`); only if that does not help, or there are too many such places, everything is done again, finer
//! there and with the short sharp edges and narrow patches that were left out there.

/// Runs up to a whole result.
pub(super) const MOST_RUNS: u64 = 3;

/// Attempts in a run at patches that fit together with all sharp edges, and further ones without those where they do not.
const MOST_WITH_ALL_CURVES: usize = 3;
const MOST_WITH_CURVES: usize = 6;

/// How many times as many samples there are on curves where edges cannot become shorter.
const CLOSER: f64 = 1.4;

/// If more triangles than this share, and than this number, intersect, are slivers or bridges, single places are not to blame: there
/// are too few vertices for walls so near to each other.
const MOST_OF_TRIANGLES: f64 = 0.05;
const MOST_IN_PLACES: usize = 60;

/// The share of the triangles up to which places are mended, and a third run is made: with more the places grow together, and hardly
/// one gets better.
const MOST_TO_MEND: f64 = 0.01;

/// How good the outcome of an attempt is: less is better, and topology counts first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Score {
    /// Whether its topology is not the wanted one.
    pub other_topology: bool,
    /// Triangles that intersect others where the surface does not.
    pub self_intersections: usize,
    /// Slivers of a whole result.
    pub slivers: usize,
    /// Triangles where the surface is not.
    pub bridges: usize,
}

impl Score {
    pub(super) const SOUND: Score = Score { other_topology: false, self_intersections: 0, slivers: 0, bridges: 0 };

    /// Whether a result of so many `triangles` is unsound at places that are few enough to be mended.
    pub(super) fn is_of_places(&self, triangles: usize) -> bool {
        self.found() > 0 && !self.is_more_than(MOST_TO_MEND, triangles)
    }

    fn is_more_than(&self, share: f64, triangles: usize) -> bool {
        self.found() > MOST_IN_PLACES.max((share * triangles as f64) as usize)
    }

    fn found(&self) -> usize {
        self.self_intersections.max(self.slivers).max(self.bridges)
    }
}

/// What an attempt goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// The seed of its random numbers.
    pub seed: u64,
    /// Samples on feature curves for each spacing of their length.
    pub curve_density: f64,
}

/// What is done where patches do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Remedy {
    /// Edges become shorter there, or all curves are sampled more closely.
    Finer,
    /// The sharp edges there are smoothed over.
    WithoutTornCurves,
    /// All sharp edges are smoothed over.
    Smooth,
}

/// The attempts at one result.
#[derive(Debug, Clone)]
pub(super) struct Attempts {
    seed: u64,
    run: u64,
    /// Attempts of this run at patches that fit together, and the samples on curves for each spacing.
    with_curves: usize,
    curve_density: f64,
    keeps_curves: bool,
    /// Whether samples were drawn again, closer where they were too few.
    are_closer: bool,
}

impl Attempts {
    /// The attempts with the random numbers of `seed`, for a surface with or without sharp edges.
    pub(super) fn new(seed: u64, has_curves: bool) -> Attempts {
        Attempts { seed, run: 0, with_curves: 1, curve_density: 1.0, keeps_curves: has_curves, are_closer: false }
    }

    /// The one to make now.
    pub(super) fn current(&self) -> Attempt {
        // Far from the seeds that people give.
        let seed = self.seed.wrapping_add(self.run << 48);
        Attempt { seed, curve_density: self.curve_density }
    }

    /// Whether sharp edges are kept at all.
    pub(super) fn keeps_curves(&self) -> bool {
        self.keeps_curves
    }

    /// What to do after patches did not fit together, if anything. `are_curves_torn` says whether it is known along which sharp
    /// edges.
    pub(super) fn remedy(&mut self, are_curves_torn: bool) -> Option<Remedy> {
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

    /// Samples curves more closely from now on.
    pub(super) fn sample_curves_closer(&mut self) {
        self.curve_density *= CLOSER;
    }

    /// Whether samples may be drawn again, closer where they are too few: the first ones may, once.
    pub(super) fn may_draw_again(&self) -> bool {
        self.run == 0 && !self.are_closer
    }

    /// Draws samples again. Patches of other samples get as many attempts.
    pub(super) fn draw_again(&mut self) {
        (self.are_closer, self.with_curves) = (true, 1);
    }

    /// Whether to make another run after a result of so many `triangles`; `best` is the best score of all.
    pub(super) fn after_run(&mut self, best: Score, triangles: usize) -> bool {
        // What one run more has not brought near, another one will not either.
        let most = if self.run == 0 { MOST_OF_TRIANGLES } else { MOST_TO_MEND };
        let is_done = best == Score::SOUND || best.is_more_than(most, triangles);
        if is_done || self.run + 1 == MOST_RUNS {
            return false;
        }
        (self.run, self.with_curves) = (self.run + 1, 1);
        true
    }

    /// The run that is being made, from 1.
    pub(super) fn run(&self) -> u64 {
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
