//! Selection of the part of the input that is remeshed.

use crate::base::count::counted;
use crate::base::error::{Error, Result, Setting};
use crate::geom::aabb::Aabb;
use crate::mesh::attributes::Attributes;
use crate::mesh::oriented_manifold::OrientedManifold;
use crate::mesh::triangle_mesh::Mesh;
use crate::pipeline::values::refuse_name;

/// Part of the input that is remeshed: the triangles with all three corners in it.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// The inside of a box, including its faces, given by its lowest and its highest x, y and z, in the units of the input.
    /// Of a cloud, only the points in it are used.
    Box([[f64; 3]; 2]),
    /// The vertices of the input that are marked.
    Vertices(Vec<bool>),
    /// The vertices with a given value of an attribute.
    Marked {
        /// Name of the attribute, or of a component of one.
        attribute: String,
        /// Value that marks a vertex; `None` for any but zero.
        value: Option<f64>,
    },
}

/// What holds wherever a selection is used.
const LOOKED_UP: &str = "the attribute was looked up before";

/// Refuses a box whose lowest x, y and z are not below its highest.
pub(super) fn check_box(Aabb { lo, hi }: Aabb) -> Result<()> {
    let wrong = (0..3).find(|&k| !lo[k].is_finite() || !hi[k].is_finite() || lo[k] > hi[k]);
    wrong.map_or(Ok(()), |k| {
        let cause = format!("it goes from {} to {} along {}", lo[k], hi[k], ["x", "y", "z"][k]);
        let remedy = "give the lowest x, y and z, then the highest".into();
        Err(Error::Option { option: Setting::PartBox, cause, remedy })
    })
}

impl Selection {
    /// Returns the selection with its attribute looked up.
    ///
    /// # Errors
    /// [`Error::Mesh`] for an attribute that does not exist.
    pub fn resolved(&self, attributes: &Attributes) -> Result<Selection> {
        let Selection::Marked { attribute, value } = self else { return Ok(self.clone()) };
        let is_marked = |number: f64| value.map_or(number != 0.0 && !number.is_nan(), |value| number == value);
        Ok(Selection::Vertices(attributes.numbers(attribute)?.into_iter().map(is_marked).collect()))
    }

    /// Returns the box, if the part is given by one.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        match *self {
            Selection::Box(corners) => Some(corners.into()),
            _ => None,
        }
    }

    /// Setting that corresponds to the selection.
    pub(crate) fn setting(&self) -> Setting {
        if matches!(self, Selection::Box(..)) { Setting::PartBox } else { Setting::PartMarks }
    }

    fn refuse<T>(&self, cause: String, remedy: &str) -> Result<T> {
        Err(Error::Option { option: self.setting(), cause, remedy: remedy.into() })
    }

    /// Refuses a selection that is empty for every input.
    pub(super) fn validate(&self) -> Result<()> {
        self.bounds().map_or(Ok(()), check_box)
    }

    /// Refuses marks whose number differs from `vertices`.
    pub(super) fn check(&self, vertices: usize) -> Result<()> {
        match self {
            Selection::Vertices(selected) if selected.len() != vertices => {
                let cause = counted(selected.len(), "mark is", "marks are");
                let cause = format!("{cause} given for the {vertices} vertices of the input");
                self.refuse(cause, "give one mark for each vertex")
            }
            Selection::Marked { attribute, .. } => refuse_name(self.setting(), attribute, "mark"),
            _ => Ok(()),
        }
    }

    /// Returns, for each triangle of the repaired input, whether it is in the part.
    pub(super) fn triangles(&self, repaired: &OrientedManifold) -> Vec<bool> {
        let inside: Vec<bool> = match self {
            Selection::Box(corners) => {
                let part = Aabb::from(*corners);
                repaired.positions.iter().map(|p| part.contains(*p)).collect()
            }
            Selection::Vertices(selected) => repaired.provenance().marks(selected),
            Selection::Marked { .. } => unreachable!("{LOOKED_UP}"),
        };
        repaired.triangles.iter().map(|t| t.iter().all(|&v| inside[v as usize])).collect()
    }

    /// Returns the error that no triangle of `repaired` is in the part.
    pub(super) fn refuse_nothing<T>(&self, repaired: &Mesh) -> Result<T> {
        match self {
            Selection::Box(corners) => {
                let (part, all) = (Aabb::from(*corners), repaired.bounds().unwrap_or_default());
                let cause = format!("no triangle is inside {part}: those of the input are within {all}");
                self.refuse(cause, "give a larger box, or another one")
            }
            Selection::Vertices(selected) => {
                let count = selected.iter().filter(|s| **s).count();
                let all = selected.len();
                let cause = format!("no triangle has all its corners selected: {count} of {all} vertices are");
                self.refuse(cause, "select more of them")
            }
            Selection::Marked { .. } => unreachable!("{LOOKED_UP}"),
        }
    }
}
