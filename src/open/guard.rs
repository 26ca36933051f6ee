//! Who may call the server: a page of this server alone, in a browser to which the user gave the address.

use super::http::{Head, Response};
use rand::TryRng;
use rand::rngs::SysRng;
use std::sync::{Mutex, PoisonError};

/// Header that carries the token. A page of another origin cannot set it without a permission that this server never gives.
const TOKEN: &str = "x-strainbridge-token";

/// Returns 128 random bits of the operating system as hexadecimal text.
///
/// # Errors
/// A system without random numbers.
pub fn random_text() -> Result<String, String> {
    let mut bytes = [0_u8; 16];
    SysRng
        .try_fill_bytes(&mut bytes)
        .map_err(|e| format!("the system gives no random numbers ({e})"))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

/// Token and port of a server.
pub struct Guard {
    token: String,
    port: u16,
    /// Key that a browser may exchange for the token, once.
    key: Mutex<Option<String>>,
}

impl Guard {
    /// Guards a server at a port with a new token.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn new(port: u16) -> Result<Self, String> {
        let token = random_text()?;
        Ok(Self {
            token,
            port,
            key: Mutex::default(),
        })
    }

    /// Returns the address of the page, with the token in its fragment: browsers do not send fragments to servers or in `Referer`.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/#{}", self.port, self.token)
    }

    /// Returns an address with a key that the page exchanges for the token, once.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn address_for_browser(&self) -> Result<String, String> {
        let key = format!("once-{}", random_text()?);
        let address = format!("http://127.0.0.1:{}/#{key}", self.port);
        *self.key.lock().unwrap_or_else(PoisonError::into_inner) = Some(key);
        Ok(address)
    }

    /// Returns the token for the key of [`Guard::address_for_browser`], which is then used up.
    ///
    /// # Errors
    /// The refusal.
    pub fn exchange_key(&self, head: &Head) -> Result<&str, Response> {
        let mut key = self.key.lock().unwrap_or_else(PoisonError::into_inner);
        self.check_caller(head, key.as_deref().unwrap_or(""))?;
        *key = None;
        Ok(&self.token)
    }

    /// Refuses names of other hosts. Otherwise a foreign page could give its own name our address (DNS rebinding) and would then count as our page.
    ///
    /// # Errors
    /// The refusal.
    pub fn check_host(&self, head: &Head) -> Result<(), Response> {
        let is_ours = |host: &str| {
            let names = ["localhost", "127.0.0.1", "[::1]"];
            let mut ours = names.iter().map(|n| format!("{n}:{}", self.port));
            ours.any(|o| o.eq_ignore_ascii_case(host))
        };
        match head.header("host").is_some_and(is_ours) {
            true => Ok(()),
            false => Err(Response::refusal(
                403,
                "this server answers on the loopback address alone",
            )),
        }
    }

    /// Checks a call for data: host, token, origin, and the type of a body.
    ///
    /// # Errors
    /// The refusal.
    pub fn check_call(&self, head: &Head) -> Result<(), Response> {
        self.check_caller(head, &self.token)
    }

    fn check_caller(&self, head: &Head, expected: &str) -> Result<(), Response> {
        self.check_host(head)?;
        let given = head.header(TOKEN).unwrap_or("");
        if expected.is_empty() || !is_same_text(given.as_bytes(), expected.as_bytes()) {
            return Err(Response::refusal(
                401,
                "the token is missing or wrong: open the address that the program printed",
            ));
        }
        let ours = head.header("host").map(|h| format!("http://{h}"));
        let origin = head.header("origin");
        let is_foreign = head.has("origin") && origin != ours.as_deref();
        if is_foreign || head.method == "POST" && origin.is_none() {
            return Err(Response::refusal(
                403,
                "the call comes from a page of another origin",
            ));
        }
        let kind = head.header("content-type").unwrap_or("");
        let kind = kind.split(';').next().unwrap_or("").trim();
        if head.method == "POST" && !kind.eq_ignore_ascii_case("application/json") {
            return Err(Response::refusal(415, "the body must be application/json"));
        }
        Ok(())
    }
}

/// Compares two texts in a time that does not depend on where they differ.
fn is_same_text(a: &[u8], b: &[u8]) -> bool {
    let differs = a
        .iter()
        .zip(b)
        .fold(0, |d, (x, y)| std::hint::black_box(d | (x ^ y)));
    a.len() == b.len() && differs == 0
}
