//! Edge splits: one by one, or the longest edges all at once.

use crate::base::parallel;
use crate::manifold::Manifold;
use crate::manifold::facing::{FacingGuard, cosine_to_surface};
use crate::mesh::half_edge::OnCurve;
use crate::mesh::topology::NONE;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;

/// Maximum distance of the splitting point from either end, and minimum distance from the opposite corners, in lengths of
/// the edge.
const MIDDLE_REACH: f64 = 0.75;
const CLEARANCE: f64 = 0.25;

impl Manifold {
    /// Splits the edge of `h` at its middle, projected onto the domain; returns the new vertex. Returns `None`, and does
    /// nothing, if the projection is not between the ends, is close to an opposite corner, or would turn a triangle against
    /// the surface, as happens where the edge cuts through a thin part.
    pub fn split_at_middle(&mut self, domain: &Domain, h: u32) -> Option<u32> {
        let middle = self.middle(domain, h);
        let ends = [self.connectivity.origin(h), self.connectivity.target(h)].map(|v| self.position(v));
        let longest = MIDDLE_REACH * MIDDLE_REACH * self.length_squared(h);
        let between = ends.iter().all(|end| end.distance_squared(middle.position) <= longest);
        let apexes = self.connectivity.both_sides(h).map(|h| self.position(self.connectivity.apex(h)));
        let clearance = CLEARANCE * CLEARANCE * self.length_squared(h);
        let is_clear = apexes.map(|p| p.distance_squared(middle.position)).all(|square| square >= clearance);
        if !between || !is_clear || !self.connectivity.both_sides(h).all(|h| self.halves_face_surface(h, &middle)) {
            return None;
        }
        Some(self.split_at(middle, h))
    }

    /// [`Self::split_at_middle`] without its conditions.
    pub fn split_anyhow(&mut self, domain: &Domain, h: u32) -> u32 {
        self.split_at(self.middle(domain, h), h)
    }

    /// Splits the edge of `h` at `middle`, which nothing checks; returns the new vertex.
    pub fn split_at(&mut self, middle: Sample, h: u32) -> u32 {
        self.samples.push(middle);
        self.connectivity.split_edge(h)
    }

    /// Returns whether the guard allows the halves of the triangle of `h`, split from `middle` to the opposite corner.
    fn halves_face_surface(&self, h: u32, middle: &Sample) -> bool {
        let [a, b, top] = self.connectivity.triangle(h).map(|v| &self.samples[v as usize]);
        let after = cosine_to_surface([a, middle, top]).min(cosine_to_surface([middle, b, top]));
        FacingGuard::DELAUNAY.allows(after, || cosine_to_surface([a, b, top]))
    }

    /// Returns the middle of the edge of `h`, projected onto the domain, or onto the curve that the edge lies on.
    fn middle(&self, domain: &Domain, h: u32) -> Sample {
        let c = &self.connectivity;
        let ends = [c.origin(h), c.target(h)];
        let middle = (self.position(ends[0]) + self.position(ends[1])) / 2.0;
        if let OnCurve::Curve(curve) = c.curve(h) {
            return domain.project_on_curve(middle, curve);
        }
        // A corner of either triangle that is on no curve tells which patch the edge is on.
        let knows = ends.into_iter().chain(c.both_sides(h).map(|h| c.apex(h))).find(|&v| !c.is_on_curve(v));
        let normal = self.samples[ends[0] as usize].normal + self.samples[ends[1] as usize].normal;
        match knows.map(|v| &self.samples[v as usize]) {
            Some(near) if normal == DVec3::ZERO => domain.project(middle, near.normal, near.triangle),
            Some(_) if !c.is_on_curve(ends[0]) => {
                domain.follow(&Sample { normal, ..self.samples[ends[0] as usize] }, middle - self.position(ends[0]))
            }
            Some(near) => domain.project(middle, normal, near.triangle),
            None => domain.project_anywhere(middle),
        }
    }

