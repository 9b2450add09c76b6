//! A camera that streams motion JPEG, served on loopback by a thread of the test.

use std::io::{BufRead, BufReader, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::time::Duration;

/// How many photos a session has.
pub fn taken(session: &Path) -> usize {
    let there = std::fs::read_dir(session).into_iter().flatten().flatten();
    there
        .filter(|entry| entry.file_name().to_string_lossy().ends_with(".capture.json"))
        .count()
}

/// A server at a free port of loopback. `answer` is given the number of each connection, the head of its request, and the connection.
pub fn serve(answer: impl Fn(usize, &str, &mut TcpStream) -> std::io::Result<()> + Send + Sync + 'static) -> u16 {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = listener.local_addr().unwrap().port();
    std::thread::spawn(move || {
        for (number, connection) in listener.incoming().enumerate() {
            let mut connection = connection.unwrap();
            let mut head = String::new();
            let mut reader = BufReader::new(connection.try_clone().unwrap());
            while !head.ends_with("\r\n\r\n") && reader.read_line(&mut head).is_ok_and(|count| count > 0) {}
            // A client that has left is no fault.
            let _ = answer(number, &head, &mut connection);
        }
    });
    port
}

/// The head of an answer that goes on with images.
pub const MULTIPART: &str = "HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n";

/// Sends one image, and waits as a camera of 25 images a second does.
pub fn part(connection: &mut TcpStream, jpeg: &[u8]) -> std::io::Result<()> {
    write!(
        connection,
        "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n",
        jpeg.len()
    )?;
    connection.write_all(jpeg)?;
    connection.write_all(b"\r\n")?;
    std::thread::sleep(Duration::from_millis(40));
    Ok(())
}
