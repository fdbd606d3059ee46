//! The randomized linear scan (paper, algorithm 1): every candidate is examined once, in random order, and kept if it
//! changes the spectrum of those kept so far by more than ε.
//!
//! Space is divided into blocks, whose candidates are scanned in random order. Blocks are scanned in eight turns; blocks of
//! the same turn are farther apart than the kernel reaches. So the blocks of a turn run in parallel, the result does not
//! depend on the number of threads, and look-ups stay in the cache however many points there are.
//!
//! The width of a candidate's kernel is proportional to the wanted size there; cells fit the widest kernel. Where more
//! than the position counts (a [`Lift`]), the kernel has more dimensions; the cells still divide space, since further
//! dimensions only make distances larger.
//!
//! Only neighbours on the same patch that face the same way count for a candidate, so two sheets that nearly touch are
//! sampled independently.
//!
//! Cost: linear in the candidates; nine in ten are settled by their nearest neighbours.

use crate::base::error::Result;
use crate::base::monitor::{Monitor, check};
use crate::base::parallel;
use crate::base::rng::{Address, Stage, bits_at};
use crate::geom::vector::{difference, distance_squared};
use crate::spectral::candidates::Candidate;
use crate::spectral::lattice::{TURNS, place_of, turn_of};
use crate::spectral::measure::{MOST_NEIGHBOURS, Measure, RADIUS};
use crate::surface::domain::{Domain, Sample};
use crate::surface::lift::Lift;
use glam::{DVec3, IVec3};
use rayon::slice::ParallelSliceMut;
use rustc_hash::FxHashMap;

/// The threshold ε (paper, section 6.3).
pub const EPSILON: f64 = 0.5;

/// Number of cells of a block along each axis. A block of eight holds about a hundred samples, enough to outweigh its halo.
pub const BLOCK: i32 = 8;

/// Number of cells around a block within the kernel's reach: a cell is half of [`RADIUS`] wide, in units of the widest σ.
const HALO: i32 = 2;

/// Number of cells of a block and its halo along each axis.
const SPAN: i32 = BLOCK + 2 * HALO;

/// Squared distance, in units of σ, within which a single neighbour makes s = 1 - k² at most ε: ln(1 / (1 - ε)) / 2.
pub(super) const TOO_NEAR: f64 = std::f64::consts::LN_2 / 2.0;

/// Number of members of a patch up to which all are examined instead of the cells: no more than the measure uses in any
/// case.
const FEW: usize = MOST_NEIGHBOURS;

/// Marks the end of a cell's list.
const END: u32 = u32::MAX;

/// Returns the samples that the scan keeps: first `fixed`, which are always kept, then candidates.
///
/// `sigma` is σp where the wanted size is 1, in the units of the domain. The result is the same for any number of threads.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn linear_scan(
    domain: &Domain,
    candidates: &[Candidate],
    fixed: &[Sample],
    sigma: f64,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Vec<Sample>> {
    let choices = OnDomain { domain, candidates };
    let chosen = scan_lifted::<3>(&choices, fixed, Kernel { sigma, lift: Lift::NONE }, seed, monitor)?;
    Ok(fixed.iter().copied().chain(chosen.into_iter().map(|i| choices.sample(i))).collect())
}

/// A Gaussian kernel over samples of a surface.
#[derive(Clone, Copy)]
pub struct Kernel<'a> {
    /// σp where the wanted size is 1, in the units of the domain.
    pub sigma: f64,
    /// What counts besides the position.
    pub lift: Lift<'a>,
}

/// The points that a scan chooses from.
pub trait Choices: Sync {
    /// The number of choices.
    fn count(&self) -> usize;
    /// The choice with this number.
    fn sample(&self, number: u32) -> Sample;
    /// The address for which its random numbers are drawn.
    fn address(&self, number: u32) -> Address;
    /// The patch of the surface that a sample lies on: only samples of the same patch are neighbours.
    fn patch_of(&self, sample: &Sample) -> u32;
    /// The largest size that is wanted anywhere.
    fn largest_size(&self) -> f64;
    /// The width of a cell for a kernel of width `sigma`: half of its reach, or more.
    fn cell(&self, sigma: f64) -> f64 {
        sigma * self.largest_size() * RADIUS / 2.0
    }
}

