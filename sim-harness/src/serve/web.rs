//! The pages and their websockets.

use super::ServeError;
use super::guard::Guard;
use super::message::{Event, WebSide, Wish};
use super::pilot::Client;
use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Request, State};
use axum::http::{HeaderValue, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::oneshot;

/// The longest message of a page: a job of a few hundred thousand moves.
const LONGEST: usize = 16 << 20;

/// Nothing but what this server sends is loaded, and no other page frames it.
const POLICY: &str = "default-src 'self'; frame-ancestors 'none'; base-uri 'none'";

/// A file of the page.
type Asset = (&'static str, &'static str, &'static str);

const ASSETS: [Asset; 5] = [
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
    (
        "/app.js",
        "text/javascript; charset=utf-8",
        include_str!("page/app.js"),
    ),
    (
        "/drawing.js",
        "text/javascript; charset=utf-8",
        include_str!("page/drawing.js"),
    ),
    (
        "/plots.js",
        "text/javascript; charset=utf-8",
        include_str!("page/plots.js"),
    ),
];

/// Serves until `machine`, which is given a thread of its own, returns.
pub(super) fn run(
    listener: TcpListener,
    guard: Guard,
    pages: WebSide,
    arm: String,
    machine: Box<dyn FnOnce() -> ServeError + Send>,
) -> Result<(), ServeError> {
    let mut runtime = tokio::runtime::Builder::new_current_thread();
    runtime.enable_all().build()?.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let (ended, end) = oneshot::channel();
        thread::spawn(move || ended.send(machine()));
        tokio::select! {
            served = axum::serve(listener, router(guard, pages, arm)) => Ok(served?),
            error = end => match error {
                Ok(error) => Err(error),
                Err(_) => Err(std::io::Error::other("the machine's thread panicked").into()),
            },
        }
    })
}

fn router(guard: Guard, pages: WebSide, arm: String) -> Router {
    let mut router = Router::new();
    for (path, kind, text) in ASSETS {
        let answer = move || async move { ([(header::CONTENT_TYPE, kind)], text) };
        router = router.route(path, get(answer));
    }
    let arm = move || async move { ([(header::CONTENT_TYPE, "application/json")], arm) };
    let guard = Arc::new(guard);
    router
        .route("/arm.json", get(arm))
        .route("/live", get(live))
        .with_state(pages)
        .layer(middleware::from_fn_with_state(guard, admit))
}

async fn admit(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    if let Err(refusal) = guard.admit(request.uri(), request.headers()) {
        return refusal.into_response();
    }
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    headers.insert(
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(POLICY),
    );
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(
        header::REFERRER_POLICY,
        HeaderValue::from_static("no-referrer"),
    );
    response
}

async fn live(State(pages): State<WebSide>, upgrade: WebSocketUpgrade) -> Response {
    static CLIENTS: AtomicU64 = AtomicU64::new(1);
    let client = CLIENTS.fetch_add(1, Ordering::Relaxed);
    upgrade
        .max_message_size(LONGEST)
        .on_upgrade(move |socket| attend(socket, client, pages))
}

/// Carries messages both ways until the page is gone.
async fn attend(mut socket: WebSocket, client: Client, pages: WebSide) {
    let mut news = pages.news.subscribe();
    let hello = format!(r#"{{"hello":{client}}}"#);
    if socket.send(Message::Text(hello.into())).await.is_err() {
        return;
    }
    let tell = |event| pages.events.send((client, event));
    let _ = tell(Event::Joined);
    loop {
        tokio::select! {
            heard = socket.recv() => match heard {
                Some(Ok(Message::Text(text))) => match serde_json::from_str::<Wish>(&text) {
                    Ok(wish) => if tell(Event::Wish(wish)).is_err() { break },
                    // A page of another version, or not a page at all.
                    Err(_) => break,
                },
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Binary(_) | Message::Close(_)) | Err(_)) | None => break,
            },
            told = news.recv() => match told {
                Ok(text) => if socket.send(Message::Text(text)).await.is_err() { break },
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => break,
            },
        }
    }
    let _ = tell(Event::Left);
}
