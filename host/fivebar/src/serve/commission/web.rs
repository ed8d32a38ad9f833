//! The guided page's files and its requests.

use super::super::guard::Guard;
use super::super::web::{guarded, live};
use super::super::wire::channels::WebEnd;
use super::clicks::Click;
use super::state::Shared;
use crate::commission::named;
use axum::Router;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use std::sync::Arc;

/// The longest body of a click [bytes].
const LONGEST: usize = 64;

const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// The page's files: path, media type, text.
const ASSETS: [(&str, &str, &str); 8] = [
    (
        "/",
        "text/html; charset=utf-8",
        include_str!("../page/commission.html"),
    ),
    ("/style.css", STYLE, include_str!("../page/style.css")),
    (
        "/commission.css",
        STYLE,
        include_str!("../page/commission.css"),
    ),
    (
        "/commission.js",
        SCRIPT,
        include_str!("../page/commission.js"),
    ),
    ("/clicks.js", SCRIPT, include_str!("../page/clicks.js")),
    ("/clock.js", SCRIPT, include_str!("../page/clock.js")),
    (
        "/connection.js",
        SCRIPT,
        include_str!("../page/connection.js"),
    ),
    (
        "/emergency.js",
        SCRIPT,
        include_str!("../page/emergency.js"),
    ),
];

/// The routes, behind the guard.
pub(super) fn router(shared: Arc<Shared>, pages: WebEnd, guard: Guard) -> Router {
    let mut router = Router::new();
    for (path, kind, text) in ASSETS {
        let answer = move || async move { ([(header::CONTENT_TYPE, kind)], text) };
        router = router.route(path, get(answer));
    }
    let router = router
        .route("/state.json", get(state))
        .route("/begin", post(begin))
        .route("/again", post(again))
        .route("/done", post(done))
        .route("/answer", post(answer))
        .route("/safe", post(safe))
        .route("/stop", post(stop))
        .layer(DefaultBodyLimit::max(LONGEST))
        .with_state(shared);
    let standing = Router::new().route("/live", get(live)).with_state(pages);
    guarded(router.merge(standing), guard)
}

async fn state(State(shared): State<Arc<Shared>>) -> Response {
    let kind = [(header::CONTENT_TYPE, "application/json")];
    (kind, shared.json()).into_response()
}

async fn begin(State(shared): State<Arc<Shared>>, step: String) -> Response {
    on_step(&shared, &step, Click::Begin)
}

async fn again(State(shared): State<Arc<Shared>>, step: String) -> Response {
    on_step(&shared, &step, Click::Again)
}

fn on_step(shared: &Shared, name: &str, click: fn(&'static str) -> Click) -> Response {
    match named(name) {
        Some(step) => clicked(shared, click(step)),
        None => (StatusCode::BAD_REQUEST, "there is no such step\n").into_response(),
    }
}

async fn done(State(shared): State<Arc<Shared>>, body: String) -> Response {
    let all = body == "all";
    clicked(&shared, Click::Done { all })
}

/// The index of an answer of the question that waits.
async fn answer(State(shared): State<Arc<Shared>>, body: String) -> Response {
    match body.parse() {
        Ok(index) => clicked(&shared, Click::Answer(index)),
        Err(_) => (StatusCode::BAD_REQUEST, "an answer is a number\n").into_response(),
    }
}

fn clicked(shared: &Shared, click: Click) -> Response {
    match shared.click(click) {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(reason) => (StatusCode::CONFLICT, reason).into_response(),
    }
}

async fn safe(State(shared): State<Arc<Shared>>) -> StatusCode {
    shared.release();
    StatusCode::NO_CONTENT
}

/// Works at all times: it waits for nothing.
async fn stop(State(shared): State<Arc<Shared>>) -> StatusCode {
    shared.raise_stop();
    StatusCode::NO_CONTENT
}
