//! A page in the network, 200 hostile connections and one honest browser: all its answers come, and the program stays small.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::capture_page::http::{Answer, Client, Request, post, upload};
use crate::capture_page::running::{Running, capture};
use crate::common::{self, assert_refused, skyline};
use crate::hostile::bounded::highest_memory;

/// What the program may hold at any time.
const MOST_MEMORY_MB: f64 = 300.0;

// --- the honest browser --------------------------------------------------------------------------------------------------

/// From one honest request to the next.
const HONEST_TURN: Duration = Duration::from_millis(50);

/// From one photo of the phone to the next, so that there is always something new to see.
const PHOTO_TURN: Duration = Duration::from_secs(2);

/// What was asked for honestly.
#[derive(Default)]
struct Asked {
    ms: Vec<f64>,
    /// Request and answer.
    failed: Vec<String>,
    /// Previews of an image that was not the newest: honest, since another may come while one asks.
    outdated: usize,
}

impl Asked {
    /// The answer, if there is one and its status is among those that are right.
    fn answer(&mut self, client: &mut Client, request: &Request, right: &[u16]) -> Option<Answer> {
        let start = Instant::now();
        let answer = client.try_to_send(request);
        self.ms.push(start.elapsed().as_secs_f64() * 1e3);
        match answer {
            Some(answer) if right.contains(&answer.status) => Some(answer),
            other => {
                let what = request.head.lines().next().unwrap_or_default();
                let status = other.map_or("no answer".into(), |answer| answer.status.to_string());
                self.failed.push(format!("{what}: {status}"));
                None
            }
        }
    }

    /// The time that such a share of the answers took at most.
    fn ms_of(&self, share: f64) -> f64 {
        let mut sorted = self.ms.clone();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1) as f64;
        sorted.get((last * share).ceil() as usize).copied().unwrap_or(f64::NAN)
    }
}

fn with_cookie(mut request: Request, cookie: &str) -> Request {
    request.head += &format!("Cookie: {cookie}\r\n");
    request
}

fn get(path: &str, cookie: &str) -> Request {
    let request = Request {
        head: format!("GET {path} HTTP/1.1\r\nHost: {{host}}\r\n"),
        body: Vec::new(),
    };
    with_cookie(request, cookie)
}

/// What a page does that is looked at: the state, the newest preview, a file of its own. Every fifth request comes on a new connection.
fn browse(host: &str, cookie: &str, until: Instant) -> Asked {
    let (mut asked, mut kept, mut newest) = (Asked::default(), Client::new(host), 0);
    for turn in 0.. {
        let start = Instant::now();
        if start >= until {
            break;
        }
        let mut new = Client::new(host);
        let client = if turn % 5 == 4 { &mut new } else { &mut kept };
        match turn % 3 {
            // News of nothing seen is there at once; any other number might wait for some.
            0 => {
                let state = asked.answer(client, &get("/state/0", cookie), &[200]);
                newest = state
                    .and_then(|state| state.json()["frame"]["number"].as_u64())
                    .unwrap_or(newest);
            }
            1 => {
                let preview = asked.answer(client, &get(&format!("/preview/{newest}"), cookie), &[200, 410]);
                asked.outdated += usize::from(preview.is_some_and(|preview| preview.status == 410));
            }
            _ => drop(asked.answer(client, &get("/page.css", cookie), &[200])),
        }
        std::thread::sleep((start + HONEST_TURN).saturating_duration_since(Instant::now()));
    }
    asked
}

/// The photos of the stored session, over and over: the first of each view is taken, the others are refused with advice.
fn send_photos(host: &str, cookie: &str, until: Instant) -> Asked {
    let (mut asked, mut client) = (Asked::default(), Client::new(host));
    for number in (0..8).cycle() {
        let start = Instant::now();
        if start >= until {
            break;
        }
        let photo = std::fs::read(skyline().join(format!("normal_{number:03}.jpg"))).unwrap();
        asked.answer(
            &mut client,
            &with_cookie(upload("image/jpeg", &photo), cookie),
            &[200, 422],
        );
        let next = (start + PHOTO_TURN).min(until);
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    asked
}

// --- the others ----------------------------------------------------------------------------------------------------------

/// What a hostile connection does, until it is closed and comes again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hostile {
    /// Nothing.
    Idle,
    /// Ten thousand requests one after the other, and reads no answer.
    Unread,
    /// The beginning of a head, and then a byte a second.
    HalfHead,
    /// An upload that nobody allowed, a byte a second.
    SlowBody,
    /// Good requests by nobody known, each as soon as the last is answered.
    Stranger,
    /// Wrong codes.
    Guess,
    /// Goes at once.
    Leave,
}

/// 200 connections.
const HOSTILE: [(Hostile, usize); 7] = [
    (Hostile::Idle, 40),
    (Hostile::Unread, 30),
    (Hostile::HalfHead, 30),
    (Hostile::SlowBody, 30),
    (Hostile::Stranger, 30),
    (Hostile::Guess, 20),
    (Hostile::Leave, 20),
];

