//! Values that are expensive to make and that tests share, such as a GPU device with its compiled pipelines.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// The most values of a pool. Each device compiles its own pipelines, so more devices than this cost more than they
/// save.
const SLOTS: usize = 4;

/// Number of threads that use each slot.
static USERS: Mutex<[usize; SLOTS]> = Mutex::new([0; SLOTS]);

thread_local! {
    static SLOT: Slot = Slot::take();
}

/// The slot of a thread, the same in all pools: a fixture belongs to the device that it was made with.
struct Slot(usize);

impl Slot {
    /// Takes the slot with the fewest users, among as many as tests run at once.
    fn take() -> Self {
        let count = std::thread::available_parallelism().map_or(1, usize::from).min(SLOTS);
        let mut users = users();
        let slot = (0..count).min_by_key(|slot| users[*slot]).unwrap_or(0);
        users[slot] += 1;
        Self(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        users()[self.0] -= 1;
    }
}

fn users() -> MutexGuard<'static, [usize; SLOTS]> {
    // A failed test leaves the counts consistent.
    USERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A value for each test that runs at once, four at most. A test has the same value until its thread ends.
///
/// Tests that share one GPU device wait for each other: a software driver compiles and runs the commands of a queue on
/// one thread.
#[derive(Debug)]
pub struct Pool<T>([OnceLock<Option<T>>; SLOTS]);

impl<T> Pool<T> {
    /// Creates an empty pool.
    #[allow(clippy::new_without_default)] // Pools are statics.
    pub const fn new() -> Self {
        Self([const { OnceLock::new() }; SLOTS])
    }

    /// Returns the value of this thread. `make` makes it for the first thread in the slot.
    pub fn get(&self, make: impl FnOnce() -> Option<T>) -> Option<&T> {
        SLOT.with(|slot| self.0[slot.0].get_or_init(make).as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;

    #[test]
    fn threads_have_values_of_their_own_and_give_them_back() {
        static POOL: Pool<u32> = Pool::new();
        let address = || {
            let first = POOL.get(|| Some(7)).unwrap();
            assert!(std::ptr::eq(first, POOL.get(|| None).unwrap()), "a thread keeps its value");
            std::ptr::from_ref(first).addr()
        };
        let barrier = Barrier::new(2);
        let meet = || {
            let address = address();
            barrier.wait();
            address
        };
        let (a, b) = std::thread::scope(|scope| {
            let (a, b) = (scope.spawn(meet), scope.spawn(meet));
            (a.join().unwrap(), b.join().unwrap())
        });
        assert_eq!(a == b, std::thread::available_parallelism().is_ok_and(|count| count.get() == 1));
        let later = std::thread::scope(|scope| scope.spawn(address).join().unwrap());
        assert!([a, b].contains(&later), "a value is used again");
    }

    #[test]
    fn threads_have_one_slot_in_all_pools() {
        static DEVICES: Pool<usize> = Pool::new();
        static FIXTURES: Pool<usize> = Pool::new();
        let device = || DEVICES.get(|| Some(SLOT.with(|slot| slot.0)));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| assert_eq!(FIXTURES.get(|| device().copied()), device()));
            }
        });
    }
}
