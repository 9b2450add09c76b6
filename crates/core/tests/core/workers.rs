//! Work over threads.

use scaleproof_core::workers::map;

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
