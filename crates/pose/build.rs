//! Determines the versions of the C libraries: the version of AprilTag is part of every result's provenance, and OpenCV 4.7 moved ArUco from the
//! contrib module `aruco` to `objdetect`, where it is an object.

#[path = "build/apriltag.rs"]
mod apriltag;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(opencv_aruco_in_objdetect)");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build/apriltag.rs");
    let [method, source] = ["APRILTAG_SYS_METHOD", "APRILTAG_SRC"].map(|name| {
        println!("cargo::rerun-if-env-changed={name}");
        std::env::var(name).ok()
    });
    let system = installed("apriltag");
    let linked = apriltag::linked(method.as_deref(), source.as_deref(), system.as_deref());
    println!("cargo::rustc-env=APRILTAG_VERSION={}", linked.version);
    println!("cargo::rustc-env=APRILTAG_ORIGIN={}", linked.origin);
    if std::env::var_os("CARGO_FEATURE_FULL").is_some() {
        ask_opencv();
    }
}

/// Returns the version of a library that `pkg-config` finds.
fn installed(library: &str) -> Option<String> {
    let mut config = pkg_config::Config::new();
    let found = config.cargo_metadata(false).env_metadata(true).probe(library);
    found.ok().map(|library| library.version)
}

fn ask_opencv() {
    // The opencv crate says what to install when there is none, so nothing is said here.
    let Some(version) = installed("opencv4") else { return };
    let mut numbers = version.split('.').map(|n| n.parse::<u32>().unwrap_or(0));
    let version = (numbers.next(), numbers.next());
    if version >= (Some(5), None) {
        println!(
            "cargo::error=OpenCV 5 has other corner orders of tags than this program knows: build it with OpenCV 4"
        );
    }
    if version >= (Some(4), Some(7)) {
        println!("cargo::rustc-cfg=opencv_aruco_in_objdetect");
    }
}
