//! A capture with a page, in a process of its own.
#![allow(dead_code)] // each test file uses its part

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread::JoinHandle;

use serde_json::Value;

use crate::capture_page::http::Client;
use crate::common::{program, skyline};

/// A capture with a page; killed when dropped.
pub struct Running {
    pub child: Child,
    /// Reads what it says, so that it never waits for somebody to listen.
    listener: Option<JoinHandle<Vec<Value>>>,
    /// The page's address, without the slash at its end.
    pub address: String,
    pub folder: tempfile::TempDir,
    is_lan: bool,
    cookie: OnceLock<String>,
}

impl Running {
    pub fn start(source: &str, more: &[&str]) -> Running {
        let folder = tempfile::tempdir().unwrap();
        let command = capture(source, &folder.path().join("session"), more);
        Running::of(command, folder)
    }

    /// A capture with `--page --json` that somebody else put together.
    pub fn of(mut command: Command, folder: tempfile::TempDir) -> Running {
        let is_lan = command.get_args().any(|argument| argument == "--lan");
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        out.read_line(&mut line).unwrap();
        if line.is_empty() {
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            panic!("no page: {said}");
        }
        let page: Value = serde_json::from_str(&line).unwrap();
        let address = page["page"].as_str().unwrap().trim_end_matches('/').to_owned();
        let lines = out.lines().map_while(Result::ok);
        let listen = move || lines.map(|line| serde_json::from_str(&line).unwrap()).collect();
        Running {
            child,
            listener: Some(std::thread::spawn(listen)),
            address,
            folder,
            is_lan,
            cookie: OnceLock::new(),
        }
    }

    pub fn host(&self) -> String {
        self.address["http://".len()..].split('/').next().unwrap().to_owned()
    }

    /// A client that is known to a page of this machine; a stranger to one of the network.
    pub fn client(&self) -> Client {
        Client::with_cookie(&self.host(), self.cookie())
    }

    /// The line of a head with what this machine's code was exchanged for at the first call.
    pub fn cookie(&self) -> &str {
        self.cookie.get_or_init(|| {
            if self.is_lan {
                return String::new();
            }
            let (_, join) = self.address.rsplit_once("/join/").unwrap();
            let joined = Client::new(&self.host()).get(&format!("/join/{join}"));
            let pair = joined.header("set-cookie").split(';').next().unwrap();
            format!("Cookie: {pair}\r\n")
        })
    }

    pub fn session(&self) -> PathBuf {
        self.folder.path().join("session")
    }

    /// Exit code and the lines of its JSON, once it has ended by itself.
    pub fn ended(&mut self) -> (Option<i32>, Vec<Value>) {
        let lines = self.listener.take().unwrap().join().unwrap();
        (self.child.wait().unwrap().code(), lines)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn capture(source: &str, session: &Path, more: &[&str]) -> Command {
    let mut command = program();
    command.args(["capture", "--source", source, "--page", "--port", "0", "--json"]);
    command.args(["--variant", "normal", "--place", "yard"]);
    command.arg("--scene").arg(skyline().join("scene.toml"));
    command.arg("--camera").arg(skyline().join("camera.yaml"));
    command.arg("-o").arg(session).args(more);
    command
}
