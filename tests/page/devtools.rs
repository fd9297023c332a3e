//! The DevTools protocol over a pair of pipes: JSON objects, each terminated by a zero byte
//! (<https://chromedevtools.github.io/devtools-protocol/>).
//!
//! Pipes need no library and no port, and the browser ends when they are closed, however its user
//! ends.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{ChildStdin, ChildStdout};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Time limit of an answer, with a wide margin for busy machines.
pub const TIME: Duration = Duration::from_secs(60);

pub struct DevTools {
    to: ChildStdin,
    from: Receiver<Value>,
    calls: u64,
    /// The events that the browser has sent, in order.
    pub events: Vec<Event>,
}

pub struct Event {
    pub method: String,
    pub session: Option<String>,
    pub told: Value,
}

impl DevTools {
    pub fn new(to: ChildStdin, from: ChildStdout) -> Self {
        let (sender, receiver) = mpsc::channel();
        thread::spawn(move || {
            // Ends with the browser or with the receiver.
            for message in messages(from) {
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        DevTools { to, from: receiver, calls: 0, events: Vec::new() }
    }

    /// Calls a method of the browser or of a page in it, and waits for its result.
    ///
    /// # Errors
    /// The browser's answer, if it is not a result.
    pub fn call(
        &mut self,
        session: Option<&str>,
        method: &str,
        parameters: Value,
    ) -> Result<Value, String> {
        self.calls += 1;
        let mut message = json!({"id": self.calls, "method": method, "params": parameters});
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        let sent = self.to.write_all(format!("{message}\0").as_bytes());
        sent.and_then(|()| self.to.flush()).map_err(|error| format!("{method}: {error}"))?;
        let until = Instant::now() + TIME;
        loop {
            let answer = self.next(until).map_err(|error| format!("{method}: {error}"))?;
            let Some(mut answer) = answer else { continue };
            if answer["id"] != self.calls {
                continue;
            }
            return match answer.get("error") {
                Some(error) => Err(format!("{method}: {error}")),
                None => Ok(answer["result"].take()),
            };
        }
    }

    /// Waits for an event.
    ///
    /// # Errors
    /// If it does not occur within the time limit.
    pub fn wait_for(&mut self, what: &str, is: impl Fn(&Event) -> bool) -> Result<(), String> {
        let until = Instant::now() + TIME;
        while !self.events.iter().any(&is) {
            self.next(until).map_err(|error| format!("waiting for {what}: {error}"))?;
        }
        Ok(())
    }

    /// Receives the next message: an answer is returned, an event is recorded.
    fn next(&mut self, until: Instant) -> Result<Option<Value>, String> {
        let left = until.saturating_duration_since(Instant::now());
        let mut message = self.from.recv_timeout(left).map_err(|error| match error {
            RecvTimeoutError::Timeout => format!("nothing came for {} s", TIME.as_secs()),
            RecvTimeoutError::Disconnected => "the browser has gone".to_owned(),
        })?;
        let Some(method) = message["method"].as_str().map(str::to_owned) else {
            return Ok(Some(message));
        };
        let session = message["sessionId"].as_str().map(str::to_owned);
        self.events.push(Event { method, session, told: message["params"].take() });
        Ok(None)
    }
}

fn messages(from: impl Read) -> impl Iterator<Item = Value> {
    let messages = BufReader::new(from).split(0).map_while(Result::ok);
    messages.map_while(|bytes| serde_json::from_slice(&bytes).ok())
}
