//! How the module is linked.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    match std::env::var("CARGO_CFG_TARGET_OS").as_deref() {
        // The libraries that a wheel carries lie beside the module; they look for theirs there, too (an RPATH, not a RUNPATH).
        Ok("linux") => println!("cargo:rustc-cdylib-link-arg=-Wl,--disable-new-dtags,-rpath,$ORIGIN/libs"),
        // Python's functions are found when the module is loaded.
        Ok("macos") => println!("cargo:rustc-cdylib-link-arg=-Wl,-undefined,dynamic_lookup"),
        _ => {}
    }
}
