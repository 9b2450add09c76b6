use rand::{RngExt, SeedableRng};
use scaleproof_attack::run::Rgb;
use scaleproof_attack::run::resample::{AROUND, Resample};

#[test]
fn the_transposed_map_is_the_transposed_map() {
    let mut rng = rand_pcg::Pcg32::seed_from_u64(4);
    let size = [13, 9];
    for (scale, offset) in [(1.0, [0.0, 0.0]), (0.4, [2.3, -1.0]), (1.7, [-3.0, 0.5])] {
        let map = Resample::new(size, scale, offset);
        let mut noise = || -> Vec<Rgb> { (0..13 * 9).map(|_| std::array::from_fn(|_| rng.random())).collect() };
        let (x, y) = (noise(), noise());
        let zero = map.forward(&vec![[0.0; 3]; 13 * 9]);
        let product =
            |a: &[Rgb], b: &[Rgb]| -> f64 { a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum() };
        let forward = product(&map.forward(&x), &y) - product(&zero, &y);
        assert!((forward - product(&x, &map.0.transposed(&y))).abs() < 1e-9, "{scale}");
    }
    let flat = Resample::new(size, 0.5, [0.0, 0.0]).forward(&vec![[1.0; 3]; 13 * 9]);
    assert!(
        (flat[4 * 13 + 6][0] - 1.0).abs() < 1e-9,
        "white stays white in the middle"
    );
    assert!((flat[0][0] - AROUND).abs() < 1e-9, "and grey is around it");
}

#[test]
fn size_one_is_no_change() {
    let image: Vec<Rgb> = (0..12).map(|i| [f64::from(i) / 12.0; 3]).collect();
    let same = Resample::new([4, 3], 1.0, [0.0, 0.0]).forward(&image);
    assert!(same.iter().zip(&image).all(|(a, b)| (a[0] - b[0]).abs() < 1e-12));
}
