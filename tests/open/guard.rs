//! Who is refused, and with which status.

use super::{Server, frame_job, status};
use std::io::{Read, Write};
use std::time::{Duration, Instant};
use strainbridge::open::{Limits, Server as OwnServer, Session, Surroundings};

const LISTS: &str = "properties = [1, 2]\nangle_step_deg = 45\n";

/// Every row: what is wrong with the request, the request, its status.
#[test]
fn requests_that_a_page_of_this_server_would_not_send_are_refused() {
    let server = Server::start(&frame_job("open_guard", LISTS));
    let (port, token) = (server.port, server.token.clone());
    let (get, post) = (server.headers(), server.post_headers());
    let host = format!("Host: 127.0.0.1:{port}\r\n");
    let key = format!("X-Strainbridge-Token: {token}\r\n");
    let ours = format!("Origin: http://127.0.0.1:{port}\r\n");
    let json = "Content-Type: application/json\r\n";
    let place = |headers: &str, length: usize, body: &str| {
        format!("POST /place HTTP/1.1\r\n{headers}Content-Length: {length}\r\n\r\n{body}")
    };
    let of = |method: &str, target: &str, headers: &str| {
        format!("{method} {target} HTTP/1.1\r\n{headers}\r\n")
    };
    let nine = "x".repeat(9 << 20);
    let long = format!("{get}X-Long: {}\r\n", "x".repeat(17 << 10));
    let wrong = format!("{host}X-Strainbridge-Token: {}\r\n", "0".repeat(32));
    let shorter = format!("{host}X-Strainbridge-Token: {}\r\n", &token[..31]);
    let other = |name: &str| format!("Host: {name}\r\n{key}");
    let rows = [
        ("a page of ours", of("GET", "/", &host), 200),
        (
            "localhost",
            of("GET", "/job", &other(&format!("localhost:{port}"))),
            200,
        ),
        (
            "::1",
            of("GET", "/job", &other(&format!("[::1]:{port}"))),
            200,
        ),
        (
            "another name",
            of("GET", "/", &other(&format!("rebound.example:{port}"))),
            403,
        ),
        (
            "another name for a call",
            of("GET", "/job", &other(&format!("rebound.example:{port}"))),
            403,
        ),
        ("another port", of("GET", "/", &other("127.0.0.1:1")), 403),
        ("no port", of("GET", "/", &other("127.0.0.1")), 403),
        ("no host", of("GET", "/job", &key), 403),
        ("two hosts", of("GET", "/job", &format!("{host}{get}")), 403),
        ("no token", of("GET", "/job", &host), 401),
        ("a wrong token", of("GET", "/job", &wrong), 401),
        ("a part of the token", of("GET", "/job", &shorter), 401),
        ("two tokens", of("GET", "/job", &format!("{get}{key}")), 401),
        (
            "the token in the target",
            of("GET", &format!("/job?{token}"), &host),
            401,
        ),
        (
            "a foreign origin",
            place(
                &format!("{get}{json}Origin: http://evil.example\r\n"),
                2,
                "{}",
            ),
            403,
        ),
        (
            "an origin without a name",
            place(&format!("{get}{json}Origin: null\r\n"), 2, "{}"),
            403,
        ),
        (
            "our origin by another name",
            place(
                &format!("{get}{json}Origin: http://localhost:{port}\r\n"),
                2,
                "{}",
            ),
            403,
        ),
        ("no origin", place(&format!("{get}{json}"), 2, "{}"), 403),
        (
            "a foreign origin that reads",
            of(
                "GET",
                "/job",
                &format!("{get}Origin: http://evil.example\r\n"),
            ),
            403,
        ),
        (
            "a form",
            place(&format!("{get}{ours}Content-Type: text/plain\r\n"), 2, "{}"),
            415,
        ),
        ("no type", place(&format!("{get}{ours}"), 2, "{}"), 415),
        ("a path upwards", of("GET", "/../job.toml", &get), 404),
        (
            "a coded path upwards",
            of("GET", "/%2e%2e/job.toml", &get),
            404,
        ),
        ("a file", of("GET", "/job.toml", &get), 404),
        (
            "another server",
            of("GET", "http://evil.example/job", &get),
            404,
        ),
        ("another method", of("GET", "/place", &get), 405),
        ("a method for a page", of("POST", "/", &post), 405),
        (
            "a request before the call",
            of(
                "OPTIONS",
                "/place",
                &format!("{host}Origin: http://evil.example\r\n"),
            ),
            401,
        ),
        ("no length", of("POST", "/place", &post), 411),
        (
            "parts",
            of(
                "POST",
                "/place",
                &format!("{post}Transfer-Encoding: chunked\r\n"),
            ),
            411,
        ),
        ("nine megabytes", place(&post, nine.len(), &nine), 413),
        ("long headers", of("GET", "/job", &long), 431),
        (
            "half a header",
            format!("GET /job HTTP/1.1\r\n{host}X-Strain"),
            400,
        ),
        ("half a body", place(&post, 50, "{"), 400),
        ("another protocol", "hello\r\n\r\n".to_owned(), 400),
        ("no JSON", place(&post, 5, "{\"a\":"), 400),
        (
            "an unknown key",
            place(&post, 27, "{\"picks\":\"\",\"path\":\"/etc\"}\n"),
            400,
        ),
        ("a call of ours", of("GET", "/alive", &get), 200),
    ];
    for (what, request, expected) in &rows {
        let response = server.exchange(request.as_bytes());
        assert_eq!(
            status(&response),
            *expected,
            "{what}: {}",
            &response[..response.len().min(400)]
        );
        let head = response.to_lowercase();
        let head = head.split("\r\n\r\n").next().unwrap();
        assert!(!head.contains("access-control"), "{what}");
        assert!(head.contains("x-content-type-options: nosniff"), "{what}");
        assert!(
            head.contains("content-security-policy: default-src 'none'"),
            "{what}"
        );
        assert!(head.contains("frame-ancestors 'none'"), "{what}");
    }
}

