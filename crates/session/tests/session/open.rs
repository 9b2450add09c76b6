use scaleproof_core::geometry::BoxPx;
use scaleproof_session::Session;

const SCENE: &str = "[model]\nname='m'\nscale=10\nclass='car'\nsize_mm=[400,180,120]\n[bins]\nazimuth_deg=45\npitch_deg=[15]\ndistance_mm=[800]\n";
const CAMERA: &str = "image_width: 64\nimage_height: 48\ncamera_matrix: {rows: 3, cols: 3, data: [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";

fn opened(photos: &str) -> Result<Session, String> {
    opened_with("\"camera\":\"camera.yaml\",", photos)
}

fn opened_with(camera: &str, photos: &str) -> Result<Session, String> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("scene.toml", SCENE);
    write("camera.yaml", CAMERA);
    write(
        "session.json",
        &format!("{{\"scene\":\"scene.toml\",{camera}\n\"photos\":[{photos}]}}"),
    );
    Session::open(folder.path()).map_err(|e| e.to_string())
}

#[test]
fn truth_from_elsewhere_is_kept() {
    let session = opened(
        r#"{"file":"a.jpg","variant":"normal","box_xyxy_px":[1,2,30,40],
            "viewpoint":{"azimuth_deg":90,"pitch_deg":15,"distance_mm":800}}"#,
    )
    .unwrap();
    assert_eq!(session.photos[0].box_xyxy_px, Some(BoxPx::new(1.0, 2.0, 30.0, 40.0)));
    assert_eq!(session.photos[0].viewpoint.unwrap().azimuth_deg, 90.0);
    assert_eq!(session.hashes.len(), 3);
}

#[test]
fn without_a_camera_every_photo_needs_box_and_viewpoint() {
    let whole = r#"{"file":"a.jpg","variant":"normal","box_xyxy_px":[1,2,30,40],
            "viewpoint":{"azimuth_deg":90,"pitch_deg":15,"distance_mm":800}}"#;
    let session = opened_with("", whole).unwrap();
    assert!(session.camera.is_none() && session.hashes.len() == 2);
    let boxed = r#"{"file":"b.jpg","variant":"normal","box_xyxy_px":[1,2,30,40]}"#;
    let error = opened_with("", &format!("{whole},{boxed}")).unwrap_err();
    assert!(error.contains("names no camera, and b.jpg has not both"), "{error}");
}

#[test]
fn photos_may_lie_beside_the_session() {
    let session = opened(r#"{"file":"../monday/a.jpg","variant":"normal"}"#).unwrap();
    assert_eq!(
        session.photo_path(&session.photos[0]),
        session.folder.join("../monday/a.jpg")
    );
}

#[test]
fn sessions_that_would_mislead_are_refused() {
    let a = r#"{"file":"a.jpg","variant":"normal"}"#;
    for (photos, reason) in [
        (String::new(), "lists no photos"),
        (format!("{a},{a}"), "a.jpg is listed twice"),
        (a.replace("normal", " "), "a.jpg has no variant"),
        (
            a.replace("}", ",\"box_xyxy_px\":[5,5,5,9]}"),
            "box_xyxy_px of a.jpg is empty",
        ),
        (a.replace("normal", "normal "), "blanks around it"),
        (a.replace("a.jpg", "/a.jpg"), "no path from the session's folder"),
        (a.replace("a.jpg", "b/../a.jpg"), "no path from the session's folder"),
        (a.replace("a.jpg", "./a.jpg"), "no path from the session's folder"),
        (a.replace("a.jpg", ".."), "no path from the session's folder"),
        (a.replace("a.jpg", ""), "no path from the session's folder"),
        (
            a.replace(
                "}",
                ",\"viewpoint\":{\"azimuth_deg\":400,\"pitch_deg\":0,\"distance_mm\":9}}",
            ),
            "viewpoint of a.jpg is impossible",
        ),
        (a.replace("variant", "varient"), "line 2: unknown field `varient`"),
    ] {
        let error = opened(&photos).unwrap_err();
        assert!(error.contains(reason) && !error.contains('\n'), "{error}");
    }
}