/// Each kind's thread looks at all its connections so often; nobody asks more often either.
const HOSTILE_TURN: Duration = Duration::from_millis(20);

/// How long one that was closed, or not let in, stays away.
const AWAY: Duration = Duration::from_millis(200);

/// Where all places are taken, a connection may wait to be accepted; it must not keep its thread from the others.
const LET_IN: Duration = Duration::from_millis(200);

/// How long answers stay unread before the same begins anew.
const UNREAD: Duration = Duration::from_secs(20);

const PIPELINED: usize = 10_000;

/// Bytes of them in a turn: more would only load the machine when the server has closed long since.
const AT_ONCE: usize = 64 << 10;

#[derive(Default)]
struct Tally {
    connections: AtomicUsize,
    requests: AtomicUsize,
}

struct Attacker {
    kind: Hostile,
    stream: Option<TcpStream>,
    opened: Instant,
    /// It does nothing more before.
    due: Instant,
    /// Bytes of its opening words.
    sent: usize,
    waits_for_answer: bool,
    random: Pcg64,
}

/// Runs so many connections of a kind.
fn attack(kind: Hostile, count: usize, host: &str, until: Instant, tally: &Tally) {
    let address: SocketAddr = host.parse().unwrap();
    let opening = opening(kind, host);
    let start = Instant::now();
    let mut attackers: Vec<Attacker> = (0..count)
        .map(|number| Attacker {
            kind,
            stream: None,
            opened: start,
            due: start,
            sent: 0,
            waits_for_answer: false,
            random: Pcg64::seed_from_u64(number as u64),
        })
        .collect();
    while Instant::now() < until {
        let turn = Instant::now();
        for attacker in &mut attackers {
            attacker.step(address, host, &opening, tally);
        }
        std::thread::sleep((turn + HOSTILE_TURN).saturating_duration_since(Instant::now()));
    }
}

/// The words that a connection begins with.
fn opening(kind: Hostile, host: &str) -> Vec<u8> {
    let text = match kind {
        Hostile::Idle | Hostile::Leave | Hostile::Guess => String::new(),
        Hostile::Unread => format!("GET /page.js HTTP/1.1\r\nHost: {host}\r\n\r\n").repeat(PIPELINED),
        Hostile::HalfHead => format!("GET /page.js HTTP/1.1\r\nHost: {host}\r\nX: "),
        Hostile::SlowBody => {
            let head = upload("image/jpeg", &[]).head.replace("{host}", host);
            head.replace("Content-Length: 0", "Content-Length: 1000000") + "\r\n"
        }
        Hostile::Stranger => format!("GET /state/0 HTTP/1.1\r\nHost: {host}\r\n\r\n"),
    };
    text.into_bytes()
}

impl Attacker {
    fn step(&mut self, address: SocketAddr, host: &str, opening: &[u8], tally: &Tally) {
        let now = Instant::now();
        if self.stream.is_none() {
            if now < self.due {
                return;
            }
            let Ok(stream) = TcpStream::connect_timeout(&address, LET_IN) else {
                self.due = now + AWAY;
                return;
            };
            stream.set_nonblocking(true).unwrap();
            tally.connections.fetch_add(1, Ordering::Relaxed);
            (self.stream, self.opened, self.due) = (Some(stream), now, now);
            (self.sent, self.waits_for_answer) = (0, false);
        }
        if self.act(host, opening, now, tally).is_none() {
            self.stream = None;
            let asks_on = matches!(self.kind, Hostile::Stranger | Hostile::Guess);
            self.due = if asks_on { now } else { now + AWAY };
        }
    }

    /// One thing more; `None` when the connection is over.
    fn act(&mut self, host: &str, opening: &[u8], now: Instant, tally: &Tally) -> Option<()> {
        let stream = self.stream.as_mut()?;
        match self.kind {
            Hostile::Leave => return None,
            Hostile::Idle => {
                heard(stream)?;
            }
            Hostile::Unread => {
                // A server that has closed is noticed by its reset, since nothing is read here.
                let is_reset = stream.take_error().ok()?.is_some();
                if is_reset || now > self.opened + UNREAD {
                    return None;
                }
                let rest = &opening[self.sent..];
                let taken = said(stream, &rest[..rest.len().min(AT_ONCE)])?;
                self.sent += taken;
                tally
                    .requests
                    .fetch_add(taken * PIPELINED / opening.len(), Ordering::Relaxed);
            }
            Hostile::HalfHead | Hostile::SlowBody => {
                heard(stream)?;
                if self.sent < opening.len() {
                    self.sent += said(stream, &opening[self.sent..])?;
                } else if now >= self.due {
                    said(stream, b"a")?;
                    self.due = now + Duration::from_secs(1);
                }
            }
            Hostile::Stranger | Hostile::Guess => {
                self.waits_for_answer &= heard(stream)? == 0;
                if !self.waits_for_answer {
                    if self.kind == Hostile::Stranger {
                        said(stream, opening)?;
                    } else {
                        let code = [self.random.next_u64(), self.random.next_u64()];
                        let head = format!(
                            "GET /join/{:016x}{:016x} HTTP/1.1\r\nHost: {host}\r\n\r\n",
                            code[0], code[1]
                        );
                        said(stream, head.as_bytes())?;
                    }
                    tally.requests.fetch_add(1, Ordering::Relaxed);
                    self.waits_for_answer = true;
                }
            }
        }
        Some(())
    }
}

