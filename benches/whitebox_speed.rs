//! `cargo bench --bench whitebox_speed -- [--against PROGRAM…] MANIFEST…`: milliseconds an image through the detectors of an attack, beside ONNX Runtime.
//!
//! ONNX Runtime's forward pass on one thread, ours, and ours with the backward pass, on one thread and on two; the median of some rounds in which they
//! take turns, and ratios to ONNX Runtime. MANIFEST is a detector's TOML file with its weights beside it. Each PROGRAM is another build of this file
//! (below `target/release/deps`), which takes turns with this one, round by round; their times are divided by this one's.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use ort::environment::Environment;
use ort::session::Session;
use scaleproof::{BoxPx, Boxes, Manifest, OnnxDetector, WhiteBox};

const ROUNDS: usize = 15;
/// Images a thread looks at while two are at work.
const TOGETHER: usize = 4;
/// The option by which this program becomes one of those that take turns.
const ON_DEMAND: &str = "--on-demand";

/// Milliseconds of ONNX Runtime, forward, forward and back, and an image on two threads.
type Round = [f64; 4];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut manifests, mut programs) = (Vec::new(), vec![std::env::current_exe().expect("this program")]);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            ON_DEMAND => return answer(Path::new(&arguments.next().expect("a manifest"))),
            "--against" => programs.push(arguments.next().expect("a program").into()),
            _ => manifests.push(argument),
        }
    }
    if manifests.is_empty() {
        println!("usage: cargo bench --bench whitebox_speed -- [--against PROGRAM…] MANIFEST…");
        return;
    }
    println!(
        "{:<26} {:>8} {:>9} {:>16} {:>8} {:>10}",
        "detector", "ort ms", "forward", "forward + back", "of ort", "2 threads"
    );
    for manifest in &manifests {
        compare(manifest, &programs);
    }
}

fn compare(manifest: &str, programs: &[PathBuf]) {
    let mut running: Vec<Program> = programs
        .iter()
        .map(|program| Program::start(program, manifest))
        .collect();
    let mut rounds = vec![Vec::new(); programs.len()];
    for round in 0..ROUNDS {
        for i in 0..programs.len() {
            let i = (i + round) % programs.len();
            rounds[i].extend(running[i].round());
        }
    }
    let name = Path::new(manifest).file_stem().unwrap_or_default().to_string_lossy();
    let all: Vec<Option<Round>> = rounds.iter().map(|rounds| medians(rounds)).collect();
    for (i, medians) in all.iter().enumerate() {
        let Some([ort, forward, both, two]) = *medians else {
            println!("{name:<26} is not followed by {}", programs[i].display());
            continue;
        };
        let (of_ort, faster) = (both / ort, both / two);
        print!("{name:<26} {ort:>8.1} {forward:>9.1} {both:>16.1} {of_ort:>7.2}× {faster:>9.2}×");
        if let (1.., Some([_, our_forward, our_both, our_two])) = (i, all[0]) {
            let ratios = [our_forward / forward, our_both / both, our_two / two].map(|ratio| format!("{ratio:.3}"));
            print!("  this by that: {}", ratios.join(" "));
        }
        println!();
    }
}

fn medians(rounds: &[Round]) -> Option<Round> {
    (!rounds.is_empty()).then(|| std::array::from_fn(|i| median(rounds.iter().map(|round| round[i]).collect())))
}