/// Candidates on a domain.
pub struct OnDomain<'a> {
    /// The domain.
    pub domain: &'a Domain,
    /// Points on it.
    pub candidates: &'a [Candidate],
}

impl Choices for OnDomain<'_> {
    fn count(&self) -> usize {
        self.candidates.len()
    }

    #[inline]
    fn sample(&self, number: u32) -> Sample {
        self.candidates[number as usize].sample(self.domain)
    }

    #[inline]
    fn address(&self, number: u32) -> Address {
        self.candidates[number as usize].address(self.domain)
    }

    #[inline]
    fn patch_of(&self, sample: &Sample) -> u32 {
        self.domain.patch_of(sample.triangle)
    }

    fn largest_size(&self) -> f64 {
        self.domain.size_range()[1]
    }
}

/// Given samples, of size 1, on a domain or on an unknown surface.
pub struct Given<'a> {
    /// The samples.
    pub samples: &'a [Sample],
    /// Their domain.
    pub domain: Option<&'a Domain>,
}

impl Choices for Given<'_> {
    fn count(&self) -> usize {
        self.samples.len()
    }

    fn sample(&self, number: u32) -> Sample {
        self.samples[number as usize]
    }

    fn address(&self, number: u32) -> Address {
        (number, 0)
    }

    fn patch_of(&self, sample: &Sample) -> u32 {
        self.domain.map_or(0, |domain| domain.patch_of(sample.triangle))
    }

    fn largest_size(&self) -> f64 {
        1.0
    }
}

/// Like [`linear_scan`], for any choices, with a kernel of as many dimensions D as `kernel.lift` needs. Returns the numbers
/// of the choices that it keeps besides `fixed`.
///
/// # Errors
/// [`Error::Cancelled`](crate::base::error::Error::Cancelled) if the monitor asks for it.
pub fn scan_lifted<const D: usize>(
    choices: &impl Choices,
    fixed: &[Sample],
    kernel: Kernel,
    seed: u64,
    monitor: &dyn Monitor,
) -> Result<Vec<u32>> {
    let mut blocks = Blocks::new(choices, fixed, kernel, seed);
    let turns = blocks.turns();
    for (i, turn) in turns.iter().enumerate() {
        check(monitor)?;
        let kept: Vec<Vec<(u32, Sample)>> = parallel::each(turn, |&b| blocks.scan::<D>(b));
        for (&b, chosen) in turn.iter().zip(kept) {
            let block = &mut blocks.list[b];
            block.chosen.extend(chosen.iter().map(|c| c.0));
            block.kept.extend(chosen.iter().map(|c| c.1));
        }
        monitor.progress((i + 1) as f64 / turns.len() as f64);
    }
    Ok(blocks.list.into_iter().flat_map(|b| b.chosen).collect())
}

/// The blocks of space that hold candidates or fixed samples, in the order of their places.
struct Blocks<'a, C> {
    choices: &'a C,
    list: Vec<Block>,
    places: Vec<IVec3>,
    /// Numbers of candidates, block by block, in random order within each.
    order: Vec<u32>,
    kernel: Kernel<'a>,
    cell: f64,
}

struct Block {
    /// Range of its candidates in `order`.
    candidates: std::ops::Range<usize>,
    /// Samples kept so far, the fixed ones first.
    kept: Vec<Sample>,
    /// The numbers of those that are not fixed.
    chosen: Vec<u32>,
}

