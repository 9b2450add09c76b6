//! The interface of all surrogate renderers.

/// Model of one view that predicts its image in any paint.
pub trait Renderer {
    /// Predicts the image, sRGB 0 to 1, from the linear reflectance of the paint in each pixel; both row by row.
    fn predict(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]>;

    /// Returns the derivative of each predicted value with respect to the reflectance in the same pixel and channel; it depends on no other.
    /// 0 where the prediction is clipped.
    fn derivative(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]>;
}
