use scaleproof_score::observe::preview::has_preview;

#[test]
fn a_thousand_photos_at_most_have_previews() {
    for photos in [1, 999, 1000, 1001, 10_000, 21_600] {
        let shown: Vec<u64> = (1..=photos as u64).filter(|id| has_preview(*id, photos)).collect();
        assert_eq!(shown.len(), photos.min(1000));
        let widest = shown.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(1);
        assert!(widest as usize <= photos.div_ceil(1000), "spread evenly");
    }
}