impl<'a, C: Choices> Blocks<'a, C> {
    fn new(choices: &'a C, fixed: &[Sample], kernel: Kernel<'a>, seed: u64) -> Self {
        let cell = choices.cell(kernel.sigma);
        let place = |p: DVec3| place_of(p, cell * f64::from(BLOCK));
        let turn = |i: u32| bits_at(seed, Stage::Scan, choices.address(i))[0] as u32;
        let key = |i: u32| (place(choices.sample(i).position).to_array(), turn(i), i);
        let mut keyed: Vec<([i32; 3], u32, u32)> = parallel::map(0..choices.count() as u32, key);
        keyed.par_sort_unstable();
        let mut homes: Vec<([i32; 3], usize)> =
            fixed.iter().enumerate().map(|(i, s)| (place(s.position).to_array(), i)).collect();
        homes.sort_unstable();
        let mut places: Vec<[i32; 3]> = keyed.iter().map(|k| k.0).chain(homes.iter().map(|h| h.0)).collect();
        places.dedup();
        places.sort_unstable();
        places.dedup();
        let list = places.iter().map(|place| {
            let candidates = keyed.partition_point(|k| k.0 < *place)..keyed.partition_point(|k| k.0 <= *place);
            let own = homes.partition_point(|h| h.0 < *place)..homes.partition_point(|h| h.0 <= *place);
            let kept: Vec<Sample> = homes[own].iter().map(|h| fixed[h.1]).collect();
            Block { candidates, kept, chosen: Vec::new() }
        });
        Blocks {
            choices,
            list: list.collect(),
            order: keyed.iter().map(|k| k.2).collect(),
            places: places.into_iter().map(IVec3::from_array).collect(),
            kernel,
            cell,
        }
    }

    /// Returns the blocks of each turn: those whose places have the same parities.
    fn turns(&self) -> Vec<Vec<usize>> {
        (0..TURNS).map(|turn| (0..self.list.len()).filter(|&b| turn_of(self.places[b]) == turn).collect()).collect()
    }

    /// Returns the candidates that block `b` keeps.
    fn scan<const D: usize>(&self, b: usize) -> Vec<(u32, Sample)> {
        let block = &self.list[b];
        if block.candidates.is_empty() {
            return Vec::new();
        }
        let mut near = Neighborhood::<D>::new(self.places[b] * BLOCK - HALO, self.kernel, self.cell);
        for other in self.around(b) {
            self.list[other].kept.iter().for_each(|s| near.insert(s, self.choices.patch_of(s)));
        }
        let mut kept = Vec::new();
        for &i in &self.order[block.candidates.clone()] {
            let sample = self.choices.sample(i);
            let patch = self.choices.patch_of(&sample);
            if near.changes_spectrum(&sample, patch) {
                near.insert(&sample, patch);
                kept.push((i, sample));
            }
        }
        kept
    }

    /// Iterates over block `b` and those that touch it.
    fn around(&self, b: usize) -> impl Iterator<Item = usize> {
        let place = self.places[b];
        (0..27).filter_map(move |i| {
            let wanted = (place + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1).to_array();
            self.places.binary_search_by_key(&wanted, |p| p.to_array()).ok()
        })
    }
}

/// The samples in and around a block, in cells.
struct Neighborhood<'a, const D: usize> {
    /// The cell at the lowest corner.
    origin: IVec3,
    kernel: Kernel<'a>,
    cell: f64,
    heads: Vec<u32>,
    members: Vec<Member<D>>,
    /// The members of each patch; of patches with many members, only enough to exceed [`FEW`].
    of_patch: FxHashMap<u32, Vec<u32>>,
    measure: Measure<D>,
    found: Vec<(f64, u32)>,
}

struct Member<const D: usize> {
    coordinates: [f64; D],
    normal: DVec3,
    patch: u32,
    next: u32,
}

impl<const D: usize> Member<D> {
    /// Returns its squared distance from `x`, whose coordinates are `here`, in units of σ, if it is a neighbour, given that
    /// both are on the same patch; `scale` is 1 / σ².
    #[inline]
    fn seen_from(&self, x: &Sample, here: &[f64; D], scale: f64) -> Option<f64> {
        let distance = distance_squared(&self.coordinates, here) * scale;
        (distance < RADIUS * RADIUS && self.normal.dot(x.normal) >= 0.0).then_some(distance)
    }
}

