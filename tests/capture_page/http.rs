//! A raw HTTP client, which can send what no library would.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

use serde_json::Value;

use crate::common::HANG;

/// A request as bytes; `{host}` in the head stands for the server's.
pub struct Request {
    pub head: String,
    pub body: Vec<u8>,
}

/// A POST as this page's own script sends it.
pub fn post(path: &str) -> Request {
    Request {
        head: format!("POST {path} HTTP/1.1\r\nHost: {{host}}\r\nOrigin: http://{{host}}\r\nContent-Length: 0\r\n"),
        body: Vec::new(),
    }
}

/// A photo as this page's own script sends it.
pub fn upload(kind: &str, body: &[u8]) -> Request {
    let length = body.len();
    Request {
        head: format!(
            "POST /upload HTTP/1.1\r\nHost: {{host}}\r\nOrigin: http://{{host}}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n"
        ),
        body: body.to_vec(),
    }
}

impl Request {
    /// An upload sent to another path.
    pub fn to(self, path: &str) -> Request {
        let head = self.head.replace("POST /upload", &format!("POST {path}"));
        Request { head, ..self }
    }
}

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    /// With names in lower case.
    pub headers: Vec<(String, String)>,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }

    pub fn header(&self, name: &str) -> &str {
        let found = self.headers.iter().find(|(known, _)| known == name);
        found.map_or("", |(_, value)| value)
    }
}

/// One connection at a time, kept while the server keeps it.
pub struct Client {
    host: String,
    /// The line of the head with what the page's code was exchanged for; none for a stranger.
    cookie: String,
    stream: Option<BufReader<TcpStream>>,
}

impl Client {
    pub fn new(host: &str) -> Client {
        Client {
            host: host.to_owned(),
            cookie: String::new(),
            stream: None,
        }
    }

    /// A browser that has a cookie: a line of a head, with its end.
    pub fn with_cookie(host: &str, cookie: &str) -> Client {
        let cookie = cookie.to_owned();
        Client {
            cookie,
            ..Client::new(host)
        }
    }

    pub fn get(&mut self, path: &str) -> Answer {
        self.send(&Request {
            head: format!("GET {path} HTTP/1.1\r\nHost: {{host}}\r\n"),
            body: Vec::new(),
        })
    }

    pub fn send(&mut self, request: &Request) -> Answer {
        self.try_to_send(request).expect("the server answers")
    }

    /// The answer; `None` when the connection ends without one. A kept connection that the server had closed is opened anew.
    pub fn try_to_send(&mut self, request: &Request) -> Option<Answer> {
        let kept = self.stream.take().and_then(|stream| self.try_send(stream, request));
        kept.or_else(|| self.try_send(connect(&self.host), request))
    }

    fn try_send(&mut self, mut stream: BufReader<TcpStream>, request: &Request) -> Option<Answer> {
        let head = request.head.replace("{host}", &self.host) + &self.cookie + "\r\n";
        // A server that refuses by the head alone does not read on; its answer is there all the same.
        let _ = stream.get_mut().write_all(&[head.as_bytes(), &request.body].concat());
        let answer = read(&mut stream)?;
        if answer.header("connection") != "close" {
            self.stream = Some(stream);
        }
        Some(answer)
    }
}

pub fn connect(host: &str) -> BufReader<TcpStream> {
    let stream = TcpStream::connect(host).unwrap();
    stream.set_read_timeout(Some(HANG)).unwrap();
    stream.set_nodelay(true).unwrap();
    BufReader::new(stream)
}

/// An answer with a known length.
pub fn read(stream: &mut BufReader<TcpStream>) -> Option<Answer> {
    let mut line = String::new();
    stream.read_line(&mut line).ok()?;
    let status = line.split(' ').nth(1)?.parse().ok()?;
    let mut headers = Vec::new();
    loop {
        line.clear();
        stream.read_line(&mut line).ok()?;
        match line.trim_end().split_once(':') {
            Some((name, value)) => headers.push((name.to_ascii_lowercase(), value.trim().to_owned())),
            None => break,
        }
    }
    let mut answer = Answer {
        status,
        headers,
        body: Vec::new(),
    };
    answer.body = vec![0; answer.header("content-length").parse().unwrap_or(0)];
    stream.read_exact(&mut answer.body).ok()?;
    Some(answer)
}
