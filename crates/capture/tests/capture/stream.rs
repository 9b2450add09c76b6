//! Streams that break off, and the passwords in their addresses.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use scaleproof_capture::live::{PixelFormat, RawImage};
use scaleproof_capture::stream::{self, BACK_OFF, Connection, StreamAddress, StreamScheme};
use scaleproof_capture::{FrameSource, LiveCamera, Original, SourceName};

#[test]
fn nothing_that_is_shown_of_an_address_has_its_password() {
    let shown = [
        ("http://10.0.0.7:8080/video", "http://10.0.0.7:8080/video"),
        ("rtsp://admin:s3cret@cam/h264", "rtsp://cam/h264"),
        ("rtsp://admin:s3cret@[fe80::1]:554/h264", "rtsp://[fe80::1]:554/h264"),
        ("http://cam/mjpg?user=admin&pwd=s3cret", "http://cam/mjpg?…"),
        ("rtsp://admin:p@s3cret/x?@cam/1", "rtsp://cam/1"),
        ("ftp://admin:s3cret@cam", "ftp://cam"),
    ];
    for (given, expected) in shown {
        let address = StreamAddress::new(given);
        assert_eq!(address.to_string(), expected);
        let name: SourceName = given.parse().unwrap();
        assert!(!format!("{address:?} {name:?}").contains("s3cret"), "{given}");
        assert_eq!(name.kind(), "stream");
    }
}

#[test]
fn only_http_and_rtsp_addresses_are_read() {
    let scheme = |text: &str| StreamAddress::new(text).scheme();
    assert_eq!(scheme("http://cam:81/video"), Ok(StreamScheme::Http));
    assert_eq!(scheme("RTSP://u:p@[::1]:554/a"), Ok(StreamScheme::Rtsp));
    let refused = [
        ("file:///etc/passwd", "begins with http:// or rtsp://"),
        ("concat://a|b", "begins with http:// or rtsp://"),
        ("https://cam/video", "use that address"),
        ("http:///video", "names no host"),
        ("http://u:p@", "names no host"),
        ("rtsp://cam:99999/", "port"),
        ("http://cam/a b", "blanks"),
    ];
    for (text, sentence) in refused {
        assert!(scheme(text).unwrap_err().contains(sentence), "{text}");
    }
    // Folders and cameras are no addresses.
    for name in ["watch:/mnt/a://b", "replay:x", "camera:1"] {
        assert!(!matches!(name.parse().unwrap(), SourceName::Stream(_)), "{name}");
    }
}

/// Shorter than those of a real stream.
const WAITS: &[Duration] = &[
    Duration::from_millis(400),
    Duration::from_millis(600),
    Duration::from_millis(400),
];

/// A connection that gives so many images.
struct Fake(u32, u32);

impl Connection for Fake {
    fn image(&mut self) -> Result<RawImage, String> {
        self.0 = self.0.checked_sub(1).ok_or("it was switched off")?;
        std::thread::sleep(Duration::from_millis(5));
        let side = self.1;
        Ok(RawImage {
            format: PixelFormat::Grey,
            width: side,
            height: side,
            bytes: vec![9; (side * side) as usize],
        })
    }

    fn described(&self) -> String {
        "fake".into()
    }
}

/// A stream whose connections give so many images of a side each; none is made after the last.
fn fake(connections: Vec<(u32, u32)>) -> (LiveCamera, Arc<AtomicU32>) {
    let made = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&made);
    let connect = move || -> Result<Box<dyn Connection>, String> {
        let number = count.fetch_add(1, Ordering::SeqCst) as usize;
        let (images, side) = *connections.get(number).ok_or("connection refused")?;
        Ok(Box::new(Fake(images, side)))
    };
    let live = stream::start("http://cam/video", WAITS, connect, |size| size == [8, 8]);
    (live.unwrap(), made)
}

/// The sentences of a stream until it ends, and how it does.
fn followed(mut live: LiveCamera) -> (Vec<String>, usize, String) {
    let (mut said, mut images) = (Vec::new(), 0);
    loop {
        match live.next() {
            Ok(Some(frame)) => match frame.original {
                Original::Unreadable(sentence) => said.push(sentence),
                _ => images += 1,
            },
            Ok(None) => panic!("a stream does not end in silence"),
            Err(e) => return (said, images, e.to_string()),
        }
    }
}

#[test]
fn a_stream_that_breaks_off_is_connected_again_and_says_so() {
    assert_eq!(
        BACK_OFF.iter().sum::<Duration>(),
        Duration::from_millis(15_500),
        "those of a real stream"
    );
    let began = Instant::now();
    let (mut live, made) = fake(vec![(3, 8), (5, 8), (1000, 8)]);
    let (mut said, mut images) = (Vec::new(), 0);
    while made.load(Ordering::SeqCst) < 3 || images < 12 {
        match live.next().unwrap().unwrap().original {
            Original::Unreadable(sentence) => said.push(sentence),
            _ => images += 1,
        }
    }
    assert!(began.elapsed() > Duration::from_millis(1000), "{:?}", began.elapsed());
    let sentence = |wait: &str, number: u32| {
        format!(
            "the stream http://cam/video broke off (it was switched off): connecting again in {wait} s, try {number} of 3"
        )
    };
    assert_eq!(said, [sentence("0.4", 1), sentence("0.6", 2)]);
    let settings = live.settings().unwrap().to_string();
    assert!(
        settings.starts_with("http://cam/video, fake 8 × 8: exposure, focus, white balance cannot be held"),
        "{settings}"
    );
}

#[test]
fn a_stream_of_another_size_is_refused_and_one_that_changes_it_is_not_taken_for_the_same() {
    let connect = || Ok(Box::new(Fake(5, 7)) as Box<dyn Connection>);
    let refused = stream::start("http://cam/video", WAITS, connect, |size| size == [8, 8])
        .err()
        .unwrap()
        .to_string();
    assert!(
        refused.contains("its images are 7 × 7 px, of another shape"),
        "{refused}"
    );
    let refused = stream::start("http://cam/video", WAITS, || Err("no route".into()), |_| true)
        .err()
        .unwrap()
        .to_string();
    assert!(
        refused.starts_with("the stream http://cam/video cannot be used (no route)"),
        "{refused}"
    );
    let (mut live, made) = fake(vec![(2, 8), (9, 6), (1000, 8)]);
    let mut said = Vec::new();
    while made.load(Ordering::SeqCst) < 3 {
        if let Original::Unreadable(sentence) = live.next().unwrap().unwrap().original {
            said.push(sentence);
        }
    }
    assert!(
        said[1].contains("its images were 8 × 8 px and are 6 × 6 now"),
        "{said:?}"
    );
}

#[test]
fn after_the_last_try_it_is_over() {
    let (said, images, end) = followed(fake(vec![(4, 8)]).0);
    assert!(said.len() == 3 && (1..=4).contains(&images), "{said:?}");
    assert!(
        end.contains("gives no more images (connection refused, after 3 tries)"),
        "{end}"
    );
}