impl<'a, const D: usize> Neighborhood<'a, D> {
    fn new(origin: IVec3, kernel: Kernel<'a>, cell: f64) -> Self {
        let heads = vec![END; (SPAN * SPAN * SPAN) as usize];
        let (members, of_patch, measure, found) = (Vec::new(), FxHashMap::default(), Measure::new(), Vec::new());
        Neighborhood { origin, kernel, cell, heads, members, of_patch, measure, found }
    }

    fn cell_of(&self, p: DVec3) -> IVec3 {
        (p / self.cell).floor().as_ivec3() - self.origin
    }

    fn insert(&mut self, sample: &Sample, patch: u32) {
        let c = self.cell_of(sample.position);
        if c.cmpge(IVec3::ZERO).all() && c.cmplt(IVec3::splat(SPAN)).all() {
            let head = &mut self.heads[(c.x + SPAN * (c.y + SPAN * c.z)) as usize];
            let number = self.members.len() as u32;
            let next = std::mem::replace(head, number);
            let own = self.of_patch.entry(patch).or_default();
            if own.len() <= FEW {
                own.push(number);
            }
            let coordinates = self.kernel.lift.coordinates(sample);
            self.members.push(Member { coordinates, normal: sample.normal, patch, next });
        }
    }

    /// Returns whether s(x) > ε. If the patch has few members, all of them are examined. Otherwise the nearest cells, tested
    /// first, settle most cases; then all cells within reach follow.
    fn changes_spectrum(&mut self, x: &Sample, patch: u32) -> bool {
        let Some(own) = self.of_patch.get(&patch) else { return true };
        if own.len() <= FEW {
            let (here, sigma) = (self.kernel.lift.coordinates(x), self.sigma_at(x));
            let scale = 1.0 / (sigma * sigma);
            let seen = |&i: &u32| Some((self.members[i as usize].seen_from(x, &here, scale)?, i));
            self.found.clear();
            self.found.extend(own.iter().filter_map(seen));
            return self.exceeds_epsilon(&here, sigma);
        }
        let p = x.position / self.cell;
        let home = self.cell_of(x.position);
        let towards = (p - p.floor()).round().as_ivec3() - 1;
        let here = self.kernel.lift.coordinates(x);
        self.gather(x, &here, patch, home + towards, home + towards + 1);
        if self.found.iter().any(|f| f.0 <= TOO_NEAR) {
            return false;
        }
        let sigma = self.sigma_at(x);
        let reach = sigma * RADIUS;
        let (lowest, highest) = (self.cell_of(x.position - reach), self.cell_of(x.position + reach));
        (1..=HALO).all(|reach| {
            self.gather(x, &here, patch, (home - reach).max(lowest), (home + reach).min(highest));
            self.exceeds_epsilon(&here, sigma)
        })
    }

    fn sigma_at(&self, x: &Sample) -> f64 {
        self.kernel.sigma * self.kernel.lift.width::<D>(x)
    }

    /// Collects the neighbours of `x` in a box of cells, with their squared distances in units of σ.
    fn gather(&mut self, x: &Sample, here: &[f64; D], patch: u32, lo: IVec3, hi: IVec3) {
        self.found.clear();
        let sigma = self.sigma_at(x);
        let scale = 1.0 / (sigma * sigma);
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                let row = SPAN * (y + SPAN * z);
                for cell in row + lo.x..=row + hi.x {
                    let mut i = self.heads[cell as usize];
                    while i != END {
                        let m = &self.members[i as usize];
                        if m.patch == patch
                            && let Some(d) = m.seen_from(x, here, scale)
                        {
                            self.found.push((d, i));
                        }
                        i = m.next;
                    }
                }
            }
        }
    }

    /// Returns whether s(x) > ε over the samples found. Adds the nearest first, until the answer is known.
    fn exceeds_epsilon(&mut self, here: &[f64; D], sigma: f64) -> bool {
        self.found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.measure.clear();
        let nearest = self.found.iter().take(MOST_NEIGHBOURS);
        for &(_, i) in nearest {
            let offset = difference(&self.members[i as usize].coordinates, here).map(|x| x / sigma);
            if self.measure.add(&offset) <= EPSILON {
                return false;
            }
        }
        true
    }
}
