//! Values at the vertices of the input.

use crate::base::count::counted;
use crate::base::error::{Error, Result, Setting};
use crate::mesh::attributes::Attributes;

/// One number per vertex of a mesh or per point of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// The numbers themselves, in the order of the vertices.
    Given(Vec<f64>),
    /// An attribute, or a component of one, by its name, such as `red` or `nz`.
    Attribute(String),
}

impl Values {
    /// Returns the values with an attribute looked up.
    ///
    /// # Errors
    /// [`Error::Mesh`] for an attribute that does not exist.
    pub(crate) fn resolved(&self, attributes: &Attributes) -> Result<Values> {
        match self {
            Values::Given(values) => Ok(Values::Given(values.clone())),
            Values::Attribute(name) => attributes.numbers(name).map(Values::Given),
        }
    }

    /// Returns the values of some of the points.
    pub(crate) fn of(&self, points: &[u32]) -> Values {
        match self {
            Values::Given(values) => Values::Given(points.iter().map(|&p| values[p as usize]).collect()),
            named => named.clone(),
        }
    }

    /// Returns the values of some of `all` points; those of an attribute are looked up later.
    ///
    /// # Errors
    /// [`Error::Option`] unless as many are given as there are points.
    pub(crate) fn picked(&self, option: Setting, points: &[u32], all: usize) -> Result<Values> {
        if self.given().is_some() {
            self.check(option, all)?;
        }
        Ok(self.of(points))
    }

    /// Returns the numbers, if they are given.
    pub(super) fn given(&self) -> Option<&[f64]> {
        match self {
            Values::Given(values) => Some(values),
            Values::Attribute(_) => None,
        }
    }

    /// Refuses values whose number differs from `vertices`.
    pub(super) fn check(&self, option: Setting, vertices: usize) -> Result<()> {
        let refuse = |cause: String, remedy: &str| Err(Error::Option { option, cause, remedy: remedy.into() });
        match self {
            Values::Given(values) if values.len() == vertices => Ok(()),
            Values::Given(values) => {
                let values = counted(values.len(), "value is", "values are");
                let cause = format!("{values} given for the {vertices} vertices of the input");
                refuse(cause, "give one value for each vertex")
            }
            Values::Attribute(name) => refuse_name(option, name, "value"),
        }
    }
}

/// Refuses the name of an attribute where each vertex must have one `item`.
pub(super) fn refuse_name(option: Setting, name: &str, item: &str) -> Result<()> {
    let cause = format!("the attribute {name} was not looked up");
    Err(Error::Option { option, cause, remedy: format!("look it up, or give one {item} for each vertex") })
}
