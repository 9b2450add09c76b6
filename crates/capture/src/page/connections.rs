//! Limits on connections: the one that is closed when there are too many.
//!
//! A connection is a stranger's until a request on it was one of a known browser. When there are too many strangers, the longest connected
//! of the address that has most of them leaves: a known browser says who it is as soon as it is heard, and who only holds a place does not
//! keep others out.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

/// More than the runtime accepts before it lets the accepted ones speak, 128 at a time.
pub const MOST_STRANGERS: usize = 256;

/// A browser uses 6 connections to a site; several pages and phones share an address on this machine.
pub const MOST_OF_A_BROWSER: usize = 48;

/// All connections of a server.
#[derive(Debug, Default)]
pub struct Connections {
    seats: Mutex<Seats>,
}

/// Connections by their numbers, in the order in which they came.
#[derive(Debug, Default)]
struct Seats {
    taken: BTreeMap<u64, Seat>,
    next: u64,
}

#[derive(Debug)]
struct Seat {
    from: IpAddr,
    /// `None` for a stranger.
    browser: Option<String>,
    leave: Arc<Notify>,
}

/// One connection's place, free again when dropped.
#[derive(Debug)]
pub struct Connection {
    number: u64,
    connections: Arc<Connections>,
    leave: Arc<Notify>,
}

impl Connections {
    /// Registers a new connection. Another one may be closed for it.
    pub fn enter(self: &Arc<Connections>, from: IpAddr) -> Connection {
        let mut seats = self.seats();
        if seats.strangers().count() >= MOST_STRANGERS {
            let longest = seats.longest_of_the_crowd();
            seats.ask_to_leave(longest);
        }
        let (number, leave) = (seats.next, Arc::new(Notify::new()));
        seats.next += 1;
        let seat = Seat {
            from,
            browser: None,
            leave: leave.clone(),
        };
        seats.taken.insert(number, seat);
        let connections = self.clone();
        Connection {
            number,
            connections,
            leave,
        }
    }

    /// Returns the number of connections.
    pub fn count(&self) -> usize {
        self.seats().taken.len()
    }

    fn seats(&self) -> MutexGuard<'_, Seats> {
        self.seats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Connection {
    /// Registers the connection as one of this browser. If it has too many, its oldest is closed.
    pub fn belongs_to(&self, browser: &str) {
        let mut seats = self.connections.seats();
        let is_own = |seat: &Seat| seat.browser.as_deref() == Some(browser);
        let seat = seats.taken.get_mut(&self.number);
        let Some(seat) = seat.filter(|seat| !is_own(seat)) else {
            return;
        };
        seat.browser = Some(browser.to_owned());
        let own = seats.taken.iter().filter(|(_, seat)| is_own(seat));
        if own.clone().count() > MOST_OF_A_BROWSER {
            let longest = own.map(|(number, _)| *number).find(|number| *number != self.number);
            seats.ask_to_leave(longest);
        }
    }

    /// Returns true if the connection has not been closed for another.
    pub fn is_kept(&self) -> bool {
        self.connections.seats().taken.contains_key(&self.number)
    }

    /// Ends when the connection is to be closed for another.
    pub async fn asked_to_leave(&self) {
        self.leave.notified().await;
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.connections.seats().taken.remove(&self.number);
    }
}

impl Seats {
    fn strangers(&self) -> impl Iterator<Item = (&u64, &Seat)> {
        self.taken.iter().filter(|(_, seat)| seat.browser.is_none())
    }

    /// Returns the oldest connection of the address with most strangers.
    fn longest_of_the_crowd(&self) -> Option<u64> {
        let mut crowds: BTreeMap<IpAddr, (usize, u64)> = BTreeMap::new();
        for (number, seat) in self.strangers() {
            crowds.entry(seat.from).or_insert((0, *number)).0 += 1;
        }
        // Of equal counts, that of the oldest.
        let crowds = crowds.into_values().map(|(count, longest)| (count, Reverse(longest)));
        crowds.max().map(|(_, Reverse(longest))| longest)
    }

    /// Removes a connection from the count, and tells it to close.
    fn ask_to_leave(&mut self, number: Option<u64>) {
        if let Some(seat) = number.and_then(|number| self.taken.remove(&number)) {
            seat.leave.notify_one();
        }
    }
}
