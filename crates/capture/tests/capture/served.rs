//! Cameras that stream, served on loopback: motion JPEG over HTTP by a thread of the test, RTSP by GStreamer's server. A photographer walks on in
//! front of each when the session has another photo.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use image::RgbImage;
use scaleproof_capture::stream::{self, StreamAddress};
use scaleproof_capture::{Capture, FrameSource, Original};
use scaleproof_photo::Photo;
use scaleproof_pose::camera::Camera;

use super::stored::{capture, skyline};
use scaleproof_testing::HANG;
use scaleproof_testing::served::{MULTIPART, part, serve, taken};

/// A photo of the stored session.
fn photo(number: usize) -> Vec<u8> {
    std::fs::read(skyline(&format!("normal_{number:03}.jpg"))).unwrap()
}

/// Photographs until a session has so many photos; the sentences of frames that were none.
fn photographed(address: &str, capture: &mut Capture, count: usize) -> Vec<String> {
    let camera = Camera::open(&skyline("camera.yaml")).unwrap();
    let mut live = stream::open(&StreamAddress::new(address), &camera).unwrap();
    let (mut said, began) = (Vec::new(), Instant::now());
    while capture.guidance().filled_of_all().0 < count {
        let frame = live.next().unwrap().unwrap();
        if let Original::Unreadable(sentence) = &frame.original {
            said.push(sentence.clone());
        }
        capture.see(&frame).unwrap();
        assert!(began.elapsed() < HANG, "{said:?}");
    }
    said
}

#[test]
fn a_camera_that_breaks_off_and_sends_garbage_is_connected_again() {
    let session = tempfile::tempdir().unwrap();
    let mut capture = capture(session.path());
    let place = session.path().to_owned();
    let port = serve(move |number, _, connection| {
        match number {
            // Until there is a photo; then it breaks off within an image.
            0 => {
                connection.write_all(MULTIPART.as_bytes())?;
                while taken(&place) == 0 {
                    part(connection, &photo(0))?;
                }
                write!(connection, "--frame\r\nContent-Type: image/jpeg\r\n\r\n")?;
                connection.write_all(&photo(0)[..9000])
            }
            1 => {
                connection.write_all(MULTIPART.as_bytes())?;
                connection.write_all(&[0xA5; 100_000])
            }
            _ => {
                connection.write_all(MULTIPART.as_bytes())?;
                // Garbage between images, and half an image, are left out.
                part(connection, &[0xA5; 5000])?;
                part(connection, &photo(2)[..70_000])?;
                loop {
                    part(connection, &photo(2))?;
                }
            }
        }
    });
    let said = photographed(&format!("http://127.0.0.1:{port}/"), &mut capture, 2);
    let lost: Vec<&String> = said
        .iter()
        .filter(|sentence| sentence.contains("broke off ("))
        .collect();
    assert!(lost.len() >= 2, "{said:?}");
    assert!(lost[0].contains("connecting again in 0.5 s, try 1 of 5"), "{said:?}");
    for (number, kept) in [(0, "normal_000.jpg"), (2, "normal_001.jpg")] {
        assert!(
            std::fs::read(session.path().join(kept)).unwrap() == photo(number),
            "{kept}"
        );
    }
}

/// GStreamer's server; it ends with this.
struct RtspServer(Child, u16);

impl RtspServer {
    fn start(folder: &Path, session: &Path, [user, password]: [&str; 2]) -> RtspServer {
        let video = folder.join("views.h264");
        if !video.exists() {
            let encoded = Command::new("ffmpeg")
                .args(["-v", "error", "-i"])
                .arg(skyline("normal_%03d.jpg"))
                .args([
                    "-frames:v",
                    "2",
                    "-c:v",
                    "libx264",
                    "-qp",
                    "14",
                    "-g",
                    "1",
                    "-x264-params",
                    "aud=1",
                ])
                .args([
                    "-vf",
                    "scale=out_color_matrix=bt709:out_range=tv",
                    "-pix_fmt",
                    "yuv420p",
                ])
                .args(["-colorspace", "bt709", "-color_range", "tv", "-f", "h264"])
                .arg(&video)
                .output()
                .expect("ffmpeg is installed");
            assert!(encoded.status.success(), "{encoded:?}");
        }
        let mut server = Command::new("/usr/bin/python3")
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/rtsp_server.py"))
            .args([video.as_path(), session])
            .args([user, password])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("python3 is installed");
        let mut port = String::new();
        BufReader::new(server.stdout.as_mut().unwrap())
            .read_line(&mut port)
            .unwrap();
        let port = port.trim().parse();
        RtspServer(
            server,
            port.expect("GStreamer's RTSP server is installed (gir1.2-gst-rtsp-server-1.0, gstreamer1.0-plugins-good)"),
        )
    }
}

impl Drop for RtspServer {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Peak signal-to-noise ratio of two images, dB.
fn psnr(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let squares: f64 = a
        .iter()
        .zip(b.iter())
        .map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2))
        .sum();
    10.0 * (255.0f64.powi(2) * a.as_raw().len() as f64 / squares).log10()
}

#[test]
fn an_rtsp_camera_fills_views_with_its_images_and_its_end_is_told() {
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let mut capture = capture(&session);
    let server = RtspServer::start(out.path(), &session, ["admin", "s3cret"]);
    let address = format!("rtsp://admin:s3cret@127.0.0.1:{}/camera", server.1);
    assert_eq!(photographed(&address, &mut capture, 2), Vec::<String>::new());
    for number in 0..2 {
        let rgb = |path: &Path| Photo::open(path).unwrap().rgb(1).unwrap();
        let kept = rgb(&session.join(format!("normal_{number:03}.png")));
        let psnr = psnr(&kept, &rgb(&skyline(&format!("normal_{number:03}.jpg"))));
        println!("photo {number}: {psnr:.1} dB");
        // H.264 at 4:2:0 and this quality; another matrix of colours gives 27 dB.
        assert!(psnr > 33.0, "{psnr}");
    }
    // Switched off in mid-stream.
    let camera = Camera::open(&skyline("camera.yaml")).unwrap();
    let mut live = stream::open(&StreamAddress::new(&address), &camera).unwrap();
    live.next().unwrap();
    drop(server);
    let sentence = loop {
        if let Original::Unreadable(sentence) = live.next().unwrap().unwrap().original {
            break sentence;
        }
    };
    assert!(
        sentence.contains("/camera broke off (") && !sentence.contains("s3cret"),
        "{sentence}"
    );
    // Another's password, and a path that is not there.
    let server = RtspServer::start(out.path(), &session, ["admin", "s3cret"]);
    for (user, path, expected) in [("admin:wr0ng@", "camera", "401"), ("admin:s3cret@", "nothing", "404")] {
        let address = format!("rtsp://{user}127.0.0.1:{}/{path}", server.1);
        let refused = stream::open(&StreamAddress::new(&address), &camera)
            .err()
            .unwrap()
            .to_string();
        assert!(
            refused.contains(expected) && !refused.contains("wr0ng") && !refused.contains("s3cret"),
            "{refused}"
        );
    }
}
