//! Numbers in bytes, of all types that occur in files, in both byte orders.

use crate::mesh::attributes::Scalar;

/// Type of a number in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Byte order of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Little,
    Big,
}

impl Type {
    /// Size of a number, in bytes.
    pub fn size(self) -> usize {
        match self {
            Type::I8 | Type::U8 => 1,
            Type::I16 | Type::U16 => 2,
            Type::I32 | Type::U32 | Type::F32 => 4,
            Type::I64 | Type::U64 | Type::F64 => 8,
        }
    }

    /// Reads the number in the first bytes, of which there must be enough. Integers beyond 2^53 are rounded.
    #[inline]
    pub fn read(self, bytes: &[u8], order: Order) -> f64 {
        let mut eight = [0; 8];
        let four = |eight: [u8; 8]| [eight[0], eight[1], eight[2], eight[3]];
        let bytes = &bytes[..self.size()];
        eight[..bytes.len()].copy_from_slice(bytes);
        if order == Order::Big {
            eight[..bytes.len()].reverse();
        }
        match self {
            Type::I8 => f64::from(eight[0] as i8),
            Type::U8 => f64::from(eight[0]),
            Type::I16 => f64::from(i16::from_le_bytes([eight[0], eight[1]])),
            Type::U16 => f64::from(u16::from_le_bytes([eight[0], eight[1]])),
            Type::I32 => f64::from(i32::from_le_bytes(four(eight))),
            Type::U32 => f64::from(u32::from_le_bytes(four(eight))),
            Type::I64 => i64::from_le_bytes(eight) as f64,
            Type::U64 => u64::from_le_bytes(eight) as f64,
            Type::F32 => f64::from(f32::from_le_bytes(four(eight))),
            Type::F64 => f64::from_le_bytes(eight),
        }
    }

    /// Reads all numbers in `bytes`; an incomplete last one is left out.
    pub fn read_all(self, bytes: &[u8], order: Order) -> impl Iterator<Item = f64> {
        bytes.chunks_exact(self.size()).map(move |number| self.read(number, order))
    }

    /// Returns the type in which attributes of these numbers are kept. 64-bit integers become floats if they need more than
    /// 32 bits.
    pub fn scalar(self, values: &[f64]) -> Scalar {
        let fits = |low: f64, high: f64| values.iter().all(|&x| low <= x && x <= high);
        match self {
            Type::I8 => Scalar::I8,
            Type::U8 => Scalar::U8,
            Type::I16 => Scalar::I16,
            Type::U16 => Scalar::U16,
            Type::I32 => Scalar::I32,
            Type::U32 => Scalar::U32,
            Type::I64 if fits(i32::MIN.into(), i32::MAX.into()) => Scalar::I32,
            Type::U64 if fits(0.0, u32::MAX.into()) => Scalar::U32,
            Type::F32 => Scalar::F32,
            Type::I64 | Type::U64 | Type::F64 => Scalar::F64,
        }
    }
}

/// Returns `number` as a vertex index, if it is an integer below `vertices`.
#[inline]
pub(super) fn index(number: f64, vertices: usize) -> Option<u32> {
    (number >= 0.0 && number < vertices as f64 && number.fract() == 0.0).then_some(number as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_orders() {
        let bytes = [0xFF, 0xFE, 0xFD, 0xFC, 0xFB, 0xFA, 0xF9, 0xF8];
        assert_eq!(Type::I16.read(&bytes, Order::Big), f64::from(i16::from_be_bytes([0xFF, 0xFE])));
        assert_eq!(Type::U32.read(&bytes, Order::Little), f64::from(0xFCFD_FEFFu32));
        assert_eq!(Type::I8.read(&bytes, Order::Big), -1.0);
        assert_eq!(Type::F64.read(&1.5f64.to_be_bytes(), Order::Big), 1.5);
        assert_eq!(Type::F32.read_all(&[0, 0, 0xC0, 0x3F, 1], Order::Little).collect::<Vec<_>>(), [1.5]);
        assert_eq!(Type::I64.scalar(&[-5.0]), Scalar::I32);
        assert_eq!(Type::I64.scalar(&[1e12]), Scalar::F64);
    }

    #[test]
    fn indices_are_whole_and_in_range() {
        assert_eq!(
            [0.0, 4.0, 5.0, -1.0, 0.5, f64::NAN].map(|x| index(x, 5)),
            [Some(0), Some(4), None, None, None, None]
        );
    }
}
