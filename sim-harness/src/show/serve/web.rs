//! The page's files and the websockets.

use super::ServeError;
use super::guard::{Admission, Guard};
use super::lease::PageId;
use super::message::{ClientRequest, PageEvent, WebEnd};
use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::oneshot;

/// Longest message of a page [bytes]: a job of a few hundred thousand moves.
const MAX_MESSAGE_SIZE: usize = 16 << 20;

/// Most messages of a page per second, several times what a user and the signs of life
/// produce. A page that sends more is disconnected. Its messages then neither delay another
/// page's stop nor move the arm late.
const MAX_MESSAGES_PER_SECOND: u32 = 1000;

/// Browsers load only what this server sends, and show the page in no frame of another.
const POLICY: &str = "default-src 'self'; frame-ancestors 'none'; base-uri 'none'";

/// A file of the page: its path, its media type, its text.
type Asset = (&'static str, &'static str, &'static str);

const SCRIPT: &str = "text/javascript; charset=utf-8";

const ASSETS: [Asset; 12] = [
    (
        "/",
        "text/html; charset=utf-8",
        include_str!("page/index.html"),
    ),
    (
        "/style.css",
        "text/css; charset=utf-8",
        include_str!("page/style.css"),
    ),
    ("/app.js", SCRIPT, include_str!("page/app.js")),
    ("/clock.js", SCRIPT, include_str!("page/clock.js")),
    ("/colour.js", SCRIPT, include_str!("page/colour.js")),
    ("/connection.js", SCRIPT, include_str!("page/connection.js")),
    ("/drawing.js", SCRIPT, include_str!("page/drawing.js")),
    ("/drag.js", SCRIPT, include_str!("page/drag.js")),
    ("/map.js", SCRIPT, include_str!("page/map.js")),
    ("/panel.js", SCRIPT, include_str!("page/panel.js")),
    ("/plots.js", SCRIPT, include_str!("page/plots.js")),
    (
        "/demonstration.gcode",
        "text/plain; charset=utf-8",
        include_str!("../../../jobs/fivebar.gcode"),
    ),
];

/// What is served besides the page's files.
pub(super) struct Site {
    pub(super) guard: Guard,
    pub(super) pages: WebEnd,
    /// The description of the arm, as JSON.
    pub(super) arm: String,
    /// The maps of its workspace, as JSON.
    pub(super) maps: String,
}

/// Runs `controller` in its own thread and serves pages until it returns.
pub(super) fn run(
    listener: TcpListener,
    site: Site,
    controller: Box<dyn FnOnce() -> Result<(), ServeError> + Send>,
) -> Result<(), ServeError> {
    let mut runtime = tokio::runtime::Builder::new_current_thread();
    runtime.enable_all().build()?.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let (ended, end) = oneshot::channel();
        thread::spawn(move || ended.send(controller()));
        tokio::select! {
            served = axum::serve(listener, router(site)) => Ok(served?),
            outcome = end => outcome.unwrap_or_else(|_| {
                Err(std::io::Error::other("the controller's thread panicked").into())
            }),
        }
    })
}

fn router(site: Site) -> Router {
    let Site {
        guard,
        pages,
        arm,
        maps,
    } = site;
    let mut router = Router::new();
    for (path, kind, text) in ASSETS {
        let answer = move || async move { ([(header::CONTENT_TYPE, kind)], text) };
        router = router.route(path, get(answer));
    }
    for (path, text) in [("/arm.json", arm), ("/maps.json", maps)] {
        let answer = move || async move { ([(header::CONTENT_TYPE, "application/json")], text) };
        router = router.route(path, get(answer));
    }
    router
        .route("/live", get(live))
        .with_state(pages)
        .layer(middleware::from_fn_with_state(Arc::new(guard), authorize))
}

async fn authorize(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.authorize(request.uri(), request.headers()) {
        Ok(Admission::Serve) => next.run(request).await,
        Ok(Admission::SetCookie { cookie }) => {
            let headers = [(header::LOCATION, "/".into()), (header::SET_COOKIE, cookie)];
            (StatusCode::SEE_OTHER, headers).into_response()
        }
        Err(refusal) => refusal.into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::CACHE_CONTROL, "no-store"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

async fn live(State(pages): State<WebEnd>, upgrade: WebSocketUpgrade) -> Response {
    static PAGES: AtomicU64 = AtomicU64::new(1);
    let page = PAGES.fetch_add(1, Ordering::Relaxed);
    upgrade
        .max_message_size(MAX_MESSAGE_SIZE)
        .on_upgrade(move |socket| exchange(socket, page, pages))
}

/// Passes messages in both directions until the page disconnects.
async fn exchange(mut socket: WebSocket, page: PageId, pages: WebEnd) {
    let mut messages = pages.messages.subscribe();
    let hello = format!(r#"{{"hello":{page}}}"#);
    if socket.send(Message::Text(hello.into())).await.is_err() {
        return;
    }
    let report = |event| pages.events.send((page, event));
    let _ = report(PageEvent::Joined);
    let mut second = (Instant::now(), 0);
    loop {
        if second.0.elapsed() >= Duration::from_secs(1) {
            second = (Instant::now(), 0);
        }
        let event = tokio::select! {
            received = socket.recv() => match received {
                _ if second.1 == MAX_MESSAGES_PER_SECOND => break,
                Some(Ok(Message::Text(text))) => {
                    second.1 += 1;
                    match serde_json::from_str::<ClientRequest>(&text) {
                        Ok(request) => PageEvent::Request(request),
                        Err(error) => PageEvent::Malformed(error.to_string()),
                    }
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {
                    second.1 += 1;
                    continue;
                }
                Some(Ok(Message::Binary(_) | Message::Close(_)) | Err(_)) | None => break,
            },
            message = messages.recv() => match message {
                Ok(text) => match socket.send(Message::Text(text)).await {
                    Ok(()) => continue,
                    Err(_) => break,
                },
                Err(RecvError::Lagged(_)) => PageEvent::Lagged,
                Err(RecvError::Closed) => break,
            },
        };
        if report(event).is_err() {
            break;
        }
    }
    let _ = report(PageEvent::Left);
}
