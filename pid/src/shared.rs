//! pid: what follows from lengths alone, made once for all runs that are alike, as the draws of a study are. In: a key and how its value
//! is made. Out: the value, that of before where it is still kept. No bit depends on what is kept.

use std::sync::{Arc, Mutex, PoisonError};

/// The values used last, a few of them.
pub(crate) struct Shared<K, V> {
    most: usize,
    kept: Mutex<Vec<(K, Arc<V>)>>,
}

impl<K: Copy + PartialEq, V> Shared<K, V> {
    /// Room for `most` values.
    pub(crate) const fn new(most: usize) -> Self {
        Self { most, kept: Mutex::new(Vec::new()) }
    }
    /// The value of a key. Threads that miss the same one at the same time each make it; nobody waits for another's work.
    pub(crate) fn get(&self, key: K, make: impl FnOnce() -> V) -> Arc<V> {
        if let Some(found) = self.find(key) {
            return found;
        }
        let made = Arc::new(make());
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() >= self.most {
            kept.remove(0);
        }
        kept.push((key, Arc::clone(&made)));
        made
    }
    /// The value, which is now the last to be forgotten.
    fn find(&self, key: K) -> Option<Arc<V>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let place = kept.iter().rposition(|(k, _)| *k == key)?;
        kept[place..].rotate_left(1);
        kept.last().map(|(_, value)| Arc::clone(value))
    }
}

#[cfg(test)]
mod tests {
    use super::Shared;
    use std::cell::Cell;

    /// Found again while it is kept; the one not used for longest goes first.
    #[test]
    fn exact_the_latest_are_kept() {
        let (shared, made) = (Shared::new(2), Cell::new(0));
        let get = |key: u32| {
            *shared.get(key, || {
                made.set(made.get() + 1);
                10 * key
            })
        };
        assert_eq!([1, 2, 1, 3, 1].map(get), [10, 20, 10, 30, 10]);
        assert_eq!(made.get(), 3);
        assert_eq!((get(2), made.get()), (20, 4));
    }
}