#[test]
fn the_page_without_a_token_has_no_data_and_a_new_nonce_each_time() {
    let server = Server::start(&frame_job("open_shell", LISTS));
    let ask = format!("GET / HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", server.port);
    let pages = [
        server.exchange(ask.as_bytes()),
        server.exchange(ask.as_bytes()),
    ];
    let nonces = pages.each_ref().map(|page| {
        for secret in [&*server.token, "Three-wheeled carrier", "job.toml", "N.FZ"] {
            assert!(!page.contains(secret), "{secret}");
        }
        let (_, rest) = page.split_once("script-src 'nonce-").unwrap();
        let nonce = &rest[..32];
        assert!(page.contains(&format!("<script nonce=\"{nonce}\">")));
        assert!(page.contains(&format!("<style nonce=\"{nonce}\">")));
        assert!(!page.contains("unsafe-inline") && page.contains("connect-src 'self'"));
        nonce.to_owned()
    });
    assert_ne!(nonces[0], nonces[1]);
}

#[test]
fn a_slow_client_is_cut_and_of_twenty_connections_sixteen_wait() {
    let server = Server::start(&frame_job("open_slow", LISTS));
    // One byte of a header each quarter of a second.
    let began = Instant::now();
    let mut slow = server.connect();
    let request = format!("GET / HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n", server.port);
    for byte in request.bytes().take(18) {
        let _ = slow.write_all(&[byte]);
        std::thread::sleep(Duration::from_millis(250));
    }
    let mut out = String::new();
    let _ = slow.read_to_string(&mut out);
    assert_eq!(status(&out), 408, "{out}");
    drop(slow);
    let seconds = began.elapsed().as_secs_f64();
    assert!(
        (4.0..9.0).contains(&seconds),
        "{seconds} s for a limit of 5 s"
    );

    std::thread::sleep(Duration::from_millis(300));
    let mut all: Vec<_> = (0..20).map(|_| server.connect()).collect();
    for stream in &mut all {
        stream.write_all(b"GET / HT").unwrap();
        std::thread::sleep(Duration::from_millis(10));
    }
    let refused = all.iter_mut().filter_map(|stream| {
        stream
            .set_read_timeout(Some(Duration::from_millis(200)))
            .unwrap();
        let mut first = [0; 12];
        stream.read_exact(&mut first).ok()?;
        Some(String::from_utf8_lossy(&first).into_owned())
    });
    let refused: Vec<String> = refused.collect();
    assert_eq!(refused, vec!["HTTP/1.1 503".to_owned(); 4]);
    drop(all);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(server.call("/alive", None).0, 200);
}

