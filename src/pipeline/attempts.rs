//! Which attempts are made at a sound result, one after the other.
//!
//! Three things go wrong, and each has its remedy. Samples on sharp edges that are too few leave patches that do not fit
//! together: edges become shorter there, or, where there is no room for that, samples on all sharp edges closer; at last the
//! sharp edges are smoothed over. Samples of the two sides of a thin wall may be joined so that triangles intersect: new ones are
//! drawn there, if they are few. If the result is still not sound, it is mended where it went wrong (`pipeline/mend.rs`); only if that
//! does not help, or there are too many such places, everything is drawn again, finer there. If a sound result intersects itself as its input does, but with more faces,
//! everything is drawn again once, with longer edges there.

/// Runs up to a whole result, and times that samples are drawn in each for a mesh that does not intersect itself.
pub(super) const MOST_RUNS: u64 = 3;
const MOST_SAMPLINGS: u64 = 4;

/// If more triangles than this intersect, new samples at their places have hardly fewer: of 13 results with up to 40 such triangles
/// ten came to half as many or fewer, of 14 with more none.
const MOST_TO_REDRAW: usize = 40;

/// Attempts in a run at patches that fit together, before sharp edges are smoothed over.
const MOST_WITH_CURVES: usize = 5;

/// How many times as many samples there are on curves where edges cannot become shorter.
const CLOSER: f64 = 1.4;

/// If more triangles than this share, and than this number, intersect or are slivers, single places are not to blame: there are
/// too few vertices for walls so near to each other.
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
    /// How many more triangles of a whole result intersect others than of the input; 0 if they are more than longer edges could
    /// make up for.
    pub excess: usize,
}

impl Score {
    pub(super) const SOUND: Score = Score { other_topology: false, self_intersections: 0, slivers: 0, excess: 0 };

    /// Whether the only fault is more self-intersections than the input has, where it has some.
    fn is_only_in_excess(&self) -> bool {
        self.excess > 0 && Score { excess: 0, ..*self } == Score::SOUND
    }

    /// Whether a result of so many `triangles` is unsound at places that are few enough to be mended.
    pub(super) fn is_of_places(&self, triangles: usize) -> bool {
        self.found() > 0 && !self.is_more_than(MOST_TO_MEND, triangles)
    }

    fn is_more_than(&self, share: f64, triangles: usize) -> bool {
        self.found() > MOST_IN_PLACES.max((share * triangles as f64) as usize)
    }

    fn found(&self) -> usize {
        self.self_intersections.max(self.slivers)
    }
}

/// What an attempt goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attempt {
    /// The seed of its random numbers.
    pub seed: u64,
    /// Samples on feature curves for each spacing of their length; `None`: sharp edges are smoothed over.
    pub curve_density: Option<f64>,
}

/// What to do with the samples that an attempt has triangulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// Go on with the best so far.
    Continue,
    /// Draw others for the same sharp edges where triangles intersect: the best triangulation counts.
    Resample,
    /// Draw others and treat sharp edges differently: earlier triangulations no longer count.
    Restart,
}

/// The attempts at one result.
#[derive(Debug, Clone)]
pub(super) struct Attempts {
    seed: u64,
    run: u64,
    sampling: u64,
    /// Attempts of this run at patches that fit together, and the samples on curves for each spacing.
    with_curves: usize,
    curve_density: f64,
    keeps_curves: bool,
    /// Whether a run was made with longer edges where the surface intersects itself.
    has_lengthened: bool,
}

impl Attempts {
    /// The attempts with the random numbers of `seed`, for a surface with or without sharp edges.
    pub(super) fn new(seed: u64, has_curves: bool) -> Attempts {
        Attempts {
            seed,
            run: 0,
            sampling: 0,
            with_curves: 1,
            curve_density: 1.0,
            keeps_curves: has_curves,
            has_lengthened: false,
        }
    }

    /// The one to make now.
    pub(super) fn current(&self) -> Attempt {
        // Far from the seeds that people give.
        let seed = self.seed.wrapping_add(self.run << 48).wrapping_add(self.sampling << 40);
        Attempt { seed, curve_density: self.keeps_curves.then_some(self.curve_density) }
    }

