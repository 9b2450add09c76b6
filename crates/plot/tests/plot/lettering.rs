use scaleproof_plot::lettering::{shortened, width_mm, wrapped};

#[test]
fn long_names_lose_their_middle() {
    let short = shortened("a-very-long-file-name-of-a-pattern.png", 2.0, 20.0);
    assert!(
        short.starts_with("a-v") && short.ends_with(".png") && short.contains('…'),
        "{short}"
    );
    assert!(width_mm(&short, 2.0) <= 20.0);
    assert_eq!(shortened("short.png", 2.0, 20.0), "short.png");
}

#[test]
fn lines_break_at_spaces() {
    assert_eq!(wrapped("one two three four", 2.0, 12.0), ["one two", "three four"]);
    assert_eq!(wrapped("unbreakable", 2.0, 1.0), ["unbreakable"]);
}