/// How many bytes were there, thrown away; `None` once the server has closed.
fn heard(stream: &mut TcpStream) -> Option<usize> {
    let (mut buffer, mut heard) = ([0; 4096], 0);
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return None,
            Ok(count) => heard += count,
            Err(e) if e.kind() == ErrorKind::WouldBlock => return Some(heard),
            Err(_) => return None,
        }
    }
}

/// How many bytes the socket took; `None` once the server has closed.
fn said(stream: &mut TcpStream, bytes: &[u8]) -> Option<usize> {
    match stream.write(bytes) {
        Ok(count) => Some(count),
        Err(e) if e.kind() == ErrorKind::WouldBlock => Some(0),
        Err(_) => None,
    }
}

// --- the program ---------------------------------------------------------------------------------------------------------

const SOURCE: &str = "upload";
const LAN: [&str; 1] = ["--lan"];

/// What the browser's one-time code is exchanged for.
fn joined(running: &Running) -> String {
    let code = running.address.rsplit_once('/').unwrap().1;
    let joined = running.client().get(&format!("/join/{code}"));
    assert_eq!(joined.status, 303);
    joined.header("set-cookie").split(';').next().unwrap().to_owned()
}

/// The address of this machine in its network, if it is in one.
fn in_network() -> Option<IpAddr> {
    let socket = UdpSocket::bind("0.0.0.0:0").unwrap();
    socket.connect("192.0.2.1:9").ok()?;
    Some(socket.local_addr().unwrap().ip()).filter(|ip| !ip.is_loopback())
}

/// `SCALEPROOF_SOAK_SECONDS` says how long (5). How quickly is printed, for the measured figures.
#[test]
fn an_honest_browser_is_answered_beside_two_hundred_hostile_connections() {
    let seconds = common::number("SCALEPROOF_SOAK_SECONDS").unwrap_or(5);
    if in_network().is_none() {
        let never_made = std::env::temp_dir().join("never made");
        assert_refused(
            &capture(SOURCE, &never_made, &LAN).output().unwrap(),
            &["in no network"],
        );
        return;
    }
    let mut running = Running::start(SOURCE, &LAN);
    let (host, cookie) = (running.host(), joined(&running));
    let tally = Tally::default();
    let until = Instant::now() + Duration::from_secs(seconds);
    let (browsed, photos) = std::thread::scope(|scope| {
        let (host, cookie, tally) = (&host, &cookie, &tally);
        for (kind, count) in HOSTILE {
            scope.spawn(move || attack(kind, count, host, until, tally));
        }
        let photos = scope.spawn(move || send_photos(host, cookie, until));
        (browse(host, cookie, until), photos.join().unwrap())
    });
    // 0 where the system does not say.
    let memory_mb = Some(highest_memory(running.child.id()) as f64 / 1e6).filter(|mb| *mb > 0.0);
    let [connections, requests] = [&tally.connections, &tally.requests].map(|count| count.load(Ordering::Relaxed));
    let [median, most, nearly_all, worst] = [0.5, 0.95, 0.99, 1.0].map(|share| browsed.ms_of(share));
    println!(
        "{seconds} s: {} honest requests, median {median:.1} ms, 95 % {most:.1}, 99 % {nearly_all:.1}, worst {worst:.1}; {} failed, {} \
         previews outdated",
        browsed.ms.len(),
        browsed.failed.len(),
        browsed.outdated
    );
    println!(
        "{} photos sent, median {:.0} ms, worst {:.0}; {} failed",
        photos.ms.len(),
        photos.ms_of(0.5),
        photos.ms_of(1.0),
        photos.failed.len()
    );
    println!("{connections} hostile connections, {requests} hostile requests");
    match memory_mb {
        Some(mb) => println!("at most {mb:.0} MB in memory"),
        None => println!("memory is not known on this system"),
    }

    assert!(connections >= 200, "only {connections} hostile connections");
    assert!(
        browsed.failed.is_empty() && photos.failed.is_empty(),
        "{:?}, {:?}",
        browsed.failed,
        photos.failed
    );
    assert!(memory_mb.is_none_or(|mb| mb < MOST_MEMORY_MB), "{memory_mb:?} MB");

    // It ends as a capture does: with 0 when all views were there.
    let finished = Client::new(&host).send(&with_cookie(post("/finish"), &cookie));
    assert_eq!(finished.status, 202);
    let (code, _) = running.ended();
    assert!(matches!(code, Some(0 | 2)), "{code:?}");
}
