use scaleproof_session::conditions::{is_name, read};

#[test]
fn values_are_texts_whatever_they_were() {
    let read = |text: &str| read(&mut serde_json::Deserializer::from_str(text)).map_err(|e| e.to_string());
    let kept = read(r#"{"weather":" rain ","lux":300,"theta":0.5,"dusk":true}"#).unwrap();
    let texts: Vec<_> = kept.values().map(String::as_str).collect();
    assert_eq!(texts, ["true", "300", "0.5", "rain"]);
    let fault = read(r#"{"weather":["rain"]}"#).unwrap_err();
    assert!(
        fault.contains("`weather` is [\"rain\"]: give a text or a number"),
        "{fault}"
    );
    for (name, is_good) in [
        ("lux", true),
        ("sun angle", true),
        ("a,b", false),
        ("a:b", false),
        (" a", false),
        ("", false),
    ] {
        assert_eq!(is_name(name), is_good, "{name}");
    }
}
