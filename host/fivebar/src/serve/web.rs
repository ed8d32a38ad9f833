//! The page's files and the websockets.

use super::ServeError;
use super::accept::{self, ShownToken};
use super::guard::{Admission, Guard};
use super::socket::exchange;
use super::wire::channels::WebEnd;
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use fivebar_files::job::DEMONSTRATION;
use fivebar_report::html::{UPLOT_SCRIPT, UPLOT_STYLE};
use hyper::upgrade::Upgraded;
use hyper_util::rt::TokioIo;
use std::net::TcpListener;
use std::sync::Arc;
use std::thread;
use tokio::net::TcpStream;
use tokio::runtime::Builder;
use tokio::sync::{OwnedSemaphorePermit, oneshot};
use tokio_tungstenite::tungstenite::handshake::server::create_response_with_body;

/// Browsers load only what this server sends, and show the page in no frame of another.
const POLICY: &str =
    "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'";

/// A file of the page: its path, its media type, its text.
type Asset = (&'static str, &'static str, &'static str);

const SCRIPT: &str = "text/javascript; charset=utf-8";

const ASSETS: [Asset; 32] = [
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
        "/live.css",
        "text/css; charset=utf-8",
        include_str!("page/live.css"),
    ),
    ("/uPlot.js", SCRIPT, UPLOT_SCRIPT),
    ("/uPlot.css", "text/css; charset=utf-8", UPLOT_STYLE),
    ("/app.js", SCRIPT, include_str!("page/app.js")),
    ("/clicks.js", SCRIPT, include_str!("page/clicks.js")),
    ("/clock.js", SCRIPT, include_str!("page/clock.js")),
    ("/colour.js", SCRIPT, include_str!("page/colour.js")),
    ("/console.js", SCRIPT, include_str!("page/console.js")),
    ("/connection.js", SCRIPT, include_str!("page/connection.js")),
    ("/drawing.js", SCRIPT, include_str!("page/drawing.js")),
    ("/drag.js", SCRIPT, include_str!("page/drag.js")),
    ("/emergency.js", SCRIPT, include_str!("page/emergency.js")),
    ("/files.js", SCRIPT, include_str!("page/files.js")),
    ("/hold.js", SCRIPT, include_str!("page/hold.js")),
    ("/inspect.js", SCRIPT, include_str!("page/inspect.js")),
    ("/macros.js", SCRIPT, include_str!("page/macros.js")),
    ("/pen.js", SCRIPT, include_str!("page/pen.js")),
    ("/placement.js", SCRIPT, include_str!("page/placement.js")),
    ("/keys.js", SCRIPT, include_str!("page/keys.js")),
    ("/layers.js", SCRIPT, include_str!("page/layers.js")),
    ("/map.js", SCRIPT, include_str!("page/map.js")),
    ("/drives.js", SCRIPT, include_str!("page/drives.js")),
    ("/panel.js", SCRIPT, include_str!("page/panel.js")),
    ("/plots.js", SCRIPT, include_str!("page/plots.js")),
    ("/reading.js", SCRIPT, include_str!("page/reading.js")),
    ("/recording.js", SCRIPT, include_str!("page/recording.js")),
    ("/replay.js", SCRIPT, include_str!("page/replay.js")),
    ("/regions.js", SCRIPT, include_str!("page/regions.js")),
    ("/tabs.js", SCRIPT, include_str!("page/tabs.js")),
    (
        "/demonstration.gcode",
        "text/plain; charset=utf-8",
        DEMONSTRATION,
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
    serve_until(listener, router(site), controller)
}

/// Runs `work` in its own thread and serves requests until it returns.
pub(super) fn serve_until(
    listener: TcpListener,
    router: Router,
    work: Box<dyn FnOnce() -> Result<(), ServeError> + Send>,
) -> Result<(), ServeError> {
    let mut runtime = Builder::new_current_thread();
    runtime.enable_all().build()?.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let (ended, end) = oneshot::channel();
        thread::spawn(move || ended.send(work()));
        tokio::select! {
            served = accept::serve(listener, router) => Ok(served?),
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
        // All responses share the text.
        let text = Bytes::from(text);
        let answer = move || async move { ([(header::CONTENT_TYPE, "application/json")], text) };
        router = router.route(path, get(answer));
    }
    guarded(router.route("/live", get(live)).with_state(pages), guard)
}

/// The routes for those only whom the guard admits.
pub(super) fn guarded(router: Router, guard: Guard) -> Router {
    router.layer(middleware::from_fn_with_state(Arc::new(guard), authorize))
}

async fn authorize(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.authorize(request.uri(), request.headers()) {
        Ok(Admission::Serve) => {
            if let Some(token) = request.extensions().get::<ShownToken>() {
                token.set();
            }
            next.run(request).await
        }
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

/// Makes a request a page's websocket.
pub(super) async fn live(State(pages): State<WebEnd>, mut request: Request) -> Response {
    let reply = match create_response_with_body(&request, Body::empty) {
        Ok(reply) => reply,
        Err(error) => return (StatusCode::BAD_REQUEST, format!("{error}\n")).into_response(),
    };
    let Ok(place) = Arc::clone(&pages.places).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open\n").into_response();
    };
    let upgrade = hyper::upgrade::on(&mut request);
    tokio::spawn(async move {
        if let Ok(upgraded) = upgrade.await {
            page_thread(upgraded, pages, place);
        }
    });
    reply
}

/// Serves a page in a thread of its own. The system shares the processor between threads, so that
/// what one page sends delays no stop of another; a thread that waits most of the time runs first.
/// With one thread for all pages the arm of a lost page rested after up to 0.96 s on a busy machine, with
/// a thread each after up to 0.46 s.
fn page_thread(upgraded: Upgraded, pages: WebEnd, place: OwnedSemaphorePermit) {
    // Every connection is of this type. A page sends nothing before the reply has arrived.
    let Ok(parts) = upgraded.downcast::<TokioIo<TcpStream>>() else {
        return;
    };
    let (stream, early) = (parts.io.into_inner(), parts.read_buf);
    let Ok(stream) = stream.into_std() else {
        return;
    };
    let serve = move || {
        let runtime = Builder::new_current_thread().enable_all().build();
        let Ok(runtime) = runtime else { return };
        runtime.block_on(async {
            let probe = stream.try_clone().ok();
            if let Ok(stream) = TcpStream::from_std(stream) {
                exchange(stream, early, probe, pages).await;
            }
        });
        drop(place);
    };
    // Without a thread the connection is closed.
    let _ = thread::Builder::new().name("page".into()).spawn(serve);
}
