//! Work shared among threads, with results in the order of the work.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};

use crate::planar::threads;

/// What `work` gives for each of `items`, in their order. While it goes on, what it says to its second argument is handed to
/// `told`, on this thread.
pub(super) fn each<I: Sync, T: Send, N: Send>(
    items: &[I],
    work: impl Fn(&I, &dyn Fn(N)) -> T + Sync,
    told: &mut dyn FnMut(N),
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<T>>> = items.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..threads().min(items.len()) {
            let (sender, next, results, work) = (sender.clone(), &next, &results, &work);
            scope.spawn(move || {
                // Nobody listens only after a panic.
                let say = |news| drop(sender.send(news));
                while let Some((item, result)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    items.get(i).zip(results.get(i))
                } {
                    let found = work(item, &say);
                    *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
                }
            });
        }
        drop(sender);
        receiver.into_iter().for_each(told);
    });
    let done = |result: Mutex<Option<T>>| result.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().map(|result| done(result).expect("all work was done")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_their_order() {
        let mut told = 0;
        let squares = each(
            &(0..100u32).collect::<Vec<_>>(),
            |n, say| {
                say(*n);
                n * n
            },
            &mut |n: u32| told += n,
        );
        assert_eq!((squares, told), ((0..100).map(|n| n * n).collect(), 4950));
        assert!(each(&[], |(): &(), _: &dyn Fn(())| (), &mut |()| ()).is_empty());
    }
}
