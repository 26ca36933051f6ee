//! The part of HTTP/1.1 that a page on this machine needs: one request a connection, read within limits, and its response.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// Limits of the server. All of them protect a program that runs for hours next to untrusted pages in the same browser.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Bytes of request line and headers. Browsers send less than 2 kB.
    pub head: usize,
    /// Bytes of a body. The lists of a model with a million elements need about 4 MB.
    pub body: usize,
    /// Connections at a time. A browser opens six for each page.
    pub connections: usize,
    /// Time for request line and headers: they arrive at once from the same machine, and within a second through a tunnel.
    pub head_time: Duration,
    /// Time for a body, and for taking a response: the largest body through a slow tunnel.
    pub body_time: Duration,
    /// Time without a request of a page until the server ends.
    pub idle: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            head: 16 << 10,
            body: 8 << 20,
            connections: 16,
            head_time: Duration::from_secs(5),
            body_time: Duration::from_secs(30),
            idle: Duration::from_secs(600),
        }
    }
}

/// Request line and headers.
#[derive(Debug)]
pub struct Head {
    /// Method, such as `GET`.
    pub method: String,
    /// Target, such as `/place`.
    pub target: String,
    headers: Vec<(String, String)>,
    /// Bytes of the body that arrived with the headers.
    rest: Vec<u8>,
}

impl Head {
    /// Returns the value of a header, its name in lower case; `None` if it is missing or stated twice.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|h| h.0 == name);
        let first = found.next()?;
        found.next().is_none().then_some(first.1.as_str())
    }

    /// Returns whether a header is stated, once or several times.
    pub fn has(&self, name: &str) -> bool {
        self.headers.iter().any(|h| h.0 == name)
    }
}

/// Response: status, further headers, body.
#[derive(Debug)]
pub struct Response {
    /// Status code.
    pub status: u16,
    /// Type of the body.
    pub kind: &'static str,
    /// Policy for the content of a page; empty for data.
    pub policy: String,
    /// Body.
    pub body: Vec<u8>,
}

impl Response {
    /// A response of JSON text.
    pub fn json(status: u16, value: &serde_json::Value) -> Self {
        Self {
            status,
            kind: "application/json",
            policy: String::new(),
            body: value.to_string().into_bytes(),
        }
    }

    /// A refusal with the reason as JSON text.
    pub fn refusal(status: u16, reason: &str) -> Self {
        Self::json(status, &serde_json::json!({ "refused": reason }))
    }
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        401 => "Unauthorized",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        409 => "Conflict",
        411 => "Length Required",
        413 => "Content Too Large",
        415 => "Unsupported Media Type",
        422 => "Unprocessable Content",
        431 => "Request Header Fields Too Large",
        503 => "Service Unavailable",
        _ => "Internal Server Error",
    }
}

/// Reads more bytes before the deadline; 0 at the end.
fn read_some(
    stream: &mut TcpStream,
    into: &mut [u8],
    deadline: Instant,
) -> Result<usize, Response> {
    let late = || Response::refusal(408, "the request did not arrive in time");
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(late());
    }
    match stream.read(into) {
        Ok(n) => Ok(n),
        Err(e) if e.kind() == ErrorKind::Interrupted => read_some(stream, into, deadline),
        Err(_) => Err(late()),
    }
}

/// Reads request line and headers.
///
/// # Errors
/// The response to a request that is malformed, too large or too slow.
pub fn read_head(stream: &mut TcpStream, limits: &Limits) -> Result<Head, Response> {
    let deadline = Instant::now() + limits.head_time;
    let (mut bytes, mut part) = (Vec::new(), [0; 4096]);
    loop {
        let n = read_some(stream, &mut part, deadline)?;
        if n == 0 {
            return Err(Response::refusal(
                400,
                "the request ends within its headers",
            ));
        }
        let from = bytes.len().saturating_sub(3);
        bytes.extend_from_slice(part.get(..n).unwrap_or_default());
        let found = bytes
            .get(from..)
            .and_then(|b| b.windows(4).position(|w| w == b"\r\n\r\n"));
        let end = found.map(|at| from + at);
        if end.unwrap_or(bytes.len()) > limits.head {
            return Err(Response::refusal(431, "the headers are too large"));
        }
        if let Some(end) = end {
            let rest = bytes.split_off(end + 4);
            return parse_head(&bytes, rest)
                .ok_or_else(|| Response::refusal(400, "the headers are malformed"));
        }
    }
}

