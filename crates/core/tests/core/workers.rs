//! Work over threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use scaleproof_core::files;
use scaleproof_core::workers::{each, interruption, map, map_over};

#[test]
fn results_keep_the_order_of_the_items() {
    let items: Vec<u64> = (0..200).collect();
    let squares = map(&items, || Ok::<_, String>(()), |(), n| Ok(n * n), || {}).unwrap();
    assert_eq!(squares, items.iter().map(|n| n * n).collect::<Vec<_>>());
}

#[test]
fn an_error_ends_the_work() {
    let items: Vec<u64> = (0..200).collect();
    let fail = |(): &mut (), n: &u64| if *n == 7 { Err("seven") } else { Ok(*n) };
    assert_eq!(map(&items, || Ok(()), fail, || {}), Err("seven"));
    assert_eq!(
        map(&items, || Err::<(), _>("no state"), |(), n| Ok(*n), || {}),
        Err("no state")
    );
}

#[test]
fn an_interrupted_thread_leaves_the_rest_and_writes_nothing() {
    let flag = Arc::new(AtomicBool::new(false));
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("out.txt");
    let done = AtomicUsize::new(0);
    let ended = std::thread::scope(|scope| {
        let work = scope.spawn(|| {
            interruption::heed(Some(Arc::clone(&flag)));
            let items: Vec<usize> = (0..1000).collect();
            let inner = |item: &usize| {
                done.fetch_add(1, Ordering::Relaxed);
                flag.store(*item == 3, Ordering::Relaxed);
            };
            // Also where workers have workers.
            let look = |(): &mut (), item: &usize| Ok::<_, ()>(each(&[*item], inner));
            let _ = map_over(1, &items, || Ok(()), look, || ());
            files::write_atomically(&file, b"done").unwrap();
        });
        work.join().unwrap_err()
    });
    assert!(ended.is::<interruption::Interrupted>());
    assert_eq!(done.load(Ordering::Relaxed), 4);
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
    // Another thread heeds no flag.
    files::write_atomically(&file, b"done").unwrap();
    assert!(file.is_file());
}
