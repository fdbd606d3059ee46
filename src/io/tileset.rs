//! 3D Tiles: a mesh, or its levels of detail, cut into files, of which a viewer loads only those that it needs.
//!
//! Tiles are cells of an octree in the cube around all levels. A level is cut at the depth at which its tiles have about
//! [`TRIANGLES`] triangles. Each triangle belongs to the cell of its centroid. The children of a tile are the tiles of the
//! next finer level in the same cell, which replace it where it is not fine enough. Its geometric error controls this: it is
//! the distance of its level from the input.
//!
//! The coordinates of the tileset are those of the input. The GLB of a tile has its vertices relative to the centre of the
//! cube, so that single precision suffices for coordinates far from zero. Viewers rotate the y axis of glTF, which points
//! up, to the z axis of tiles; the transform of the root rotates it back.
//!
//! Source: 3D Tiles Specification 1.1, OGC 22-025r4.
//!
//! Cost: a sort of the triangles of each level by cell.
//!
//! Limits: levels share no vertices, so there may be cracks between tiles of different levels, no wider than the error of
//! the coarser one. Each tile has all images of its materials.

use crate::geom::aabb::Aabb;
use crate::io::address::percent_encoded;
use crate::io::content::Content;
use crate::io::gltf::write_glb;
use crate::mesh::attributes::Attributes;
use crate::mesh::triangle_mesh::Mesh;
use glam::DVec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::mem;

/// Approximate number of triangles per tile: some 500 KB, which a viewer loads at once.
const TRIANGLES: usize = 20_000;

/// Depth of the smallest cells.
const DEEPEST: u32 = 16;

/// A level of detail.
#[derive(Debug, Clone, Copy)]
pub struct Level<'a> {
    /// Its triangles.
    pub mesh: &'a Mesh,
    /// Their attributes.
    pub attributes: &'a Attributes,
    /// Distance of the level from the input, in its units.
    pub error: f64,
}

/// The tiles of a mesh.
pub(super) struct Tileset<'a> {
    /// From fine to coarse.
    levels: &'a [Level<'a>],
    /// Centre of the cube, in the coordinates of the input.
    middle: DVec3,
    diagonal: f64,
    /// Parents before their children.
    tiles: Vec<Tile>,
}

/// The part of a level in a cell of the octree.
struct Tile {
    /// Index of its level.
    level: usize,
    /// Tile of the next coarser level that contains this one.
    parent: Option<usize>,
    /// Triangles of its level; empty if only finer levels have triangles here.
    triangles: Vec<u32>,
}

/// A cell of the octree at a given depth.
type Cell = [u32; 3];

