//! A mesh on its way to the result: a 2-manifold whose vertices are samples of a domain, changed by local operations
//! that keep its topology and never turn a triangle against the surface.

pub mod faces;
pub mod motion;
pub mod neighborhood;

use crate::geom::triangle::{closest_point, mean_ratio};
use crate::mesh::half_edge::{CORNER, Connectivity, next, prev};
use crate::mesh::topology::NONE;
use crate::mesh::triangle_mesh::Mesh;
use crate::surface::domain::{Domain, Sample};
use glam::DVec3;
use rayon::prelude::*;

/// A 2-manifold over samples.
#[derive(Debug, Clone)]
pub struct Manifold {
    /// How the vertices are joined.
    pub connectivity: Connectivity,
    /// A sample for each vertex number, those of removed vertices included.
    pub samples: Vec<Sample>,
    /// Vertices that neither move nor go.
    pub fixed: Vec<bool>,
    /// See [`Self::colour_classes`]; vertices that are new since have none.
    colours: Vec<u8>,
}

/// The colour of a vertex without one.
const UNCOLOURED: u8 = u8::MAX;

impl Manifold {
    /// The manifold of `triangles`, which have to be an oriented 2-manifold that uses all of `samples`.
    pub fn new(samples: Vec<Sample>, triangles: &[[u32; 3]]) -> Self {
        let fixed = vec![false; samples.len()];
        Manifold { connectivity: Connectivity::new(samples.len(), triangles), samples, fixed, colours: Vec::new() }
    }

    /// Where vertex `v` is.
    #[inline]
    pub fn position(&self, v: u32) -> DVec3 {
        self.samples[v as usize].position
    }

    /// Lays edges, each given by its ends and its curve, on curves, and their ends with them; then makes `corners` of
    /// these vertices. Whether all the edges are there.
    pub fn mark_curves(&mut self, edges: &[([u32; 2], u32)], corners: impl IntoIterator<Item = u32>) -> bool {
        let mut all = true;
        for &([a, b], curve) in edges {
            all &= self.connectivity.mark_on_curve(a, b, curve);
            self.connectivity.put_on_curve(a, curve);
            self.connectivity.put_on_curve(b, curve);
        }
        for v in corners {
            self.connectivity.put_on_curve(v, CORNER);
        }
        all
    }

    /// Merges the origin of `h` into its target, with Delaunay flips around it afterwards.
    pub fn collapse(&mut self, h: u32) {
        let into = self.connectivity.target(h);
        self.connectivity.collapse(h);
        self.flip_to_delaunay(self.connectivity.outgoing(into).flat_map(|h| [h, next(h)]).collect());
    }

    /// The vertices along each curve, the first one again at the end of a closed one.
    pub fn curve_chains(&self) -> Vec<Vec<u32>> {
        let c = &self.connectivity;
        let mut seen = vec![false; self.samples.len()];
        let mut chains = Vec::new();
        let vertices = || (0..c.vertex_bound()).filter(|&v| c.has_vertex(v));
        let corners = vertices().filter(|&v| c.curve_at(v) == CORNER);
        let on_curves = vertices().filter(|&v| c.curve_at(v) < CORNER);
        for start in corners.chain(on_curves) {
            for first in self.neighbours_on_curves(start) {
                if c.curve_at(first) == CORNER || seen[first as usize] {
                    continue;
                }
                let mut chain = vec![start, first];
                seen[start as usize] = true;
                let (mut before, mut at) = (start, first);
                while at != start
                    && let Some(ends) = c.along_curve(at)
                {
                    seen[at as usize] = true;
                    (before, at) = (at, if ends[0] == before { ends[1] } else { ends[0] });
                    chain.push(at);
                }
                chains.push(chain);
            }
        }
        chains
    }

    /// The neighbours of `v` across edges on curves.
    fn neighbours_on_curves(&self, v: u32) -> Vec<u32> {
        let c = &self.connectivity;
        let last = c.outgoing(v).map(prev).find(|&h| c.twin(h) == NONE && c.curve(h) != NONE);
        let out = c.outgoing(v).filter(|&h| c.curve(h) != NONE).map(|h| c.target(h));
        out.chain(last.map(|h| c.origin(h))).collect()
    }

