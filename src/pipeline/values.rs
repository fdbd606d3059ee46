//! A number at each vertex of the input.

use crate::base::count::counted;
use crate::base::error::{Error, Result, Setting};
use crate::mesh::attributes::Attributes;

/// A number at each vertex of a mesh or at each point of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// These, in the order of the vertices.
    Given(Vec<f64>),
    /// Those of the attribute of this name, or of a component of one, such as `red` or `nz`.
    Attribute(String),
}

impl Values {
    /// The values, with an attribute looked up.
    ///
    /// # Errors
    /// [`Error::Mesh`] for an attribute that is not there.
    pub fn resolved(&self, attributes: &Attributes) -> Result<Values> {
        match self {
            Values::Given(values) => Ok(Values::Given(values.clone())),
            Values::Attribute(name) => attributes.numbers(name).map(Values::Given),
        }
    }

    /// Those of some of the points.
    pub(super) fn of(&self, points: &[u32]) -> Values {
        match self {
            Values::Given(values) => Values::Given(points.iter().map(|&p| values[p as usize]).collect()),
            named => named.clone(),
        }
    }

    /// The values, if they are given.
    pub(super) fn given(&self) -> Option<&[f64]> {
        match self {
            Values::Given(values) => Some(values),
            Values::Attribute(_) => None,
        }
    }

    /// Refuses values that are not one for each of so many vertices.
    pub(super) fn check(&self, option: Setting, vertices: usize) -> Result<()> {
        let refuse = |cause: String, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
        match self {
            Values::Given(values) if values.len() == vertices => Ok(()),
            Values::Given(values) => {
                let values = counted(values.len(), "value is", "values are");
                let cause = format!("{values} given for the {vertices} vertices of the input");
                refuse(cause, "give one value for each vertex")
            }
            Values::Attribute(name) => refuse(
                format!("the attribute {name} was not looked up"),
                "look it up, or give one value for each vertex",
            ),
        }
    }
}
