//! What a file may cost to read.

/// Limits against hostile or broken files. Each has an error of its own, which names the limit, so that
/// someone with an honest file that is larger knows what to raise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// The size of the file, in bytes.
    pub bytes: usize,
    /// The number of elements, counting those under a `use` once for every use.
    pub elements: usize,
    /// How deeply elements are nested, following `use`. The reader recurses, so much more than the default
    /// needs a larger stack.
    pub nesting: usize,
    /// The number of path segments as drawn (counted once per use), and of the dashes cut from strokes.
    pub segments: usize,
    /// The number of vertices after curves are flattened.
    pub vertices: usize,
    /// The largest absolute value of a number in path data and coordinates, in user units. Millimetres have
    /// their own limit: [`crate::planar::Grid::MAX_EXTENT_MM`].
    pub coordinate: f64,
}

impl Default for Limits {
    /// 64 MiB, 200,000 elements, 256 levels, 4 million segments, 16 million vertices, coordinates up to 1e9.
    fn default() -> Self {
        Self {
            bytes: 64 << 20,
            elements: 200_000,
            nesting: 256,
            segments: 4_000_000,
            vertices: 16_000_000,
            coordinate: 1e9,
        }
    }
}
