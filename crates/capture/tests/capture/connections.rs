//! Who stays connected when there are more than there is room for.

use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;

use scaleproof_capture::page::connections::{Connection, Connections, MOST_OF_A_BROWSER, MOST_STRANGERS};

fn address(last: u8) -> IpAddr {
    Ipv4Addr::new(192, 168, 0, last).into()
}

#[test]
fn the_longest_stranger_of_the_largest_crowd_leaves_and_known_browsers_stay() {
    let connections = Arc::new(Connections::default());
    let known = connections.enter(address(1));
    known.belongs_to("phone");
    let lone = connections.enter(address(2));
    let crowd: Vec<Connection> = (1..MOST_STRANGERS).map(|_| connections.enter(address(1))).collect();
    let late = connections.enter(address(3));
    assert!(known.is_kept() && lone.is_kept() && late.is_kept());
    assert!(!crowd[0].is_kept() && crowd[1..].iter().all(Connection::is_kept));
    drop(crowd);
    assert_eq!(connections.count(), 3);
}

#[test]
fn a_browser_with_too_many_connections_loses_its_oldest() {
    let connections = Arc::new(Connections::default());
    let own: Vec<Connection> = (0..MOST_OF_A_BROWSER + 1)
        .map(|_| {
            let place = connections.enter(address(1));
            place.belongs_to("phone");
            place.belongs_to("phone");
            place
        })
        .collect();
    assert!(!own[0].is_kept() && own[1..].iter().all(Connection::is_kept));
}
