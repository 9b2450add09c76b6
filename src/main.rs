fn main() -> std::process::ExitCode {
    let arguments: Vec<_> = std::env::args_os().collect();
    scaleproof::main(&arguments).into()
}
