//! A picture as PNG. It is the same on every computer, because the font is built in.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, Tree};

/// Pixels per unit of the picture.
const ZOOM: f32 = 2.0;

/// Why a picture cannot be made into an image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The SVG cannot be read.
    #[error("the picture cannot be read: {0}")]
    Svg(#[from] usvg::Error),
    /// The size is zero or too large.
    #[error("the picture's size is zero or too large for an image")]
    Size,
    /// The image cannot be encoded.
    #[error("the image cannot be encoded: {0}")]
    Encoding(String),
}

/// Converts an SVG file to a PNG file with two pixels per unit.
///
/// # Errors
/// The SVG cannot be read, has no valid size, or the image cannot be encoded.
pub fn png(svg: &str) -> Result<Vec<u8>, PngError> {
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size().scale_by(ZOOM);
    let size = size.ok_or(PngError::Size)?;
    let mut image = Pixmap::new(size.width(), size.height()).ok_or(PngError::Size)?;
    resvg::render(
        &tree,
        Transform::from_scale(ZOOM, ZOOM),
        &mut image.as_mut(),
    );
    let encoded = image.encode_png();
    encoded.map_err(|error| PngError::Encoding(error.to_string()))
}
