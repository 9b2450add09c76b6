//! What gphoto2 says, and what a capture makes of previews and photos.

use scaleproof_capture::capture::tether::{Abilities, FoundCamera, TetherError, parse_abilities, parse_found};
use scaleproof_capture::capture::{Capture, Original, Purpose, Shutter, SourceFrame};

use super::stored;
use super::stored::skyline;

/// As gphoto2 2.5.28 wrote them, of its documentation and bug reports.
#[test]
fn cameras_and_abilities_are_read_as_gphoto2_writes_them() {
    let found = "Model                          Port            \n----------------------------------------------------------\n\
                 Canon EOS 90D                  usb:001,005     \nNikon DSC D750 (PTP mode)      usb:002,011     \n";
    let camera = |model: &str, port: &str| FoundCamera {
        model: model.into(),
        port: port.into(),
    };
    assert_eq!(
        parse_found(found),
        [
            camera("Canon EOS 90D", "usb:001,005"),
            camera("Nikon DSC D750 (PTP mode)", "usb:002,011")
        ]
    );
    assert!(parse_found("Model                          Port            \n-----\n").is_empty());
    let of_camera = "Abilities for camera             : Canon EOS 5D Mark III\nSerial port support              : no\n\
                     USB support                      : yes\nCapture choices                  :\n                                 : Image\n\
                     \u{20}                                : Preview\n                                 : Trigger Capture\n\
                     Configuration support            : yes\nDelete selected files on camera  : yes\n";
    let expected = Abilities {
        model: "Canon EOS 5D Mark III".into(),
        captures: true,
        previews: true,
    };
    assert_eq!(parse_abilities(of_camera), expected);
    // What the real program says where no camera is plugged in.
    let of_folder = "Abilities for camera             : Directory Browse\nSerial port support              : no\n\
                     Capture choices                  :\n                                 : Capture not supported by the driver\n";
    assert!(!parse_abilities(of_folder).captures);
}

#[test]
fn every_complaint_of_gphoto2_is_one_sentence_to_act_on() {
    let error = |text: &str| {
        format!("\n*** Error ***              \n{text}\nERROR: Could not capture image.\nERROR: Could not capture.\n")
    };
    let claim = "An error occurred in the io-library ('Could not claim the USB device'): Could not claim interface 0 (Device or resource busy). \
                 Make sure no other program (gvfs-gphoto2-volume-monitor) is using the device.";
    let meant = [
        (error(claim), TetherError::Busy),
        (error("PTP Store Full"), TetherError::CardFull),
        (
            "*** Error (-115: 'Not enough free space') ***".into(),
            TetherError::CardFull,
        ),
        (
            error("Canon EOS Full-Press failed: Perhaps no focus?"),
            TetherError::NoFocus,
        ),
        (error("PTP Device Busy"), TetherError::Working),
        ("*** Error (-110: 'I/O in progress') ***".into(), TetherError::Working),
        ("*** Error: No camera found. ***".into(), TetherError::NoCamera),
        (
            "*** Error (-52: 'Could not find the requested device on the USB port') ***".into(),
            TetherError::NoCamera,
        ),
        ("*** Error (-7: 'I/O problem') ***".into(), TetherError::Unplugged),
        (
            "*** Error (-10: 'Timeout reading from or writing to the port') ***".into(),
            TetherError::Unplugged,
        ),
        (
            error("PTP General Error"),
            TetherError::NoPhoto(": PTP General Error".into()),
        ),
        (String::new(), TetherError::NoPhoto(String::new())),
    ];
    for (said, meaning) in meant {
        assert_eq!(TetherError::understood(&said), meaning, "{said}");
    }
}

/// A photo of the stored session with its light changed, as a JPEG.
fn photo(number: u32, light: f32, size: [u32; 2]) -> Original {
    let image = image::open(skyline(&format!("normal_{number:03}.jpg"))).unwrap();
    let image = image
        .resize_exact(size[0], size[1], image::imageops::FilterType::Triangle)
        .into_rgb8();
    let mut dimmed = image;
    dimmed
        .iter_mut()
        .for_each(|value| *value = (f32::from(*value) * light) as u8);
    let mut bytes = std::io::Cursor::new(Vec::new());
    dimmed.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
    Original::Encoded(bytes.into_inner())
}

const PHOTO: [u32; 2] = [1280, 960];
const VIEW: [u32; 2] = [800, 600];

fn said(capture: &mut Capture, original: &Original, purpose: Purpose) -> String {
    let frame = SourceFrame {
        purpose,
        ..SourceFrame::untimed("frame".into(), original.clone())
    };
    let verdict = capture.see(&frame).unwrap().verdict;
    verdict.map_or_else(|advice| advice.code().to_owned(), |(photo, _)| photo)
}

/// The live view alone is dark: a camera that shows it as it is without flash. Only where the camera is and whether it holds still decide.
#[test]
fn a_preview_releases_the_shutter_and_only_the_photo_is_kept() {
    let session = tempfile::tempdir().unwrap();
    let mut capture = stored::capture(session.path());
    let shutter = Shutter::default();
    let view = photo(0, 0.3, VIEW);
    let preview = || Purpose::Preview(shutter.clone());
    let codes: Vec<String> = (0..5).map(|_| said(&mut capture, &view, preview())).collect();
    assert_eq!(codes, ["moving", "hold", "hold", "hold", "released"]);
    assert_eq!(capture.guidance().filled_of_all().0, 0);
    // The photo itself is too dark: nothing is taken, and no other is until the camera has been moved.
    let released = || Purpose::Released { is_by_hand: false };
    assert_eq!(said(&mut capture, &photo(0, 0.2, PHOTO), released()), "too_dark");
    let codes: Vec<String> = (0..4).map(|_| said(&mut capture, &view, preview())).collect();
    assert_eq!(codes, ["hold", "hold", "hold", "refused_here"]);
    said(&mut capture, &photo(2, 1.0, VIEW), preview());
    let codes: Vec<String> = (0..5).map(|_| said(&mut capture, &view, preview())).collect();
    assert_eq!(codes, ["moving", "hold", "hold", "hold", "released"]);
    let good = photo(0, 1.0, PHOTO);
    assert_eq!(said(&mut capture, &good, released()), "normal_000.jpg");
    assert_eq!(said(&mut capture, &view, preview()), "filled");
    let Original::Encoded(bytes) = good else { unreachable!() };
    assert!(std::fs::read(session.path().join("normal_000.jpg")).unwrap() == bytes);
}

#[test]
fn a_photo_by_hand_is_taken_whatever_its_light() {
    let session = tempfile::tempdir().unwrap();
    let mut capture = stored::capture(session.path());
    let shutter = Shutter::default();
    let frame = SourceFrame {
        purpose: Purpose::Preview(shutter),
        ..SourceFrame::untimed("view".into(), photo(0, 1.0, VIEW))
    };
    let advice = capture.shoot(&frame).unwrap().verdict.unwrap_err();
    assert_eq!(advice.code(), "released");
    let by_hand = Purpose::Released { is_by_hand: true };
    assert_eq!(said(&mut capture, &photo(0, 0.2, PHOTO), by_hand), "normal_000.jpg");
}