/// The table of sockets of Linux: local address and port, hexadecimal, least significant byte first.
#[cfg(target_os = "linux")]
#[test]
fn the_server_listens_on_the_loopback_addresses_alone_and_ends_with_130_by_ctrl_c() {
    let server = Server::start(&frame_job("open_bound", LISTS));
    let port = format!(":{:04X}", server.port);
    let bound = |table: &str| -> Vec<String> {
        let text = std::fs::read_to_string(table).unwrap_or_default();
        let rows = text.lines().filter_map(|l| {
            let mut fields = l.split_whitespace().skip(1);
            let (local, remote) = (fields.next()?, fields.next()?);
            // A socket that listens has no other end.
            let listens = remote.ends_with(":0000") && local.ends_with(&port);
            listens.then(|| local.trim_end_matches(&port).to_owned())
        });
        rows.collect()
    };
    assert_eq!(bound("/proc/net/tcp"), ["0100007F"]);
    let six = bound("/proc/net/tcp6");
    assert!(
        six.iter().all(|a| a == "00000000000000000000000001000000"),
        "{six:?}"
    );
    assert_eq!(server.interrupt(), Some(130));
}

#[test]
fn the_server_ends_after_the_idle_time_and_not_while_a_page_calls() {
    let job = frame_job("open_idle", LISTS);
    let around = Surroundings {
        pool: rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .unwrap(),
        store: None,
        out: job.with_file_name("out"),
    };
    let session =
        Session::begin(&job, around, &strainbridge::host::context::SilentProgress).unwrap();
    let idle = Duration::from_secs(2);
    let server = OwnServer::bind(
        0,
        Limits {
            idle,
            ..Limits::default()
        },
    )
    .unwrap();
    let address = server.address();
    let once = server.address_for_browser().unwrap();
    let parts = |address: &str| {
        let rest = address.strip_prefix("http://127.0.0.1:").unwrap();
        let (port, secret) = rest.split_once("/#").unwrap();
        (port.parse::<u16>().unwrap(), secret.to_owned())
    };
    let ((port, token), (_, key)) = (parts(&address), parts(&once));
    let running = std::thread::spawn(move || server.run(session));
    let send = |request: String| {
        let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut out = String::new();
        let _ = stream.read_to_string(&mut out);
        out
    };
    let call = || {
        let headers = format!("Host: 127.0.0.1:{port}\r\nX-Strainbridge-Token: {token}\r\n");
        let out = send(format!("GET /alive HTTP/1.1\r\n{headers}\r\n"));
        assert_eq!(status(&out), 200);
    };
    // The key in the arguments of a browser gives the token once, and is no token.
    let enter = |secret: &str| {
        let own = format!("127.0.0.1:{port}");
        let headers =
            format!("Host: {own}\r\nOrigin: http://{own}\r\nX-Strainbridge-Token: {secret}\r\n");
        send(format!(
            "POST /enter HTTP/1.1\r\n{headers}Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{{}}"
        ))
    };
    assert_eq!(status(&enter(&token)), 401);
    assert!(enter(&key).ends_with(&format!("{{\"token\":\"{token}\"}}")));
    assert_eq!((status(&enter(&key)), status(&enter(""))), (401, 401));
    for _ in 0..6 {
        call();
        std::thread::sleep(Duration::from_millis(500));
    }
    assert!(!running.is_finished());
    let began = Instant::now();
    running.join().unwrap();
    assert!(began.elapsed() < Duration::from_secs(10));
}
