use scaleproof_frames::render::blender::{BlenderEvent, read_events};

#[test]
fn the_scripts_lines_are_told_from_blenders() {
    let text = "Blender 4.5\nFra:1 Mem:40M\ngeometry az0_p15_d500\nframe a b\n";
    let mut events = Vec::new();
    let mut keep = |event| {
        events.push(event);
        Ok(())
    };
    read_events(text.as_bytes(), &mut keep).unwrap();
    assert_eq!(
        events,
        [
            BlenderEvent::Geometry("az0_p15_d500".into()),
            BlenderEvent::Frame("a b".into())
        ]
    );
    let refused = read_events(&b"refused the light is black\n"[..], &mut |_| Ok(())).unwrap_err();
    assert_eq!(refused.to_string(), "the light is black");
}