/// A build of this file that measures one round when it is asked to.
struct Program {
    child: Child,
    asked: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Program {
    fn start(program: &Path, manifest: &str) -> Program {
        let mut command = Command::new(program);
        let command = command
            .args([ON_DEMAND, manifest])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command.spawn().unwrap_or_else(|e| panic!("{}: {e}", program.display()));
        Program {
            asked: child.stdin.take(),
            answers: BufReader::new(child.stdout.take().expect("its output")),
            child,
        }
    }

    /// None of a build that cannot follow the network.
    fn round(&mut self) -> Option<Round> {
        writeln!(self.asked.as_ref()?).ok()?;
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        let ms: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        ms.ok()?.try_into().ok()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.asked = None; // ends it
        let _ = self.child.wait();
    }
}

/// Measures a round for each line of standard input.
fn answer(path: &Path) {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let manifest = Manifest::parse(&text, &path.display().to_string()).expect("a manifest");
    let weights = path.with_file_name(&manifest.weights.file);
    let car = manifest.labels.find("car").expect("a label \"car\"");
    let detector = OnnxDetector::<f32>::open(&manifest, &weights, &[car]).expect("a detector");
    let (picture, size) = picture();
    let best = detector.predictions(&picture, size).expect("predictions");
    let best = best.iter().max_by(|a, b| a.confidence.total_cmp(&b.confidence));
    let outline: BoxPx = best.expect("a prediction").box_px;
    let library = std::env::var("ORT_DYLIB_PATH").expect("ORT_DYLIB_PATH, as ./run sets it");
    let environment = ort::init_from(library)
        .expect("ONNX Runtime")
        .build()
        .expect("ONNX Runtime");
    environment.set_log_level(ort::logging::LogLevel::Error);
    let mut session = session(&environment, &weights);
    let look = || {
        let loss = detector.loss_and_gradient(&picture, size, &outline, Boxes::Strongest);
        loss.expect("a gradient").expect("a car")
    };
    for _ in std::io::stdin().lines() {
        let together = || {
            std::thread::scope(|scope| {
                (0..2).for_each(|_| drop(scope.spawn(|| (0..TOGETHER).for_each(|_| drop(look())))));
            });
        };
        let round: Round = [
            time(|| forward(&mut session, manifest.input.size_px)),
            time(|| drop(detector.predictions(&picture, size))),
            time(|| drop(look())),
            time(together) / (2 * TOGETHER) as f64,
        ];
        println!("{}", round.map(|ms| ms.to_string()).join(" "));
    }
}

fn time(work: impl FnOnce()) -> f64 {
    let started = Instant::now();
    work();
    started.elapsed().as_secs_f64() * 1e3
}

fn median(mut ms: Vec<f64>) -> f64 {
    ms.sort_by(f64::total_cmp);
    ms[ms.len() / 2]
}

/// A stored photo, as large as the frames of an attack.
fn picture() -> (Vec<[f64; 3]>, [u32; 2]) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("captures/skyline");
    let files = std::fs::read_dir(folder)
        .expect("the stored session")
        .map(|file| file.expect("a file").path());
    let photo = files
        .filter(|f| f.extension().is_some_and(|e| e == "jpg"))
        .min()
        .expect("a photo");
    let photo = image::open(photo).expect("a photo").to_rgb8();
    let small = image::imageops::thumbnail(&photo, 256, 192);
    let pixels = small.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
    (pixels, [small.width(), small.height()])
}

fn session(environment: &Environment, weights: &Path) -> Session {
    let builder = Session::builder(environment).expect("ONNX Runtime");
    let mut builder = builder.with_intra_threads(1).expect("one thread");
    builder.commit_from_file(weights).expect("a session")
}

fn forward(session: &mut Session, [width, height]: [u32; 2]) {
    let numbers = vec![0.5_f32; 3 * (width * height) as usize];
    let shape = vec![1, 3, height as usize, width as usize];
    let image = ort::value::Tensor::from_array((shape, numbers)).expect("a tensor");
    let mut inputs = Vec::from(ort::inputs![image]);
    if session.inputs().len() == 2 {
        let size = vec![i64::from(width), i64::from(height)];
        inputs.extend(ort::inputs![
            ort::value::Tensor::from_array((vec![1, 2], size)).expect("a size")
        ]);
    }
    session.run(&inputs[..]).expect("ONNX Runtime's outputs");
}
