//! `open`: the server that answers a live page. Requests are raw bytes over TCP.

mod browser;
mod guard;
mod plan;

use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A server in progress; it ends with the value.
pub struct Server {
    child: Child,
    pub port: u16,
    pub token: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Server {
    /// Starts the program on a job and reads the address that it prints.
    pub fn start(job: &Path) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(["open", job.to_str().unwrap(), "--no-browser", "--no-cache"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        out.read_line(&mut line).unwrap();
        let rest = line.trim().strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = rest.split_once("/#").unwrap();
        assert_eq!(token.len(), 32, "128 bits");
        Self {
            port: port.parse().unwrap(),
            token: token.to_owned(),
            child,
        }
    }

    /// Headers of a call by the page.
    pub fn headers(&self) -> String {
        let (port, token) = (self.port, &self.token);
        format!("Host: 127.0.0.1:{port}\r\nX-Strainbridge-Token: {token}\r\n")
    }

    /// Headers of a call with a body by the page.
    pub fn post_headers(&self) -> String {
        let own = format!("Origin: http://127.0.0.1:{}\r\n", self.port);
        self.headers() + &own + "Content-Type: application/json\r\n"
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let limit = Some(Duration::from_secs(60));
        stream.set_read_timeout(limit).unwrap();
        stream
    }

    /// Sends bytes and returns the whole response as text.
    pub fn exchange(&self, request: &[u8]) -> String {
        let mut stream = self.connect();
        // A server that refuses early may close before all is sent.
        let _ = stream.write_all(request);
        let _ = stream.shutdown(Shutdown::Write);
        let mut out = Vec::new();
        let _ = stream.read_to_end(&mut out);
        String::from_utf8_lossy(&out).into_owned()
    }

    /// Calls like the page: POST with a body, GET without.
    pub fn call(&self, target: &str, body: Option<&Value>) -> (u16, Value) {
        let request = match body {
            None => format!("GET {target} HTTP/1.1\r\n{}\r\n", self.headers()),
            Some(body) => {
                let (headers, body) = (self.post_headers(), body.to_string());
                let length = body.len();
                format!("POST {target} HTTP/1.1\r\n{headers}Content-Length: {length}\r\n\r\n{body}")
            }
        };
        let response = self.exchange(request.as_bytes());
        let (_, body) = response.split_once("\r\n\r\n").unwrap();
        (status(&response), serde_json::from_str(body).unwrap())
    }

    /// Calls like the page, and expects success.
    pub fn ask(&self, target: &str, body: Option<&Value>) -> Value {
        let (status, value) = self.call(target, body);
        assert_eq!(status, 200, "{target}: {value}");
        value
    }

    /// Process id.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Interrupts the program as Ctrl-C does, and returns its exit code.
    pub fn interrupt(mut self) -> Option<i32> {
        let pid = self.child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &pid]).status();
        assert!(sent.unwrap().success());
        self.child.wait().unwrap().code()
    }
}

/// The status of a response; 0 without one.
pub fn status(response: &str) -> u16 {
    let code = response.split(' ').nth(1);
    code.and_then(|c| c.parse().ok()).unwrap_or(0)
}

/// Writes the frame and its job into a folder of its own. `candidates` are the lines of that section.
pub fn frame_job(name: &str, candidates: &str) -> std::path::PathBuf {
    let dir = super::folder(name);
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    std::fs::copy(from.join("frame.bdf"), dir.join("frame.bdf")).unwrap();
    let text = std::fs::read_to_string(from.join("place.toml")).unwrap();
    let (head, rest) = text.split_once("[candidates]").unwrap();
    let (_, placement) = rest.split_once("[placement]").unwrap();
    let job = dir.join("job.toml");
    let text = format!("{head}[candidates]\n{candidates}\n[placement]{placement}");
    std::fs::write(&job, text).unwrap();
    job
}
