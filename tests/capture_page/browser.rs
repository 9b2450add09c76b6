//! Headless Chromium, driven by its own protocol (DevTools over a WebSocket).

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{Value, json};
use tungstenite::protocol::Role;
use tungstenite::{Message, WebSocket};

use crate::capture_page::http::Client;
use crate::common::{HANG, with_chromium};

/// A browser with one tab; ended when dropped.
pub struct Browser {
    child: Child,
    socket: WebSocket<TcpStream>,
    _profile: tempfile::TempDir,
    commands: u64,
    /// What the page complained of.
    pub complaints: Vec<String>,
}

impl Browser {
    pub fn start() -> Browser {
        Browser::start_with(&[])
    }

    /// With more options of the command line.
    pub fn start_with(options: &[String]) -> Browser {
        let profile = tempfile::tempdir().unwrap();
        let child = spawn(profile.path(), options);
        let port = debugging_port(profile.path());
        let host = format!("127.0.0.1:{port}");
        let tabs = Client::new(&host).get("/json/list").json();
        let tab = tabs
            .as_array()
            .unwrap()
            .iter()
            .find(|tab| tab["type"] == "page")
            .unwrap();
        let stream = TcpStream::connect(&host).unwrap();
        stream.set_read_timeout(Some(HANG)).unwrap();
        let url = tab["webSocketDebuggerUrl"].as_str().unwrap();
        let socket = upgraded(stream, &host, url.split_once(&host).unwrap().1);
        let mut browser = Browser {
            child,
            socket,
            _profile: profile,
            commands: 0,
            complaints: Vec::new(),
        };
        for domain in ["Page", "Runtime", "Log", "DOM"] {
            browser.command(&format!("{domain}.enable"), json!({}));
        }
        browser
    }

    /// The result of a command; what the page logs meanwhile is kept.
    pub fn command(&mut self, method: &str, parameters: Value) -> Value {
        self.commands += 1;
        let id = self.commands;
        let text = json!({ "id": id, "method": method, "params": parameters }).to_string();
        self.socket.send(Message::text(text)).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else {
                continue;
            };
            let message: Value = serde_json::from_str(&text).unwrap();
            match message["method"].as_str() {
                Some("Runtime.exceptionThrown" | "Log.entryAdded") => {
                    self.complaints.push(message["params"].to_string())
                }
                _ if message["id"] == id => {
                    assert!(message["error"].is_null(), "{method}: {message}");
                    return message["result"].clone();
                }
                _ => {}
            }
        }
    }

    pub fn open(&mut self, address: &str) {
        self.command("Page.navigate", json!({ "url": address }));
    }

    pub fn resize(&mut self, width: u32, height: u32, is_phone: bool) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        self.command("Emulation.setDeviceMetricsOverride", size);
    }

    /// The value of an expression in the page.
    pub fn value(&mut self, script: &str) -> Value {
        let parameters = json!({ "expression": script, "returnByValue": true, "awaitPromise": true });
        self.command("Runtime.evaluate", parameters)["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait_for(&mut self, script: &str) {
        let end = Instant::now() + HANG;
        while self.value(script) != Value::Bool(true) {
            assert!(
                Instant::now() < end,
                "never true: {script}; the page says: {}",
                self.value("document.body.innerText")
            );
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Presses Enter on the element with the focus.
    pub fn press_enter(&mut self) {
        for kind in ["keyDown", "keyUp"] {
            let key =
                json!({ "type": kind, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13, "text": "\r" });
            self.command("Input.dispatchKeyEvent", key);
        }
    }

    /// Chooses a file as a person does in the dialogue.
    pub fn choose_file(&mut self, selector: &str, file: &Path) {
        let root = self.command("DOM.getDocument", json!({}))["root"]["nodeId"].clone();
        let input =
            self.command("DOM.querySelector", json!({ "nodeId": root, "selector": selector }))["nodeId"].clone();
        self.command("DOM.setFileInputFiles", json!({ "nodeId": input, "files": [file] }));
    }

    pub fn screenshot(&mut self, file: &Path) {
        let data = self.command("Page.captureScreenshot", json!({ "format": "png" }))["data"].clone();
        let bytes = base64::engine::general_purpose::STANDARD
            .decode(data.as_str().unwrap())
            .unwrap();
        std::fs::write(file, bytes).unwrap();
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn spawn(profile: &Path, options: &[String]) -> Child {
    with_chromium(profile, |command| {
        command
            .args(options)
            .args(["--remote-debugging-port=0", "about:blank"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
    })
}

/// The stream as a WebSocket (RFC 6455, 4.1), once the browser has agreed.
fn upgraded(mut stream: TcpStream, host: &str, path: &str) -> WebSocket<TcpStream> {
    let key = "c2NhbGVwcm9vZiBzY2FsZQ==";
    let request = format!(
        "GET {path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    while !answer.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).unwrap();
        answer.push(byte[0]);
    }
    let answer = String::from_utf8_lossy(&answer);
    assert!(answer.starts_with("HTTP/1.1 101"), "{answer}");
    WebSocket::from_raw_socket(stream, Role::Client, None)
}

/// Chromium writes the port it chose into its profile.
fn debugging_port(profile: &Path) -> u16 {
    let end = Instant::now() + HANG;
    loop {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        if let Some((port, _)) = text.split_once('\n') {
            return port.parse().unwrap();
        }
        assert!(Instant::now() < end, "Chromium did not start");
        std::thread::sleep(Duration::from_millis(50));
    }
}
