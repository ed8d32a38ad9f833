//! The newest results of a search: a search takes up to some seconds, and a program reads the same arm again and again.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// How many results are kept.
const KEPT: usize = 32;

/// The newest results, each with what it was searched for.
pub(super) struct Newest<K, V>(Mutex<VecDeque<(K, V)>>);

impl<K: PartialEq, V: Copy> Newest<K, V> {
    pub(super) const fn new() -> Self {
        Self(Mutex::new(VecDeque::new()))
    }

    /// The result for `key`: a kept one, or that of `search`. The others are not locked while it searches.
    pub(super) fn of(&self, key: K, search: impl FnOnce(&K) -> V) -> V {
        // A thread that panicked left whole entries.
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, value)) = kept().iter().find(|(known, _)| *known == key) {
            return *value;
        }
        let value = search(&key);
        let mut kept = kept();
        kept.truncate(KEPT - 1);
        kept.push_front((key, value));
        value
    }
}

#[cfg(test)]
mod tests {
    use super::{KEPT, Newest};

    #[test]
    fn a_result_is_searched_once_and_the_oldest_is_forgotten() {
        let newest = Newest::new();
        let mut searches = 0;
        let mut square = |n: usize| {
            newest.of(n, |n| {
                searches += 1;
                n * n
            })
        };
        assert_eq!([square(7), square(7)], [49, 49]);
        for n in 0..KEPT {
            square(100 + n);
        }
        assert_eq!(square(7), 49);
        assert_eq!(searches, 2 + KEPT);
    }
}
