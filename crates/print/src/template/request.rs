//! Request for a tiled template.

use super::layout::LayoutRequest;
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::number;

/// A request for a tiled template. All lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateRequest {
    /// Printed width of one repeat of the pattern; its height follows, cells are square.
    pub tile_mm: f64,
    /// Scale of the model, 1:`scale`; only for the captions.
    pub scale: f64,
    /// Name of the pattern in the captions: its file name.
    pub pattern_name: String,
    /// Edge of the template that points to the model's front.
    pub front: Front,
    /// Size, paper and edges.
    pub layout: LayoutRequest,
}

impl TemplateRequest {
    /// Returns the request for a pattern whose repeats are this wide, mm.
    pub fn tiled(self, tile_mm: f64) -> Self {
        Self { tile_mm, ..self }
    }

    /// Returns the document's title.
    pub fn title(&self) -> String {
        format!("Template of {}, tile {} mm", self.pattern_name, number(self.tile_mm))
    }
}

/// Edge of the template that points to the model's front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Front {
    /// Left edge, as on the model's left side.
    #[default]
    Left,
    /// Right edge, as on the model's right side.
    Right,
    Up,
    Down,
    /// No edge, as on the front and the rear.
    None,
}

impl Front {
    pub(crate) fn direction(self) -> Option<Point2> {
        match self {
            Self::Left => Some([-1.0, 0.0]),
            Self::Right => Some([1.0, 0.0]),
            Self::Up => Some([0.0, 1.0]),
            Self::Down => Some([0.0, -1.0]),
            Self::None => None,
        }
    }
}
