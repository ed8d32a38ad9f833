//! `[macros]`: a few lines of G-code by name.

use crate::job::{Job, Placement};
use crate::refusal::{Key, Refusal};
use std::collections::BTreeMap;

/// Longest name, which a button shows [characters].
const LONGEST_NAME: usize = 30;
/// Longest macro [bytes].
const LONGEST: usize = 4000;
/// Most macros.
const MOST: usize = 20;

/// Whether each macro has a name and lines that can be read. Whether the arm can do them is checked where it begins.
pub(super) fn check_macros(macros: &BTreeMap<String, String>) -> Result<(), Refusal> {
    let refuse = |reason: String| Err(Key::Top("macros").refused(reason));
    if macros.len() > MOST {
        return refuse(format!("has {} entries: {MOST} at most", macros.len()));
    }
    let anywhere = Placement {
        origin: [0.0; 2],
        scale: 1.0,
        turn: 0.0,
        home: [0.0; 2],
    };
    for (name, text) in macros {
        if name.trim().is_empty() || name.chars().count() > LONGEST_NAME {
            return refuse(format!(
                "has the name \"{name}\": 1 to {LONGEST_NAME} characters are needed"
            ));
        }
        if text.len() > LONGEST {
            return refuse(format!(
                "has \"{name}\" of {} bytes: {LONGEST} at most",
                text.len()
            ));
        }
        match Job::parse(text, &anywhere) {
            Err(error) => return refuse(format!("has \"{name}\", which cannot be read: {error}")),
            Ok(job) if !job.stops.is_empty() => {
                return refuse(format!(
                    "has \"{name}\" with a pause: only a job waits for its user"
                ));
            }
            Ok(_) => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::robot::{BuiltIn, Robot};

    fn read(section: &str) -> Result<Robot, String> {
        let text = BuiltIn::find("benchtop_pen").unwrap().text;
        let robot = Robot::parse("arm.toml", &format!("{text}\n[macros]\n{section}"));
        robot.map_err(|error| error.to_string())
    }

    #[test]
    fn macros_are_read_and_lines_that_no_job_may_have_are_refused() {
        let robot = read("park = \"M5\\nG0 X10 Y5\"\n\"far left\" = \"G0 X-9\"\n").unwrap();
        let names: Vec<_> = robot.macros.keys().collect();
        assert_eq!(names, ["far left", "park"]);
        for (section, reason) in [
            ("park = \"G1 X\"", "\"park\", which cannot be read: line 1"),
            ("park = \"G0 X1\\nG41 X2\"", "line 2"),
            ("up = \"M5\"", "the job has no motion"),
            ("park = \"G0 X1\\nM0\\nG0 X2\"", "\"park\" with a pause"),
            ("\"\" = \"M5\"", "1 to 30 characters"),
            ("park = 5", "expected a string"),
        ] {
            let refused = read(section).unwrap_err();
            assert!(refused.starts_with("arm.toml, line "), "{refused}");
            assert!(refused.contains(reason), "{reason}: {refused}");
        }
    }
}
