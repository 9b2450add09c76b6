//! Choice of the C AprilTag library that `apriltag-sys` links: the one it carries, or the system's. Its build script decides by the environment and
//! `pkg-config`, without output; this repeats the decision.

/// Library that `apriltag-sys` carries. `Cargo.toml` requires exactly this release of it.
pub const CARRIED: Linked<'static> = Linked {
    version: "3.2",
    origin: "apriltag-sys 0.3",
};

/// Version and origin of a library, for the provenance of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Linked<'a> {
    pub version: &'a str,
    pub origin: &'a str,
}

/// Returns the library that is linked; `method` and `source` are `APRILTAG_SYS_METHOD` and `APRILTAG_SRC`; `system` is the version that `pkg-config` finds.
pub fn linked<'a>(method: Option<&str>, source: Option<&str>, system: Option<&'a str>) -> Linked<'a> {
    let asks_pkg_config = matches!(method, None | Some("pkg-config" | "pkg-config-then-static"));
    match (system.filter(|_| asks_pkg_config), source) {
        (Some(version), _) => Linked {
            version,
            origin: "the system's",
        },
        (None, Some(_)) => Linked {
            version: "unknown",
            origin: "from APRILTAG_SRC",
        },
        (None, None) => CARRIED,
    }
}
