//! The desktop's answer to a request of the page: `cargo run -p fivebar-browser --example answer -- '{"op": "draw"}'`.

fn main() {
    let request = std::env::args().nth(1).unwrap_or_default();
    let mut samples = 0;
    let answer = fivebar_browser::answer(&request, &mut |rows| samples += rows.len());
    println!("{answer}");
    assert!(samples > 0 || !request.contains("draw") || answer.contains("error"));
}
