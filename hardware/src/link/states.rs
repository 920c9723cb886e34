//! Joint states as they arrive, on a thread of its own: so that a slow disk does not look like a slow robot.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use futures::StreamExt;
use ros2_client::gid::Gid;
use ros2_client::{Message, Subscription};

use super::LinkError;

/// What a thread received, and when by the local monotonic clock.
pub(crate) struct Received<M> {
    pub(crate) at: Instant,
    /// Who sent it; zero where the message cannot be decoded.
    pub(crate) from: Gid,
    /// The message, or why its bytes cannot be decoded.
    pub(crate) message: Result<M, String>,
}

/// The messages of one topic, in the order of arrival.
pub(crate) struct Inbox<M> {
    received: Receiver<Received<M>>,
    open: Arc<AtomicBool>,
}

impl<M: Message + Send + 'static> Inbox<M> {
    /// Listens until it is dropped.
    pub(crate) fn new(what: &str, subscription: Subscription<M>) -> Result<Self, LinkError> {
        let (sender, received) = channel();
        let open = Arc::new(AtomicBool::new(true));
        let listening = Arc::clone(&open);
        std::thread::Builder::new()
            .name(what.to_owned())
            .spawn(move || listen(&subscription, &sender, &listening))
            .map_err(|error| LinkError::middleware(format!("thread for {what}"), &error))?;
        Ok(Self { received, open })
    }

    /// The next message, if one comes within `patience`.
    pub(crate) fn next(&self, patience: Duration) -> Option<Received<M>> {
        self.received.recv_timeout(patience).ok()
    }

    /// The next message, if it is there already.
    pub(crate) fn take(&self) -> Option<Received<M>> {
        self.received.try_recv().ok()
    }
}

impl<M> Drop for Inbox<M> {
    fn drop(&mut self) {
        self.open.store(false, Ordering::Relaxed);
    }
}

fn listen<M: Message + Send + 'static>(
    subscription: &Subscription<M>,
    sender: &Sender<Received<M>>,
    open: &AtomicBool,
) {
    let mut stream = std::pin::pin!(subscription.async_stream());
    smol::block_on(async {
        while open.load(Ordering::Relaxed) {
            let look_up = async {
                smol::Timer::after(Duration::from_millis(100)).await;
                None
            };
            let next = async { Some(stream.next().await) };
            let (from, message) = match smol::future::or(next, look_up).await {
                None => continue,
                Some(None) => break,
                Some(Some(Ok((message, info)))) => (info.publisher_gid(), Ok(message)),
                Some(Some(Err(error))) => (Gid::ZERO, Err(format!("{error:?}"))),
            };
            if sender.send(Received { at: Instant::now(), from, message }).is_err() {
                break;
            }
        }
    });
}
