/// Photos in large pages.
#[global_allocator]
static ALLOCATOR: scaleproof_core::workers::memory::LargePages = scaleproof_core::workers::memory::LargePages;

fn main() -> std::process::ExitCode {
    let arguments: Vec<_> = std::env::args_os().collect();
    scaleproof::main(&arguments).into()
}
