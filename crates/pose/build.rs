//! Asks what the C libraries below are: the version of AprilTag is part of every result's provenance, and OpenCV 4.7 moved ArUco from the
//! contrib module `aruco` to `objdetect`, where it is an object.

#[path = "build/apriltag.rs"]
mod apriltag;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(opencv_aruco_in_objdetect)");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build/apriltag.rs");
    name_apriltag();
    #[cfg(feature = "full")]
    ask_opencv();
}

fn name_apriltag() {
    let [method, source] = ["APRILTAG_SYS_METHOD", "APRILTAG_SRC"].map(|name| {
        println!("cargo::rerun-if-env-changed={name}");
        std::env::var(name).ok()
    });
    let system = installed("apriltag");
    let linked = apriltag::linked(method.as_deref(), source.as_deref(), system.as_deref());
    println!("cargo::rustc-env=APRILTAG_VERSION={}", linked.version);
    println!("cargo::rustc-env=APRILTAG_ORIGIN={}", linked.origin);
}

/// The version of a library that `pkg-config` finds.
fn installed(library: &str) -> Option<String> {
    let mut config = pkg_config::Config::new();
    let found = config.cargo_metadata(false).env_metadata(true).probe(library);
    found.ok().map(|library| library.version)
}

#[cfg(feature = "full")]
fn ask_opencv() {
    // The opencv crate says what to install when there is none, so nothing is said here.
    let Some(version) = installed("opencv4") else { return };
    let mut numbers = version.split('.').map(|n| n.parse::<u32>().unwrap_or(0));
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
