//! Samples without triangles and the facts about them.

use crate::base::count::counted;
use crate::mesh::attributes::{Attribute, Attributes, Lost, NORMAL, Scalar};
use crate::mesh::points::Points;
use crate::mesh::provenance::PointOnTriangle;
use crate::pipeline::cloud::summary::CloudSummary;
use crate::pipeline::sample::progressive::SampleLevel;

/// Name of the attribute with the number of a sample among the input's points.
const INDEX: &str = "index";

/// Samples and information about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Samples in the coordinates of the input, with unit normals if the input has some.
    pub points: Points,
    /// With [`scan_only`](crate::pipeline::SampleOptions::scan_only), the number of each sample among the input's points.
    pub indices: Option<Vec<u32>>,
    /// Positions on the triangles of the input; empty if it has none, and with
    /// [`scan_only`](crate::pipeline::SampleOptions::scan_only).
    pub origins: Vec<PointOnTriangle>,
    /// Attributes other than positions and normals; empty until they are set by [`carrying`](Self::carrying).
    pub carried: Attributes,
    /// Number of points of the input, or of candidates on its surface, that were examined.
    pub candidates: usize,
    /// Kernel width used, in the units of the input.
    pub sigma_p: f64,
    /// Wanted number of samples; `None` if the kernel width determined it.
    pub wanted: Option<usize>,
    /// Levels, from coarse to fine: each consists of that many of the first samples. Empty if none were requested.
    pub levels: Vec<SampleLevel>,
    /// Summary of how the points of a cloud were used as a surface; `None` for a mesh.
    pub cloud: Option<CloudSummary>,
    /// Notes for the user, one sentence each.
    pub notes: Vec<String>,
}

impl Sampled {
    /// Returns the attributes of the samples other than positions and normals: their numbers in the input, as `index`, if
    /// they are points of it, and the attributes that were carried over.
    pub fn attributes(&self) -> Attributes {
        let attribute = |indices: &Vec<u32>| Attribute {
            name: INDEX.into(),
            components: 1,
            values: indices.iter().map(|&i| f64::from(i)).collect(),
            scalar: Scalar::U32,
        };
        let carried = self.carried.vertex.iter().cloned();
        Attributes { vertex: self.indices.iter().map(attribute).chain(carried).collect(), ..Attributes::default() }
    }

    /// Removes some attributes, and notes which.
    #[must_use]
    pub fn without(mut self, lost: Vec<Lost>) -> Sampled {
        for Lost { name, cause } in lost {
            self.carried.remove(&name);
            self.notes.push(format!("attribute {name} is left out: {cause}"));
        }
        self
    }

    /// Adds attributes at the same positions, except normals and numbers, of which the samples have their own.
    #[must_use]
    pub fn carrying(self, mut attributes: Attributes) -> Sampled {
        [NORMAL, INDEX].iter().for_each(|name| attributes.remove(name));
        Sampled { carried: Attributes { vertex: attributes.vertex, ..Attributes::default() }, ..self }
    }
}

/// Number of samples up to which they are only a handful.
const HANDFUL: usize = 12;

/// Returns the notes on the number of samples `kept` out of `candidates`.
pub fn count_notes(kept: usize, candidates: usize, wanted: Option<usize>) -> Vec<String> {
    match wanted {
        Some(wanted) if kept < wanted => {
            let samples = counted(kept, "sample", "samples");
            vec![format!("{samples} instead of {wanted}: there are no more distinct points")]
        }
        None if kept == candidates => {
            vec![format!(
                "all {kept} points are kept: σp is smaller than the distances between them; a larger σp keeps fewer"
            )]
        }
        None if kept <= HANDFUL => {
            let samples = counted(kept, "sample is", "samples are");
            vec![format!("only {samples} left: σp is about as large as the whole input; a smaller σp keeps more")]
        }
        _ => Vec::new(),
    }
}
