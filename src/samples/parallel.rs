//! Work that is shared among threads and comes back in order.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::planar::threads;

/// Items that one thread takes at a time.
const BATCH: usize = 2;

/// `f(0)`, `f(1)` and so on, the same on any number of threads.
pub fn in_parallel<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let workers = threads().min(count.div_ceil(BATCH)).max(1);
    if workers == 1 {
        return (0..count).map(f).collect();
    }
    let next = AtomicUsize::new(0);
    let work = || {
        let mut made: Vec<(usize, Vec<T>)> = Vec::new();
        loop {
            let first = next.fetch_add(BATCH, Ordering::Relaxed);
            if first >= count {
                return made;
            }
            made.push((first, (first..(first + BATCH).min(count)).map(&f).collect()));
        }
    };
    let mut batches = std::thread::scope(|scope| {
        let others: Vec<_> = (1..workers).map(|_| scope.spawn(work)).collect();
        let mut batches = work();
        for other in others {
            batches.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        batches
    });
    batches.sort_unstable_by_key(|batch| batch.0);
    batches.into_iter().flat_map(|batch| batch.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_comes_back_in_order() {
        for count in [0, 1, 3, 4, 5, 1000] {
            assert_eq!(in_parallel(count, |i| i * i), (0..count).map(|i| i * i).collect::<Vec<_>>());
        }
    }
}
