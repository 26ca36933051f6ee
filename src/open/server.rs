//! The server: loopback addresses, connections, the time at which it ends.

use super::calls::{answer, is_call};
use super::guard::Guard;
use super::http::{Head, Limits, Response, read_body, read_head, respond};
use super::session::Session;
use super::shell::shell;
use crate::host::fault::Fault;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A server that is bound and does not answer yet.
pub struct Server {
    listeners: Vec<TcpListener>,
    guard: Guard,
    limits: Limits,
}

/// Data that all connections use.
struct Shared {
    session: Session,
    guard: Guard,
    limits: Limits,
    connections: AtomicUsize,
    refusals: AtomicUsize,
    last_call: Mutex<Instant>,
}

impl Server {
    /// Binds 127.0.0.1, and ::1 if the system has it, at a port; 0 takes a free port.
    ///
    /// # Errors
    /// A port that is taken, a system without random numbers.
    pub fn bind(port: u16, limits: Limits) -> Result<Self, Fault> {
        let refused = |wrong: String| {
            let remedy = "choose another port with `--port`, or leave the option out";
            Fault::new("--port", "port", wrong, remedy)
        };
        let at = |ip: IpAddr, port| TcpListener::bind(SocketAddr::new(ip, port));
        let first = at(Ipv4Addr::LOCALHOST.into(), port)
            .map_err(|e| refused(format!("port {port} of 127.0.0.1 cannot be used ({e})")))?;
        let bound = first.local_addr().map_err(|e| refused(e.to_string()))?;
        let second = at(Ipv6Addr::LOCALHOST.into(), bound.port());
        Ok(Self {
            guard: Guard::new(bound.port()).map_err(refused)?,
            listeners: std::iter::once(first).chain(second.ok()).collect(),
            limits,
        })
    }

    /// Returns the address of the page with its token.
    pub fn address(&self) -> String {
        self.guard.address()
    }

    /// Returns an address that works once, for the arguments of a browser, which other users of the machine can read.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn address_for_browser(&self) -> Result<String, String> {
        self.guard.address_for_browser()
    }

    /// Answers until no page has called for the idle time of the limits.
    pub fn run(self, session: Session) {
        /// How often the idle time is tested.
        const TICK: Duration = Duration::from_millis(200);
        let shared = Arc::new(Shared {
            session,
            guard: self.guard,
            limits: self.limits,
            connections: AtomicUsize::new(0),
            refusals: AtomicUsize::new(0),
            last_call: Mutex::new(Instant::now()),
        });
        for listener in self.listeners {
            let shared = Arc::clone(&shared);
            std::thread::spawn(move || {
                for stream in listener.incoming() {
                    match stream {
                        Ok(stream) => accept(&shared, stream),
                        // The system has no more files for connections, for a moment.
                        Err(_) => std::thread::sleep(TICK),
                    }
                }
            });
        }
        while shared.last_call().elapsed() < self.limits.idle || shared.session.is_working() {
            std::thread::sleep(TICK);
        }
    }
}

impl Shared {
    fn last_call(&self) -> std::sync::MutexGuard<'_, Instant> {
        self.last_call
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}

/// Counts a connection or a refusal while it lasts.
struct Counted<'a>(&'a AtomicUsize);

impl<'a> Counted<'a> {
    /// Counts one more, unless there are `most` already.
    fn begin(count: &'a AtomicUsize, most: usize) -> Option<Self> {
        let before = count.fetch_add(1, Ordering::SeqCst);
        let counted = Self(count);
        (before < most).then_some(counted)
    }
}

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Answers a connection on a separate thread.
fn accept(shared: &Arc<Shared>, stream: TcpStream) {
    /// Refusals at a time; further connections are cut.
    const REFUSALS: usize = 32;
    let shared = Arc::clone(shared);
    let _ = std::thread::Builder::new().spawn(move || {
        let _ = stream.set_nodelay(true);
        let limits = shared.limits;
        if let Some(_counted) = Counted::begin(&shared.connections, limits.connections) {
            let mut stream = stream;
            let response = answer_request(&shared, &mut stream).unwrap_or_else(|refusal| refusal);
            respond(stream, &response, limits.body_time);
        } else if let Some(_counted) = Counted::begin(&shared.refusals, REFUSALS) {
            let busy = Response::refusal(503, "too many connections");
            respond(stream, &busy, limits.head_time);
        }
    });
}

fn answer_request(shared: &Shared, stream: &mut TcpStream) -> Result<Response, Response> {
    let mut head = read_head(stream, &shared.limits)?;
    shared.guard.check_host(&head)?;
    if head.target == "/" {
        return page(&head);
    }
    if head.target == "/enter" {
        let token = shared.guard.exchange_key(&head)?;
        return Ok(Response::json(200, &serde_json::json!({ "token": token })));
    }
    shared.guard.check_call(&head)?;
    *shared.last_call() = Instant::now();
    if !is_call(&head.target) {
        return Err(Response::refusal(404, "there is no such call"));
    }
    let body = match head.method.as_str() {
        "GET" => Vec::new(),
        "POST" => read_body(stream, &mut head, &shared.limits)?,
        _ => return Err(Response::refusal(405, "calls are GET or POST")),
    };
    let answered = answer(&shared.session, &head.method, &head.target, &body);
    *shared.last_call() = Instant::now();
    Ok(answered)
}

/// The page without any data of the job.
fn page(head: &Head) -> Result<Response, Response> {
    if head.method != "GET" {
        return Err(Response::refusal(405, "the page is read with GET"));
    }
    shell().map_err(|wrong| Response::refusal(500, &wrong))
}