fn parse_head(bytes: &[u8], rest: Vec<u8>) -> Option<Head> {
    let text = std::str::from_utf8(bytes).ok()?;
    let mut lines = text.trim_end_matches("\r\n").split("\r\n");
    let mut first = lines.next()?.split(' ');
    let (method, target, version) = (first.next()?, first.next()?, first.next()?);
    if first.next().is_some() || !matches!(version, "HTTP/1.1" | "HTTP/1.0") {
        return None;
    }
    let headers = lines.map(|line| {
        let (name, value) = line.split_once(':')?;
        let is_name = !name.is_empty() && name.bytes().all(|b| b.is_ascii_graphic());
        is_name.then(|| (name.to_ascii_lowercase(), value.trim().to_owned()))
    });
    Some(Head {
        method: method.to_owned(),
        target: target.to_owned(),
        headers: headers.collect::<Option<_>>()?,
        rest,
    })
}

/// Reads the body that the headers announce.
///
/// # Errors
/// The response to a body without a length, too large or too slow.
pub fn read_body(
    stream: &mut TcpStream,
    head: &mut Head,
    limits: &Limits,
) -> Result<Vec<u8>, Response> {
    let length = head.header("content-length");
    let digits = length.filter(|l| !l.is_empty() && l.bytes().all(|b| b.is_ascii_digit()));
    let length = match digits {
        Some(digits) if !head.has("transfer-encoding") => digits.parse().unwrap_or(usize::MAX),
        _ => {
            return Err(Response::refusal(
                411,
                "the length of the body is not stated",
            ));
        }
    };
    if length > limits.body {
        return Err(Response::refusal(413, "the body is too large"));
    }
    let deadline = Instant::now() + limits.body_time;
    let (mut body, mut part) = (std::mem::take(&mut head.rest), [0; 1 << 16]);
    while body.len() < length {
        match read_some(stream, &mut part, deadline)? {
            0 => return Err(Response::refusal(400, "the body is shorter than stated")),
            n => body.extend_from_slice(part.get(..n).unwrap_or_default()),
        }
    }
    body.truncate(length);
    Ok(body)
}

/// Writes all bytes before the deadline; `false` if that fails. A limit for each write alone would let a client take a byte at a time for hours.
fn write_until(stream: &mut TcpStream, mut bytes: &[u8], deadline: Instant) -> bool {
    while !bytes.is_empty() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() || stream.set_write_timeout(Some(left)).is_err() {
            return false;
        }
        match stream.write(bytes) {
            Ok(n) if n > 0 => bytes = bytes.get(n..).unwrap_or_default(),
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            _ => return false,
        }
    }
    true
}

/// Writes a response and closes the connection. A client that takes no bytes is cut.
pub fn respond(mut stream: TcpStream, response: &Response, time: Duration) {
    /// Bytes that a refused client may still send before the connection is cut. Without reading them, the client would not see the response.
    const MOST_UNREAD: usize = 32 << 20;
    let mut head = format!(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n",
        response.status,
        reason(response.status),
        response.kind,
        response.body.len()
    );
    let policy = match response.policy.as_str() {
        "" => "default-src 'none'; frame-ancestors 'none'",
        own => own,
    };
    head.push_str(&format!("Content-Security-Policy: {policy}\r\n\r\n"));
    let end = Instant::now() + time;
    if !write_until(&mut stream, head.as_bytes(), end)
        || !write_until(&mut stream, &response.body, end)
    {
        return;
    }
    let _ = stream.shutdown(Shutdown::Write);
    let deadline = Instant::now() + Duration::from_secs(2).min(time);
    let (mut part, mut unread) = (vec![0; 1 << 16], 0);
    while unread < MOST_UNREAD {
        match read_some(&mut stream, &mut part, deadline) {
            Ok(n) if n > 0 => unread += n,
            _ => break,
        }
    }
}