    /// Makes corners of all vertices on the boundary.
    pub fn lock_boundary(&mut self) {
        for v in 0..self.connectivity.vertex_bound() {
            if self.connectivity.has_vertex(v) && self.connectivity.is_boundary(v) {
                self.connectivity.put_on_curve(v, CORNER);
            }
        }
    }

    /// The unit direction of the curve that `v` lies on, if it lies on one.
    pub fn along(&self, v: u32) -> Option<DVec3> {
        let [a, b] = self.connectivity.along_curve(v)?;
        Some((self.position(a) - self.position(b)).normalize_or(DVec3::X))
    }

    /// Whether `v` stays where it is.
    pub fn is_locked(&self, v: u32) -> bool {
        self.fixed[v as usize] || self.connectivity.curve_at(v) == CORNER
    }

    /// The point of the domain closest to `p` for a vertex that is at `here` now, on the same curve if it is on one.
    pub fn place_on(&self, domain: &Domain, v: u32, p: DVec3, here: &Sample) -> Sample {
        match self.connectivity.curve_at(v) {
            NONE => domain.project(p, here.normal, here.triangle),
            curve => domain.project_on_curve(p, curve),
        }
    }

    /// Where a step of `way` takes vertex `v` from `here`, along the same curve if it is on one.
    pub fn place_after(&self, domain: &Domain, v: u32, way: DVec3, here: &Sample) -> Sample {
        match self.connectivity.curve_at(v) {
            NONE => domain.follow(here, way),
            curve => domain.project_on_curve(here.position + way, curve),
        }
    }

    /// The mesh without gaps.
    pub fn to_mesh(&self) -> Mesh {
        let (triangles, old) = self.connectivity.compact();
        Mesh { positions: old.iter().map(|&v| self.position(v)).collect(), triangles }
    }

    /// The cosine between the normal of a triangle of these vertices and that of the surface at them; -1 if the
    /// triangle is flat.
    #[inline]
    pub fn agreement(&self, corners: [u32; 3]) -> f64 {
        cosine_to_surface(corners.map(|v| &self.samples[v as usize]))
    }

    /// The squared length of the edge of `h`.
    #[inline]
    pub fn length_squared(&self, h: u32) -> f64 {
        self.position(self.connectivity.origin(h)).distance_squared(self.position(self.connectivity.target(h)))
    }

    /// The squared length of the edge of `h`, relative to what is wanted at its ends; in squared mean spacings.
    #[inline]
    pub fn relative_length_squared(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let [a, b] = [c.origin(h), c.target(h)].map(|v| &self.samples[v as usize]);
        a.position.distance_squared(b.position) / (a.size * b.size)
    }

    /// Whether the edge of `h` is not Delaunay: the angles across from it sum to more than two right ones.
    ///
    /// With the cosines and sines of both the sum's sine is negative then; no angle needs to be computed.
    pub fn breaks_delaunay(&self, h: u32) -> bool {
        let g = self.connectivity.twin(h);
        if g == NONE {
            return false;
        }
        let [a, b, c] = self.connectivity.triangle(h).map(|v| self.position(v));
        let d = self.position(self.connectivity.apex(g));
        let (ca, cb, da, db) = (a - c, b - c, a - d, b - d);
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        if cos_c >= 0.0 && cos_d >= 0.0 {
            return false;
        }
        let (sin_c, sin_d) = (ca.cross(cb).length(), da.cross(db).length());
        sin_c * cos_d + cos_c * sin_d < -1e-10 * (cos_c.abs() + sin_c) * (cos_d.abs() + sin_d)
    }

    /// Whether flipping the edge of `h` keeps both triangles facing the way of the surface, or at least no worse.
    pub fn flip_keeps_facing(&self, h: u32, least: f64) -> bool {
        let g = self.connectivity.twin(h);
        let [a, b, c] = self.connectivity.triangle(h);
        let d = self.connectivity.apex(g);
        let after = self.agreement([c, a, d]).min(self.agreement([d, b, c]));
        after > least || after > self.agreement([a, b, c]).min(self.agreement([b, a, d]))
    }

    /// Flips edges that are not Delaunay until there are none, beginning with those in `queue`. Flips that would make an
    /// edge twice or turn a triangle against the surface are left out.
    pub fn flip_to_delaunay(&mut self, mut queue: Vec<u32>) {
        // In the plane flips end by themselves; on a bent surface a bound makes sure of it.
        let mut left = 20 * queue.len() + 200;
        while let Some(h) = queue.pop() {
            if left == 0 || !self.connectivity.has_half_edge(h) || !self.breaks_delaunay(h) {
                continue;
            }
            if self.connectivity.can_flip(h) && self.flip_keeps_facing(h, LEAST_FACING) {
                let g = self.connectivity.twin(h);
                self.connectivity.flip(h);
                queue.extend([next(h), prev(h), next(g), prev(g)]);
                left -= 1;
            }
        }
    }

