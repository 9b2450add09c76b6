fn main() -> std::process::ExitCode {
    scaleproof::main()
}
