//! Values that are expensive to make and that tests share, such as a GPU device with its compiled pipelines.

use std::{
    any::Any,
    cell::RefCell,
    sync::{Mutex, MutexGuard, PoisonError},
};

/// The most values of a pool. Each device compiles its own pipelines, so more devices than this cost more than they save.
const MOST: usize = 4;

/// A pool with as many values as tests run at once, [`MOST`] at most. A test has the same value until its thread ends.
///
/// Tests that share one GPU device wait for each other: a software driver compiles and runs the commands of a queue on
/// one thread.
#[derive(Debug)]
pub struct Pool<T: 'static>(Mutex<Vec<Member<T>>>);

#[derive(Debug)]
struct Member<T: 'static> {
    value: &'static T,
    /// Number of threads that use the value.
    users: usize,
}

/// A value that the current thread uses.
struct Lease {
    value: &'static (dyn Any + Send + Sync),
    end: Box<dyn Fn()>,
}

impl Drop for Lease {
    fn drop(&mut self) {
        (self.end)();
    }
}

thread_local! {
    static LEASES: RefCell<Vec<Lease>> = const { RefCell::new(Vec::new()) };
}

impl<T: Send + Sync> Pool<T> {
    /// Creates an empty pool. A program has at most one pool per type.
    #[allow(clippy::new_without_default)] // Pools are statics.
    pub const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Returns the value of this thread. `make` makes one if all are in use; `None` if it fails.
    pub fn get(&'static self, make: impl FnOnce() -> Option<T>) -> Option<&'static T> {
        let leased =
            LEASES.with_borrow(|leases| leases.iter().find_map(|lease| lease.value.downcast_ref::<T>()));
        if leased.is_some() {
            return leased;
        }
        let value = self.lease(make)?;
        let end = Box::new(move || {
            let mut members = self.members();
            if let Some(member) = members.iter_mut().find(|member| std::ptr::eq(member.value, value)) {
                member.users -= 1;
            }
        });
        LEASES.with_borrow_mut(|leases| leases.push(Lease { value, end }));
        Some(value)
    }

    fn lease(&self, make: impl FnOnce() -> Option<T>) -> Option<&'static T> {
        let mut members = self.members();
        let most = std::thread::available_parallelism().map_or(1, usize::from).min(MOST);
        let is_full = members.len() >= most;
        match members.iter_mut().min_by_key(|member| member.users) {
            Some(member) if is_full || member.users == 0 => {
                member.users += 1;
                Some(member.value)
            }
            _ => {
                let value = Box::leak(Box::new(make()?));
                members.push(Member { value, users: 1 });
                Some(value)
            }
        }
    }

    fn members(&self) -> MutexGuard<'_, Vec<Member<T>>> {
        // A failed test leaves the list consistent.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
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
    fn failures_are_not_kept() {
        static POOL: Pool<String> = Pool::new();
        assert_eq!(POOL.get(|| None), None);
        assert_eq!(POOL.get(|| Some("made".into())).map(String::as_str), Some("made"));
    }
}