impl<'a> Tileset<'a> {
    /// Cuts `levels`, from fine to coarse, into tiles.
    pub(super) fn new(levels: &'a [Level<'a>]) -> Tileset<'a> {
        let all = levels.iter().filter_map(|level| level.mesh.bounds()).reduce(|a, b| a.join(&b)).unwrap_or_default();
        let mut depths: Vec<u32> = levels.iter().map(|level| depth(level.mesh.triangles.len())).collect();
        // The cells of a level are at least as large as those of a finer level.
        (1..depths.len()).rev().for_each(|i| depths[i - 1] = depths[i - 1].max(depths[i]));
        let mut octree = Octree { depths, found: vec![BTreeMap::new(); levels.len()], tiles: Vec::new() };
        for (i, level) in levels.iter().enumerate().rev() {
            for t in 0..level.mesh.triangles.len() {
                let cell = cell(&all, level.mesh.centroid(t), octree.depths[i]);
                let tile = octree.tile(i, cell);
                octree.tiles[tile].triangles.push(t as u32);
            }
        }
        Tileset { levels, middle: 0.5 * (all.lo + all.hi), diagonal: all.diagonal(), tiles: octree.tiles }
    }

    /// Returns the names of the tile files of a tileset with this name, and the tile of each file.
    pub(super) fn files(&self, stem: &str) -> Vec<(String, usize)> {
        let has_file = |&tile: &usize| !self.tiles[tile].triangles.is_empty();
        let name = |tile: usize| (format!("{stem}-{}-{tile}.glb", self.tiles[tile].level + 1), tile);
        (0..self.tiles.len()).filter(has_file).map(name).collect()
    }

    /// Writes the GLB of a tile.
    ///
    /// # Errors
    /// Those of [`write_glb`].
    pub(super) fn write_tile(&self, tile: usize, out: &mut dyn Write) -> io::Result<()> {
        let Tile { level, triangles, .. } = &self.tiles[tile];
        let Level { mesh, attributes, .. } = self.levels[*level];
        let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |v: u32| vertices.binary_search(&v).expect("a vertex of the tile") as u32;
        let positions: Vec<DVec3> = vertices.iter().map(|&v| mesh.positions[v as usize] - self.middle).collect();
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| mesh.triangles[t as usize].map(number)).collect();
        let attributes = attributes.of_part(&vertices, triangles);
        write_glb(&[Content { positions: &positions, triangles: &corners, attributes: &attributes }], out)
    }

    /// Returns the tileset itself, as JSON. `files` are those of [`Self::files`].
    pub(super) fn json(&self, files: &[(String, usize)]) -> Value {
        let mut content = vec![None; self.tiles.len()];
        files.iter().for_each(|(name, tile)| content[*tile] = Some(percent_encoded(name)));
        let bounds = self.bounds();
        let mut children: Vec<Vec<Value>> = vec![Vec::new(); self.tiles.len()];
        let mut roots = Vec::new();
        for (i, tile) in self.tiles.iter().enumerate().rev() {
            let mut value = json!({ "boundingVolume": volume(&bounds[i]), "geometricError": self.error(tile.level) });
            if let Some(name) = &content[i] {
                value["content"] = json!({ "uri": name });
            }
            if !children[i].is_empty() {
                children[i].reverse();
                value["children"] = mem::take(&mut children[i]).into();
            }
            tile.parent.map_or(&mut roots, |parent| &mut children[parent]).push(value);
        }
        roots.reverse();
        let whole = self.tiles.iter().zip(&bounds).filter(|(tile, _)| tile.parent.is_none()).map(|(_, bounds)| *bounds);
        let whole = whole.reduce(|a, b| a.join(&b)).unwrap_or_default();
        let [x, y, z] = self.middle.to_array();
        json!({
            "asset": { "version": "1.1", "extras": { "generator": "spectral-remesh" } },
            "geometricError": self.diagonal,
            "root": {
                "boundingVolume": volume(&whole), "geometricError": self.diagonal, "refine": "REPLACE",
                "transform": [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, x, y, z, 1],
                "children": roots,
            },
        })
    }

    /// Returns the geometric error of a level: zero for the finest, and for a coarser one at least that of each finer one.
    fn error(&self, level: usize) -> f64 {
        self.levels[..=level].iter().skip(1).map(|level| level.error).fold(0.0, f64::max)
    }

    /// Returns the bounding box of each tile and its children, relative to the centre.
    fn bounds(&self) -> Vec<Aabb> {
        let own = |tile: &Tile| {
            let mesh = self.levels[tile.level].mesh;
            let corners = tile.triangles.iter().flat_map(|&t| mesh.corners(t as usize));
            Aabb::of(corners.map(|p| p - self.middle))
        };
        let mut bounds: Vec<Option<Aabb>> = self.tiles.iter().map(own).collect();
        for (i, tile) in self.tiles.iter().enumerate().rev() {
            if let (Some(parent), Some(child)) = (tile.parent, bounds[i]) {
                bounds[parent] = Some(bounds[parent].map_or(child, |own| own.join(&child)));
            }
        }
        bounds.into_iter().map(|bounds| bounds.expect("each tile has triangles, or children that have")).collect()
    }
}

/// The tiles while they are created.
struct Octree {
    /// Depth of the cells of each level.
    depths: Vec<u32>,
    /// The tiles of each level, by cell.
    found: Vec<BTreeMap<Cell, usize>>,
    tiles: Vec<Tile>,
}

impl Octree {
    /// Returns the tile of a level in a cell, which is created if it does not exist.
    fn tile(&mut self, level: usize, cell: Cell) -> usize {
        if let Some(&tile) = self.found[level].get(&cell) {
            return tile;
        }
        let parent = self.depths.get(level + 1).map(|depth| self.depths[level] - depth);
        let parent = parent.map(|deeper| self.tile(level + 1, cell.map(|c| c >> deeper)));
        self.tiles.push(Tile { level, parent, triangles: Vec::new() });
        self.found[level].insert(cell, self.tiles.len() - 1);
        self.tiles.len() - 1
    }
}

/// Returns the depth at which a level with this number of triangles is cut: each further depth has four times as many cells
/// on a surface.
fn depth(triangles: usize) -> u32 {
    (0..DEEPEST).find(|&depth| triangles <= TRIANGLES << (2 * depth)).unwrap_or(DEEPEST)
}

/// Returns the cell of a point at a depth, in the cube around `all`.
fn cell(all: &Aabb, point: DVec3, depth: u32) -> Cell {
    let side = all.size().max_element();
    let cells = f64::from(1u32 << depth);
    let scaled = if side > 0.0 { (point - 0.5 * (all.lo + all.hi)) / side + 0.5 } else { DVec3::splat(0.5) };
    scaled.to_array().map(|x| (x * cells).floor().clamp(0.0, cells - 1.0) as u32)
}

