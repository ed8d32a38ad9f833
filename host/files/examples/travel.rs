//! How far the tool travels between the strokes of drawings: `cargo run -p fivebar-files --example travel FILE.svg …`
//! prints for each file its strokes and the travel from the end of one to the beginning of the next [mm].

use fivebar_files::job::{Job, Placement, read};
use std::path::Path;

/// Two strokes of 10 mm, 5 mm apart, drawn to and fro.
const TWO: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 5" width="10mm" height="5mm">
<path d="M0 0H10M0 5H10" stroke="black" fill="none"/></svg>"#;

const AS_DRAWN: Placement = Placement {
    origin: [0.0; 2],
    scale: 1.0,
    turn: 0.0,
    home: [0.0; 2],
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() {
        println!("{}", travel(TWO)?);
    }
    for file in files {
        println!("{file}: {}", travel(&read(Path::new(&file))?)?);
    }
    Ok(())
}

fn travel(text: &str) -> Result<String, Box<dyn std::error::Error>> {
    let job = Job::parse(text, &AS_DRAWN)?;
    let (mut strokes, mut travel) = (0, 0.0);
    let mut at: Option<[f64; 2]> = None;
    for step in &job.steps {
        let Some(to) = step.action.end() else {
            continue;
        };
        if step.tool == 0.0 {
            strokes += 1;
            travel += at.map_or(0.0, |at| (to[0] - at[0]).hypot(to[1] - at[1]));
        }
        at = Some(to);
    }
    Ok(format!(
        "{strokes} strokes, {:.3} mm of travel",
        1e3 * travel
    ))
}
