//! A picture in pixels, the same on every machine: its letters are those of a font that
//! comes with the program.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, Tree};

/// Pixels per unit of the picture.
const ZOOM: f32 = 2.0;

/// Why a picture has no pixels.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// It is no picture.
    #[error("the picture cannot be read: {0}")]
    Svg(#[from] usvg::Error),
    /// It has no size, or too great a one.
    #[error("the picture has no size that an image can have")]
    Size,
    /// It cannot be encoded.
    #[error("the image cannot be encoded: {0}")]
    Encoding(String),
}

/// An SVG file as a PNG file, twice as large.
///
/// # Errors
/// A picture that is none, or has no size.
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
