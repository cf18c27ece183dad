//! How many threads work is shared among.

use std::num::NonZero;

/// The number of threads that work is shared among, at least one: as many as the machine runs at once, or what the
/// environment variable `OPENWORK_THREADS` says, if that is a whole number from 1 on. Results do not depend on it.
pub fn threads() -> usize {
    let asked = std::env::var("OPENWORK_THREADS").ok().and_then(|text| text.trim().parse().ok());
    let threads = asked.or_else(|| std::thread::available_parallelism().ok());
    threads.map_or(1, NonZero::get)
}
