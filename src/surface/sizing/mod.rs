//! Target edge lengths on a domain.

mod feature_size;
mod field;
mod gradation;
mod graph;
mod interface;
mod radii;
mod room;
mod rows;

pub use feature_size::{has_room_between_curves, sizes_between_curves};
pub use field::{adapted_sizes, field_lengths, field_sizes, mean_density};
pub use interface::{lengths_from_interface, vertices};
pub use room::sizes_with_room;
pub use rows::sizes_with_whole_rows;
