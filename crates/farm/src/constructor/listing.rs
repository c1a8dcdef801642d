use std::{
    collections::BTreeMap,
    ops::Deref,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// Records by number.
pub(super) struct Listing<T>(Mutex<BTreeMap<u32, Arc<T>>>);

/// A record that is listed until this is dropped.
pub(super) struct Entry<'a, T> {
    listing: &'a Listing<T>,
    id: u32,
    record: Arc<T>,
}

impl<T> Listing<T> {
    pub(super) fn enter(&self, id: u32, record: T) -> Entry<'_, T> {
        let record = Arc::new(record);
        lock(&self.0).insert(id, record.clone());
        Entry {
            listing: self,
            id,
            record,
        }
    }

    /// All there are now.
    pub(super) fn all(&self) -> BTreeMap<u32, Arc<T>> {
        lock(&self.0).clone()
    }
}

impl<T> Default for Listing<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Deref for Entry<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.record
    }
}

impl<T> Drop for Entry<'_, T> {
    fn drop(&mut self) {
        lock(&self.listing.0).remove(&self.id);
    }
}

/// Locks what nothing can leave half-way.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
