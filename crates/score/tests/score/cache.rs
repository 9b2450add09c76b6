use scaleproof_score::Cache;

#[test]
fn an_entry_comes_back_bit_for_bit_and_a_damaged_one_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::open(folder.path(), "libraries").unwrap();
    let (key, other) = (cache.key(&["photo", "ab"]), cache.key(&["photoa", "b"]));
    assert_ne!(key, other);
    let value = vec![0.1 + 0.2, f64::MIN_POSITIVE, -0.0];
    cache.put(&key, &value);
    assert_eq!(cache.get::<Vec<f64>>(&key), Some(value));
    assert_eq!(cache.get::<Vec<f64>>(&other), None);
    assert!(cache.complaints().is_empty(), "a missing entry is no problem");
    let path = cache.path(&key);
    let whole = std::fs::read(&path).unwrap();
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 4;
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(cache.get::<Vec<f64>>(&key), None, "byte {at} was changed");
    }
    std::fs::write(&path, &whole[..40]).unwrap();
    assert_eq!(cache.get::<Vec<f64>>(&key), None);
    let complaints = cache.complaints();
    assert!(complaints.len() == 1 && complaints[0].contains("damaged entries of the cache"));
    // An entry in another's place.
    cache.put(&key, &vec![1.0]);
    std::fs::create_dir_all(cache.path(&other).parent().unwrap()).unwrap();
    std::fs::copy(&path, cache.path(&other)).unwrap();
    assert_eq!(cache.get::<Vec<f64>>(&other), None);
}

#[test]
fn other_libraries_find_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let key = |libraries| Cache::open(folder.path(), libraries).unwrap().key(&["photo"]);
    assert_eq!(key("a"), key("a"));
    assert_ne!(key("a"), key("b"));
}