    /// Returns the mesh with its `count` relatively longest edges split at their middles, projected onto the domain. A
    /// triangle with three such edges becomes four; others become two or three, or stay. Edges whose middle would turn a
    /// triangle against the surface are left out, and the next longest are split instead.
    pub fn with_longest_split(&self, domain: &Domain, count: usize) -> Manifold {
        let (_, old) = self.connectivity.compact();
        let number = self.new_numbers(&old);
        let mut samples: Vec<Sample> = old.iter().map(|&v| self.samples[v as usize]).collect();
        let mut edges: Vec<u32> = self.edges().filter(|&h| self.connectivity.can_split(h)).collect();
        let length = |h: u32| self.relative_length_squared(h);
        edges.sort_by(|&g, &h| length(h).total_cmp(&length(g)).then(g.cmp(&h)));
        let mut edges = edges.into_iter();
        let mut middle_of = vec![NONE; self.connectivity.half_edge_bound() as usize];
        let first = samples.len();
        while samples.len() < first + count {
            let more: Vec<u32> = edges.by_ref().take(first + count - samples.len()).collect();
            if more.is_empty() {
                break;
            }
            for (&h, v) in more.iter().zip(samples.len() as u32..) {
                self.connectivity.both_sides(h).for_each(|h| middle_of[h as usize] = v);
            }
            samples.extend(parallel::map(&more[..], |&h| self.middle(domain, h)));
            self.refuse_folds(&number, &mut samples, &mut middle_of, first);
        }
        let mut triangles = Vec::with_capacity(4 * self.connectivity.half_edge_bound() as usize / 3);
        self.triangles().for_each(|t| triangles.extend(self.parts(3 * t, &number, &middle_of)));
        let mut finer = Manifold::new(samples, &triangles);
        self.copy_curves(&mut finer, &number, &middle_of);
        finer
    }

    /// Returns the parts of the triangle whose first side is `h` when its sides with a middle are split.
    fn parts(&self, h: u32, number: &[u32], middle_of: &[u32]) -> Vec<[u32; 3]> {
        let corners = self.connectivity.triangle(h).map(|v| number[v as usize]);
        let m = [0, 1, 2].map(|k| middle_of[h as usize + k]);
        match m.iter().filter(|&&v| v != NONE).count() {
            0 => vec![corners],
            3 => vec![[corners[0], m[0], m[2]], [m[0], corners[1], m[1]], [m[2], m[1], corners[2]], m],
            _ => {
                // Rotate the corners so that side 0 is split and, if two sides are, side 1 is the other one.
                let k = (0..3).find(|&k| m[k] != NONE && m[(k + 2) % 3] == NONE).unwrap_or(0);
                let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
                match (m[k], m[(k + 1) % 3]) {
                    (p, NONE) => vec![[a, p, c], [p, b, c]],
                    (p, q) => vec![[p, b, q], [a, p, q], [a, q, c]],
                }
            }
        }
    }

    /// Removes the middles, and their samples, on the sides of triangles that have a part turned against the surface. The
    /// samples of middles begin at `first`.
    fn refuse_folds(&self, number: &[u32], samples: &mut Vec<Sample>, middle_of: &mut [u32], first: usize) {
        let faces = |t: &[u32; 3]| FacingGuard::DELAUNAY.passes(cosine_to_surface(t.map(|v| &samples[v as usize])));
        let sound = |&h: &u32| {
            !faces(&self.connectivity.triangle(h).map(|v| number[v as usize]))
                || self.parts(h, number, middle_of).iter().all(faces)
        };
        let folded: Vec<u32> = parallel::collect(0..self.connectivity.half_edge_bound() / 3, |triangles| {
            triangles.map(|t| 3 * t).filter(|&h| self.connectivity.has_half_edge(h) && !sound(&h))
        });
        if folded.is_empty() {
            return;
        }
        for h in folded.into_iter().flat_map(|h| [h, h + 1, h + 2]) {
            self.connectivity.both_sides(h).for_each(|h| middle_of[h as usize] = NONE);
        }
        let mut kept = vec![false; samples.len()];
        kept[..first].fill(true);
        middle_of.iter().filter(|&&v| v != NONE).for_each(|&v| kept[v as usize] = true);
        let renumbered: Vec<u32> = kept
            .iter()
            .scan(0, |n, &k| {
                *n += u32::from(k);
                Some(*n - u32::from(k))
            })
            .collect();
        middle_of.iter_mut().filter(|v| **v != NONE).for_each(|v| *v = renumbered[*v as usize]);
        let mut keep = kept.into_iter();
        samples.retain(|_| keep.next() == Some(true));
    }
}