    /// What to do after samples were triangulated with `best` as the best score for these sharp edges.
    pub(super) fn after_triangulation(&mut self, best: Score) -> Step {
        if best.other_topology && self.keeps_curves {
            self.keeps_curves = self.with_curves < MOST_WITH_CURVES;
            self.with_curves += 1;
            self.sampling = 0;
            return Step::Restart;
        }
        if !(1..=MOST_TO_REDRAW).contains(&best.self_intersections) || self.sampling + 1 == MOST_SAMPLINGS {
            return Step::Continue;
        }
        self.sampling += 1;
        Step::Resample
    }

    /// Samples curves more closely from now on.
    pub(super) fn sample_curves_closer(&mut self) {
        self.curve_density *= CLOSER;
    }

    /// Whether to make another run after a result of so many `triangles`; `best` is the best score of all.
    pub(super) fn after_run(&mut self, best: Score, triangles: usize) -> bool {
        let is_only_in_excess = best.is_only_in_excess();
        // What one run more has not brought near, another one will not either.
        let most = if self.run == 0 { MOST_OF_TRIANGLES } else { MOST_TO_MEND };
        let is_hopeless = best.is_more_than(most, triangles) || is_only_in_excess && self.has_lengthened;
        let is_done = best == Score::SOUND || is_hopeless;
        if is_done || self.run + 1 == MOST_RUNS {
            return false;
        }
        self.has_lengthened |= is_only_in_excess;
        (self.run, self.sampling, self.with_curves) = (self.run + 1, 0, 1);
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
    const CROSSED: Score = Score { self_intersections: 8, ..SOUND };

    #[test]
    fn what_is_sound_at_once_takes_one_attempt() {
        let mut attempts = Attempts::new(7, true);
        assert_eq!(attempts.current(), Attempt { seed: 7, curve_density: Some(1.0) });
        assert_eq!(attempts.after_triangulation(SOUND), Step::Continue);
    }

    #[test]
    fn curves_are_kept_for_some_attempts_and_smoothed_over_at_last() {
        let mut attempts = Attempts::new(0, true);
        let mut densities = Vec::new();
        while attempts.after_triangulation(TORN) == Step::Restart {
            densities.push(attempts.current().curve_density);
            if densities.len() == 2 {
                attempts.sample_curves_closer();
            }
        }
        assert_eq!(densities, [Some(1.0), Some(1.0), Some(1.4), Some(1.4), None]);
    }

    #[test]
    fn what_intersects_itself_is_drawn_again_a_few_times() {
        let mut attempts = Attempts::new(0, false);
        let mut samplings = 1;
        while attempts.after_triangulation(CROSSED) == Step::Resample {
            samplings += 1;
        }
        assert_eq!(samplings, MOST_SAMPLINGS);
        let often = Score { self_intersections: MOST_TO_REDRAW + 1, ..SOUND };
        assert_eq!(Attempts::new(0, false).after_triangulation(often), Step::Continue);
    }

    #[test]
    fn no_two_attempts_have_the_same_seed_and_there_is_an_end_to_them() {
        let mut attempts = Attempts::new(3, true);
        let mut seeds = vec![attempts.current().seed];
        loop {
            let resample = attempts.after_triangulation(CROSSED) == Step::Resample;
            if !resample && !attempts.after_run(CROSSED, 1000) {
                break;
            }
            seeds.push(attempts.current().seed);
        }
        assert_eq!(seeds.len() as u64, MOST_RUNS * MOST_SAMPLINGS);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len() as u64, MOST_RUNS * MOST_SAMPLINGS);
    }

    #[test]
    fn what_only_intersects_itself_more_often_than_its_input_is_made_again_once() {
        let more = Score { excess: 5, ..SOUND };
        assert!(SOUND < more && more < Score { slivers: 1, ..SOUND });
        let mut attempts = Attempts::new(3, true);
        assert_eq!([0, 1].map(|_| attempts.after_run(more, 1000)), [true, false]);
        let mut attempts = Attempts::new(3, true);
        assert_eq!([CROSSED, more, more].map(|best| attempts.after_run(best, 1000)), [true, true, false]);
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
