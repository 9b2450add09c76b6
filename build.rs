//! Asks which OpenCV is installed: 4.7 moved ArUco from the contrib module `aruco` to `objdetect`, where it is an object.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(opencv_aruco_in_objdetect)");
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "full")]
    ask_opencv();
}

#[cfg(feature = "full")]
fn ask_opencv() {
    let installed = pkg_config::Config::new()
        .cargo_metadata(false)
        .env_metadata(true)
        .probe("opencv4");
    // The opencv crate says what to install when there is none, so nothing is said here.
    let Ok(installed) = installed else { return };
    let mut numbers = installed.version.split('.').map(|n| n.parse::<u32>().unwrap_or(0));
    let (major, minor) = (numbers.next(), numbers.next());
    if major >= Some(5) {
        println!(
            "cargo::error=OpenCV 5 has other corner orders of tags than this program knows: build it with OpenCV 4"
        );
    }
    if (major, minor) >= (Some(4), Some(7)) {
        println!("cargo::rustc-cfg=opencv_aruco_in_objdetect");
    }
}
