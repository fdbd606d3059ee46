//! Vectors of any dimension as plain arrays.

/// a - b.
#[inline]
pub fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `factor` a.
#[inline]
pub fn scaled<const D: usize>(a: &[f64; D], factor: f64) -> [f64; D] {
    a.map(|x| factor * x)
}

/// The scalar product.
#[inline]
pub fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for i in 0..D {
        sum += a[i] * b[i];
    }
    sum
}

/// |a|².
#[inline]
pub fn length_squared<const D: usize>(a: &[f64; D]) -> f64 {
    dot(a, a)
}

/// |a - b|².
#[inline]
pub fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    length_squared(&difference(a, b))
}

/// Returns `a`, shortened to `longest` if it is longer.
#[inline]
pub fn shortened<const D: usize>(a: &[f64; D], longest: f64) -> [f64; D] {
    let length = length_squared(a).sqrt();
    if length > longest { scaled(a, longest / length) } else { *a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_the_plane_and_in_five_dimensions() {
        assert_eq!(distance_squared(&[1.0, 2.0], &[4.0, -2.0]), 25.0);
        assert_eq!(dot(&[1.0, 2.0, 3.0, 4.0, 5.0], &[1.0; 5]), 15.0);
        assert_eq!(shortened(&[3.0, 4.0], 1.0), [0.6000000000000001, 0.8]);
        assert_eq!(shortened(&[3.0, 4.0], 6.0), [3.0, 4.0]);
        assert_eq!(scaled(&difference(&[1.0; 6], &[0.5; 6]), 4.0), [2.0; 6]);
    }
}