/// Returns a box in the form of 3D Tiles, with z up: its centre and half of each of its sides.
fn volume(bounds: &Aabb) -> Value {
    let (middle, half) = (0.5 * (bounds.lo + bounds.hi), 0.5 * bounds.size());
    json!({ "box": [middle.x, -middle.z, middle.y, half.x, 0, 0, 0, half.z, 0, 0, 0, half.y] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::content::NO_BUFFERS;
    use crate::io::gltf;
    use crate::mesh::attributes::{Attribute, Scalar};

    /// A square in the plane z = 5 with `side` cells a side, far from zero, and the index of each vertex as an attribute.
    fn square(side: u32) -> (Mesh, Attributes) {
        let place =
            |i: u32, j: u32| DVec3::new(f64::from(i), f64::from(j), 0.0) / f64::from(side) + DVec3::new(1e6, 0.0, 5.0);
        let positions: Vec<DVec3> = (0..=side).flat_map(|j| (0..=side).map(move |i| place(i, j))).collect();
        let number = |i: u32, j: u32| j * (side + 1) + i;
        let cell = |i: u32, j: u32| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let triangles = (0..side).flat_map(|j| (0..side).flat_map(move |i| cell(i, j))).collect();
        let values = (0..positions.len()).map(|v| v as f64).collect();
        let vertex = vec![Attribute { name: "number".into(), components: 1, values, scalar: Scalar::F32 }];
        (Mesh { positions, triangles }, Attributes { vertex, ..Attributes::default() })
    }

    /// Checks all tiles under `tile`, including that the box of each is in that of its parent, and collects their contents.
    fn check(tile: &Value, contents: &mut Vec<String>) {
        let children = tile["children"].as_array().cloned().unwrap_or_default();
        for child in &children {
            assert!(child["geometricError"].as_f64() <= tile["geometricError"].as_f64());
            for k in 0..3 {
                let range = |tile: &Value| {
                    let numbers: Vec<f64> =
                        tile["boundingVolume"]["box"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
                    (numbers[k] - numbers[3 + 4 * k], numbers[k] + numbers[3 + 4 * k])
                };
                let (outer, inner) = (range(tile), range(child));
                assert!(outer.0 <= inner.0 + 1e-9 && inner.1 <= outer.1 + 1e-9);
            }
            check(child, contents);
        }
        contents.extend(tile["content"]["uri"].as_str().map(String::from));
        assert!(!children.is_empty() || tile["content"].is_object());
    }

    #[test]
    fn tiles_have_all_triangles_of_each_level_once_at_their_places() {
        let (fine, coarse) = (square(300), square(80));
        let level = |(mesh, attributes), error| Level { mesh, attributes, error };
        let levels = [level((&fine.0, &fine.1), 0.25), level((&coarse.0, &coarse.1), 0.5)];
        let tileset = Tileset::new(&levels);
        let files = tileset.files("a b");
        let json = tileset.json(&files);
        let mut contents = Vec::new();
        check(&json["root"], &mut contents);
        contents.sort();
        let mut names: Vec<String> = files.iter().map(|(name, _)| name.replace(' ', "%20")).collect();
        names.sort();
        assert_eq!(contents, names);
        assert_eq!(json["root"]["children"].as_array().unwrap().len(), 1);
        assert_eq!(json["root"]["children"][0]["geometricError"], 0.5);
        assert_eq!(json["root"]["children"][0]["children"][0]["geometricError"], 0.0);

        let transform: Vec<f64> =
            json["root"]["transform"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let of_input = glam::DMat4::from_cols_slice(&transform);
        let mut seen = [vec![0; fine.0.positions.len()], vec![0; coarse.0.positions.len()]];
        let mut triangles = [0, 0];
        for (name, tile) in &files {
            let i = usize::from(name.starts_with("a b-2"));
            let mut glb = Vec::new();
            tileset.write_tile(*tile, &mut glb).unwrap();
            let loaded = gltf::parse(&glb, NO_BUFFERS).unwrap();
            let numbers = &loaded.attributes.get("number").unwrap_or_else(|| &loaded.attributes.vertex[0]).values;
            for (p, number) in loaded.mesh.positions.iter().zip(numbers) {
                // The coordinates after a viewer has rotated the y axis of glTF.
                let there = of_input.transform_point3(DVec3::new(p.x, -p.z, p.y));
                assert!(there.distance(levels[i].mesh.positions[*number as usize]) < 1e-6);
                seen[i][*number as usize] += 1;
            }
            assert!(loaded.mesh.triangles.len() <= 2 * TRIANGLES);
            triangles[i] += loaded.mesh.triangles.len();
        }
        assert_eq!(triangles, [fine.0.triangles.len(), coarse.0.triangles.len()]);
        assert!(seen.iter().flatten().all(|&times| times > 0));
    }
}