    /// All half-edges, in increasing order.
    pub fn half_edges(&self) -> impl Iterator<Item = u32> {
        (0..self.connectivity.half_edge_bound()).filter(|&h| self.connectivity.has_half_edge(h))
    }

    /// One half-edge of each edge, in increasing order.
    pub fn edges(&self) -> impl Iterator<Item = u32> {
        self.half_edges().filter(|&h| h < self.connectivity.twin(h))
    }

    /// Splits the edge of `h` at its middle, put back on the domain; the new vertex. `None`, and nothing is done, if
    /// that place is not between the ends or would turn a triangle against the surface, as happens where the edge cuts
    /// through a thin part.
    pub fn split_at_middle(&mut self, domain: &Domain, h: u32) -> Option<u32> {
        let middle = self.middle(domain, h);
        let ends = [self.connectivity.origin(h), self.connectivity.target(h)].map(|v| self.position(v));
        let longest = MIDDLE_REACH * MIDDLE_REACH * self.length_squared(h);
        let between = ends.iter().all(|end| end.distance_squared(middle.position) <= longest);
        if !between || !self.both_sides(h).all(|h| self.halves_face_surface(h, &middle)) {
            return None;
        }
        Some(self.split_at(middle, h))
    }

    /// [`Self::split_at_middle`] wherever that place is, and whatever becomes of the triangles.
    pub fn split_anyhow(&mut self, domain: &Domain, h: u32) -> u32 {
        self.split_at(self.middle(domain, h), h)
    }

    fn split_at(&mut self, middle: Sample, h: u32) -> u32 {
        self.samples.push(middle);
        self.fixed.push(false);
        self.connectivity.split_edge(h)
    }

    /// Whether the triangle of `h`, split from `middle` to the corner across, faces the surface as well as it must or
    /// as it does now.
    fn halves_face_surface(&self, h: u32, middle: &Sample) -> bool {
        let [a, b, top] = self.connectivity.triangle(h).map(|v| &self.samples[v as usize]);
        let least = LEAST_FACING.min(cosine_to_surface([a, b, top]));
        cosine_to_surface([a, middle, top]) >= least && cosine_to_surface([middle, b, top]) >= least
    }

    /// The middle of the edge of `h`, put back on the domain, or on the curve that the edge lies on.
    fn middle(&self, domain: &Domain, h: u32) -> Sample {
        let c = &self.connectivity;
        let ends = [c.origin(h), c.target(h)];
        let middle = (self.position(ends[0]) + self.position(ends[1])) / 2.0;
        if c.curve(h) != NONE {
            return domain.project_on_curve(middle, c.curve(h));
        }
        // Of the corners of both triangles, one that is on no curve knows the patch.
        let apexes = [c.apex(h), if c.twin(h) == NONE { c.apex(h) } else { c.apex(c.twin(h)) }];
        let knows = ends.into_iter().chain(apexes).find(|&v| c.curve_at(v) == NONE);
        let normal = self.samples[ends[0] as usize].normal + self.samples[ends[1] as usize].normal;
        match knows.map(|v| &self.samples[v as usize]) {
            Some(near) if normal == DVec3::ZERO => domain.project(middle, near.normal, near.triangle),
            Some(_) if c.curve_at(ends[0]) == NONE => {
                domain.follow(&Sample { normal, ..self.samples[ends[0] as usize] }, middle - self.position(ends[0]))
            }
            Some(near) => domain.project(middle, normal, near.triangle),
            None => domain.project_anywhere(middle),
        }
    }

