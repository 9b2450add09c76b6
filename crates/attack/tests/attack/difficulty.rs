use scaleproof_attack::run::batch;
use scaleproof_attack::run::difficulty::Difficulty;

#[test]
fn hard_views_come_often_and_all_come() {
    let views: Vec<usize> = (0..20).collect();
    let mut difficulty = Difficulty::new(20);
    views
        .iter()
        .for_each(|view| difficulty.observe(*view, if *view == 7 { 8.0 } else { 0.2 }));
    let mut seen = [0; 20];
    for step in 0..200 {
        let batch = difficulty.batch(&views, 4, 0.5, 1, step);
        let different: std::collections::BTreeSet<_> = batch.iter().collect();
        assert_eq!(different.len(), 4, "no view twice");
        batch.iter().for_each(|view| seen[*view] += 1);
    }
    assert!(seen[7] > 150, "{seen:?}");
    assert!(seen.iter().all(|times| *times >= 10), "{seen:?}");
    assert_eq!(difficulty.batch(&views, 4, 0.0, 1, 3), batch(&views, 4, 1, 3));
}