    /// The mesh with its `count` relatively longest edges split at their middles, put back on the domain: a triangle
    /// with three such edges becomes four, the others two or three or stay. Edges whose middle would turn a triangle
    /// against the surface, as happens where they cut through a thin part, are left out, and the next longest are split
    /// instead.
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
                self.both_sides(h).for_each(|h| middle_of[h as usize] = v);
            }
            samples.par_extend(more.par_iter().map(|&h| self.middle(domain, h)));
            self.refuse_folds(&number, &mut samples, &mut middle_of, first);
        }
        let mut triangles = Vec::with_capacity(4 * self.connectivity.half_edge_bound() as usize / 3);
        self.half_edges().filter(|h| h % 3 == 0).for_each(|h| triangles.extend(self.parts(h, &number, &middle_of)));
        let mut finer = Manifold::new(samples, &triangles);
        self.hand_curves_on(&mut finer, &number, &middle_of);
        finer
    }

    /// The mesh without the gaps that collapses leave: what goes through all of it is faster then.
    pub fn without_gaps(&self) -> Manifold {
        let (triangles, old) = self.connectivity.compact();
        let mut mesh = Manifold::new(old.iter().map(|&v| self.samples[v as usize]).collect(), &triangles);
        mesh.fixed = old.iter().map(|&v| self.fixed[v as usize]).collect();
        let unsplit = vec![NONE; self.connectivity.half_edge_bound() as usize];
        self.hand_curves_on(&mut mesh, &self.new_numbers(&old), &unsplit);
        mesh
    }

    /// For each vertex its number once those of `old`, in that order, are all that there are.
    fn new_numbers(&self, old: &[u32]) -> Vec<u32> {
        let mut number = vec![NONE; self.samples.len()];
        old.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
        number
    }

    /// The half-edges of the edge of `h`, one or two.
    fn both_sides(&self, h: u32) -> impl Iterator<Item = u32> {
        [h, self.connectivity.twin(h)].into_iter().filter(|&h| h != NONE)
    }

    /// The triangles that the one of `h`, the first of its sides, becomes when its sides with a middle are split.
    fn parts(&self, h: u32, number: &[u32], middle_of: &[u32]) -> Vec<[u32; 3]> {
        let corners = self.connectivity.triangle(h).map(|v| number[v as usize]);
        let m = [0, 1, 2].map(|k| middle_of[h as usize + k]);
        match m.iter().filter(|&&v| v != NONE).count() {
            0 => vec![corners],
            3 => vec![[corners[0], m[0], m[2]], [m[0], corners[1], m[1]], [m[2], m[1], corners[2]], m],
            _ => {
                // Turn so that side 0 is split and, of two split sides, side 1 is the other one.
                let k = (0..3).find(|&k| m[k] != NONE && m[(k + 2) % 3] == NONE).unwrap_or(0);
                let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
                match (m[k], m[(k + 1) % 3]) {
                    (p, NONE) => vec![[a, p, c], [p, b, c]],
                    (p, q) => vec![[p, b, q], [a, p, q], [a, q, c]],
                }
            }
        }
    }

    /// Takes the middles away from the sides of triangles with a part that is turned against the surface, and their
    /// samples, which begin at `first`.
    fn refuse_folds(&self, number: &[u32], samples: &mut Vec<Sample>, middle_of: &mut [u32], first: usize) {
        let faces = |t: &[u32; 3]| cosine_to_surface(t.map(|v| &samples[v as usize])) >= LEAST_FACING;
        let sound = |&h: &u32| {
            !faces(&self.connectivity.triangle(h).map(|v| number[v as usize]))
                || self.parts(h, number, middle_of).iter().all(faces)
        };
        let triangles = (0..self.connectivity.half_edge_bound() / 3).into_par_iter().map(|t| 3 * t);
        let folded: Vec<u32> = triangles.filter(|&h| self.connectivity.has_half_edge(h) && !sound(&h)).collect();
        if folded.is_empty() {
            return;
        }
        for h in folded.into_iter().flat_map(|h| [h, h + 1, h + 2]) {
            self.both_sides(h).for_each(|h| middle_of[h as usize] = NONE);
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

    /// Lays the curves of this mesh on one made from it by splitting edges: `number` says what its vertices are there,
    /// `middle_of` what the middle of each half-edge is.
    fn hand_curves_on(&self, finer: &mut Manifold, number: &[u32], middle_of: &[u32]) {
        let c = &self.connectivity;
        let mut edges = Vec::new();
        for h in self.edges().filter(|&h| c.curve(h) != NONE) {
            let [a, b] = [c.origin(h), c.target(h)].map(|v| number[v as usize]);
            match middle_of[h as usize] {
                NONE => edges.push(([a, b], c.curve(h))),
                m => edges.extend([([a, m], c.curve(h)), ([m, b], c.curve(h))]),
            }
        }
        let corners = (0..c.vertex_bound()).filter(|&v| c.has_vertex(v) && c.curve_at(v) == CORNER);
        finer.mark_curves(&edges, corners.map(|v| number[v as usize]));
    }

    /// The vertices where the surface turns by more than the angle of that cosine within two rings, curves not crossed.
    pub fn bent(&self, cosine: f64) -> Vec<bool> {
        let c = &self.connectivity;
        let normal = |v: u32| self.samples[v as usize].normal;
        let inside = |v: u32| c.ring(v).filter(|&w| c.curve_at(w) == NONE);
        let turns = |v: u32| inside(v).any(|w| c.ring(w).any(|x| normal(x).dot(normal(v)) < cosine));
        (0..c.vertex_bound()).into_par_iter().map(|v| c.has_vertex(v) && turns(v)).collect()
    }

    /// The least cosine between a triangle at `v` and the surface if `v` were at `there`.
    pub fn worst_facing(&self, v: u32, there: &Sample) -> f64 {
        let facing = |h: u32| {
            let [_, p, q] = self.connectivity.triangle(h);
            let (p, q) = (&self.samples[p as usize], &self.samples[q as usize]);
            cosine_to_surface([there, p, q])
        };
        self.connectivity.outgoing(v).map(facing).fold(1.0, f64::min)
    }

    /// Whether all triangles at `v` would face the surface, by cosines of at least `least`, if `v` were at `there`.
    pub fn faces_surface(&self, v: u32, there: &Sample, least: f64) -> bool {
        self.connectivity.outgoing(v).all(|h| {
            let [_, p, q] = self.connectivity.triangle(h);
            let (p, q) = (&self.samples[p as usize], &self.samples[q as usize]);
            let own = (p.position - there.position).cross(q.position - there.position);
            let surface = there.normal + p.normal + q.normal;
            let dot = own.dot(surface);
            dot > 0.0 && dot * dot >= least * least * own.length_squared() * surface.length_squared()
        })
    }

    /// The vertices that can move, in classes such that no two of a class are adjacent, each in the order of their
    /// numbers. Colours of earlier calls stay where nothing has changed.
    pub fn colour_classes(&mut self) -> Vec<Vec<u32>> {
        let c = &self.connectivity;
        let bound = c.vertex_bound();
        let new = self.colours.len() as u32..bound;
        self.colours.resize(bound as usize, UNCOLOURED);
        let colours = &self.colours;
        let clash = |h: u32| {
            let (v, w) = (c.origin(h), c.target(h));
            (colours[v as usize] == colours[w as usize]).then_some(v.max(w))
        };
        let mut wrong: Vec<u32> = self.half_edges().filter_map(clash).chain(new).filter(|&v| c.has_vertex(v)).collect();
        wrong.sort_unstable();
        wrong.dedup();
        for v in wrong {
            let taken =
                c.ring(v).map(|w| self.colours[w as usize]).filter(|&k| k < 64).fold(0u64, |taken, k| taken | 1 << k);
            self.colours[v as usize] = taken.trailing_ones().min(63) as u8;
        }
        let mut classes: Vec<Vec<u32>> = Vec::new();
        for v in (0..bound).filter(|&v| c.has_vertex(v) && !self.is_locked(v)) {
            let colour = self.colours[v as usize] as usize;
            if classes.len() <= colour {
                classes.resize_with(colour + 1, Vec::new);
            }
            classes[colour].push(v);
        }
        classes
    }

    /// Flips all edges that are not Delaunay.
    pub fn make_delaunay(&mut self) {
        let c = &self.connectivity;
        // Of a broken edge one angle across is obtuse.
        let has_obtuse = |h: u32| {
            let [a, b, c] = c.triangle(h).map(|v| self.position(v));
            (a - c).dot(b - c) < 0.0
        };
        let triangles = (0..c.half_edge_bound() / 3).into_par_iter().with_min_len(2048);
        let sides = triangles.filter(|t| c.has_half_edge(3 * t)).flat_map_iter(|t| 3 * t..3 * t + 3);
        let broken = sides.filter(|&h| has_obtuse(h) && self.breaks_delaunay(h)).map(|h| h.min(c.twin(h)));
        let mut broken: Vec<u32> = broken.collect();
        broken.sort_unstable();
        broken.dedup();
        broken.reverse();
        self.flip_to_delaunay(broken);
    }

    /// How well the triangles face the surface and are shaped if the origin of `h` merges into its target: the worst
    /// cosine between a triangle's normal and the surface's, and the worst mean ratio.
    pub fn after_collapse(&self, h: u32) -> (f64, f64) {
        let c = &self.connectivity;
        let target = c.target(h);
        let mut worst = (1.0f64, 1.0f64);
        for out in c.outgoing(c.origin(h)) {
            let [_, p, q] = c.triangle(out);
            if p != target && q != target {
                let corners = [target, p, q];
                let shape = mean_ratio(corners.map(|v| self.position(v)));
                worst = (worst.0.min(self.agreement(corners)), worst.1.min(shape));
            }
        }
        worst
    }

    /// The least cosine between a triangle and the surface at one of its corners if the origin of `h` merges into its
    /// target.
    pub fn bend_after_collapse(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let target = c.target(h);
        let left = c.outgoing(c.origin(h)).map(|out| c.triangle(out)).filter(|t| !t[1..].contains(&target));
        let least = left.map(|[_, p, q]| {
            let corners = [target, p, q].map(|v| &self.samples[v as usize]);
            let [a, b, c] = corners.map(|s| s.position);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let known = corners.iter().filter(|s| s.normal != DVec3::ZERO);
            known.map(|s| s.normal.dot(normal)).fold(1.0, f64::min)
        });
        least.fold(1.0, f64::min)
    }

    /// How far the origin of `h` is from the triangles that are left there if it merges into its target.
    pub fn distance_after_collapse(&self, h: u32) -> f64 {
        let c = &self.connectivity;
        let (here, target) = (self.position(c.origin(h)), c.target(h));
        let squared = c.outgoing(c.origin(h)).map(|out| c.triangle(out)).filter(|t| !t[1..].contains(&target));
        let squared = squared
            .map(|[_, p, q]| here.distance_squared(closest_point(here, [target, p, q].map(|v| self.position(v)))));
        squared.fold(f64::INFINITY, f64::min).sqrt()
    }
}

/// How far, in lengths of an edge, the point that splits it may be from either end.
const MIDDLE_REACH: f64 = 0.75;

/// See [`Manifold::agreement`].
#[inline]
fn cosine_to_surface([a, b, c]: [&Sample; 3]) -> f64 {
    let own = (b.position - a.position).cross(c.position - a.position);
    let surface = a.normal + b.normal + c.normal;
    if surface == DVec3::ZERO && own != DVec3::ZERO {
        // All three are on sharp edges: nothing is known against it.
        return 1.0;
    }
    let cosine = own.dot(surface) / (own.length_squared() * surface.length_squared()).sqrt();
    if cosine.is_finite() { cosine } else { -1.0 }
}

/// Cosine between a triangle and the surface that a flip must keep: 75 degrees.
const LEAST_FACING: f64 = 0.26;

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of two rows of `n` vertices, of triangles as long as the second row is shifted.
    fn strip(n: u32, shift: f64) -> Manifold {
        let sample =
            |x: f64, y: f64| Sample { position: DVec3::new(x, y, 0.0), normal: DVec3::Z, triangle: 0, size: 1.0 };
        let lower = (0..n).map(|i| sample(f64::from(i), 0.0));
        let upper = (0..n).map(|i| sample(f64::from(i) + shift, 1.0));
        let triangles = (0..n - 1).flat_map(|i| [[i, i + 1, n + i + 1], [i, n + i + 1, n + i]]);
        Manifold::new(lower.chain(upper).collect(), &triangles.collect::<Vec<_>>())
    }

    #[test]
    fn neighbours_never_share_a_class_even_after_flips() {
        let mut mesh = strip(50, 0.8);
        for _ in 0..2 {
            let classes = mesh.colour_classes();
            assert_eq!(classes.iter().map(Vec::len).sum::<usize>(), 100);
            for class in classes {
                assert!(class.iter().all(|&v| class.iter().all(|&w| !mesh.connectivity.are_adjacent(v, w))));
            }
            mesh.make_delaunay();
        }
    }

    #[test]
    fn no_edge_is_left_that_breaks_delaunay() {
        let mut mesh = strip(20, 0.8);
        assert!(mesh.edges().any(|h| mesh.breaks_delaunay(h)));
        mesh.make_delaunay();
        assert!(!mesh.edges().any(|h| mesh.breaks_delaunay(h)));
    }
}
