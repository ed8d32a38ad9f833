//! The examples at the end of each command's help.

use clap::Command;

/// The examples of each command.
const EXAMPLES: &[(&str, &[&str])] = &[
    (
        "accuracy",
        &[
            "fivebar accuracy benchtop --at 40mm,200mm",
            "fivebar accuracy my-arm.toml --map --out out/accuracy",
            "fivebar accuracy loose_four_bar --time 0.1 --json",
        ],
    ),
    (
        "board-test",
        &[
            "fivebar board-test --port /dev/ttyUSB0",
            "fivebar board-test --port /dev/ttyUSB0 --seconds 5 --json < /dev/null",
        ],
    ),
    (
        "bridge",
        &[
            "fivebar bridge",
            "fivebar bridge --robot my-arm.toml --port /dev/ttyUSB0 --origin 30mm,160mm",
            "fivebar bridge --dialect reprap --listen 127.0.0.1:9001",
        ],
    ),
    (
        "calibrate",
        &[
            "fivebar calibrate --robot my-arm.toml --propose 24 --plate plate.svg",
            "fivebar calibrate --robot my-arm.toml --points touched.csv --out my-arm.toml",
        ],
    ),
    (
        "clearance",
        &[
            "fivebar clearance benchtop --radius 20um,50um",
            "fivebar clearance my-arm.toml my.gcode --joints B,D --radius 50um --out out/worn",
        ],
    ),
    ("clear", &["fivebar clear --port /dev/ttyUSB0"]),
    (
        "commission",
        &[
            "fivebar commission --port simulated --robot benchtop --out commissioning",
            "fivebar commission --port /dev/ttyUSB0 --robot my-arm.toml",
            "fivebar commission --port /dev/ttyUSB0 --robot my-arm.toml --again geometry",
        ],
    ),
    (
        "completions",
        &[
            "fivebar completions bash > ~/.local/share/bash-completion/completions/fivebar",
            "fivebar completions zsh > ~/.zfunc/_fivebar",
            "fivebar completions fish > ~/.config/fish/completions/fivebar.fish",
        ],
    ),
    (
        "design",
        &[
            "fivebar design leg.toml --out out/leg",
            "fivebar design leg.toml --seed 7 --json",
        ],
    ),
    (
        "doctor",
        &[
            "fivebar doctor",
            "fivebar doctor pil flash",
            "fivebar doctor port --json",
        ],
    ),
    (
        "drive",
        &[
            "fivebar drive my.gcode --robot my-arm.toml --port /dev/ttyUSB0 --upload",
            "fivebar drive my.gcode --port /dev/ttyUSB0 --at 2.79,0.35",
        ],
    ),
    (
        "export",
        &[
            "fivebar export mjcf my-arm.toml --out my-arm.xml",
            "fivebar export dot benchtop | dot -Tsvg > benchtop.svg",
        ],
    ),
    (
        "flash",
        &[
            "fivebar flash rp2350_servo.uf2",
            "fivebar flash rp2350_stepper --drive /media/me/RP2350",
        ],
    ),
    (
        "hil",
        &[
            "fivebar hil --port /dev/ttyUSB0",
            "fivebar hil my.gcode --robot my-arm.toml --port /dev/ttyUSB0 --moves 10",
        ],
    ),
    (
        "identify",
        &[
            "fivebar identify --robot my-arm.toml --propose --json",
            "fivebar identify --robot my-arm.toml --log excited.csv --out my-arm.toml",
        ],
    ),
    (
        "linkage",
        &[
            "fivebar linkage",
            "fivebar linkage shaper --out out/shaper",
            "fivebar linkage my-linkage.toml --json",
        ],
    ),
    (
        "man",
        &[
            "fivebar man | man -l -",
            "fivebar man ~/.local/share/man/man1",
        ],
    ),
    (
        "margins",
        &[
            "fivebar margins",
            "fivebar margins my-arm.toml --out out/margins",
            "fivebar margins my-arm.toml --json",
        ],
    ),
    (
        "mobility",
        &[
            "fivebar mobility five-bar",
            "fivebar mobility my-mechanism.toml --out out/mobility",
            "fivebar mobility cases.json --json",
        ],
    ),
    (
        "monitor",
        &[
            "fivebar monitor --raw --port /dev/ttyUSB0",
            "fivebar monitor --port /dev/ttyUSB0",
            "fivebar monitor --port /dev/ttyUSB0 --rate 100 --samples 1000",
        ],
    ),
    (
        "new",
        &[
            "fivebar new my-arm.toml",
            "fivebar new my-arm.toml --defaults",
            "printf 'my arm\\n\\n0.1\\n0.15\\n0.22\\n\\n\\n\\n\\n\\n' | fivebar new my-arm.toml",
        ],
    ),
    (
        "pen",
        &["fivebar pen --robot my-arm.toml --port /dev/ttyUSB0"],
    ),
    (
        "photo",
        &[
            "fivebar photo my.svg --robot my-arm.toml --draw-marks marks.gcode",
            "fivebar photo my.svg photo.jpg --robot my-arm.toml --marks marks.gcode",
            "fivebar photo my.svg scan.png --marks marks.gcode --lens 0 --distances ruler.csv --corrected my.gcode",
        ],
    ),
    (
        "pil",
        &[
            "fivebar pil",
            "fivebar pil my.gcode --robot my-arm.toml --moves 5 --json",
        ],
    ),
    (
        "plan",
        &[
            "fivebar plan --path my-path.json",
            "fivebar plan --robot my-arm.toml --path my-path.json --torque-share 0.7 --json",
            "fivebar plan --robot my-arm.toml --crossing --from 0.06,0.115 --to 0.03,0.012 --time 0.3",
        ],
    ),
    (
        "query",
        &[
            "echo '{\"op\":\"inverse\",\"c\":[0.04,0.2],\"elbow1\":\"right\",\"elbow4\":\"left\"}' | fivebar query",
            "fivebar query --robot my-arm.toml < queries.jsonl",
        ],
    ),
    (
        "replay",
        &[
            "fivebar replay wave.json --robot my-arm.toml --port /dev/ttyUSB0 --speed 0.5",
            "fivebar replay wave.json --out wave.svg",
        ],
    ),
    (
        "robots",
        &["fivebar robots", "fivebar robots benchtop > my-arm.toml"],
    ),
    (
        "ros",
        &[
            "fivebar ros",
            "fivebar ros --robot my-arm.toml --port /dev/ttyUSB0 --domain 7",
        ],
    ),
    (
        "serve",
        &[
            "fivebar serve",
            "fivebar serve --robot my-arm.toml --listen 127.0.0.1:9000",
        ],
    ),
    (
        "settings",
        &[
            "fivebar settings show --port /dev/ttyUSB0",
            "fivebar settings upload --port /dev/ttyUSB0 --robot my-arm.toml",
            "fivebar settings download --port /dev/ttyUSB0 --out as-found.toml",
        ],
    ),
    (
        "sim",
        &[
            "fivebar sim my.gcode --robot my-arm.toml --out out/mine",
            "fivebar sim my.gcode --origin 0.02,0.14 --scale 0.5 --log out/run.mcap",
            "fivebar sim scenario.toml --by-cause --json",
            "fivebar sim my.gcode --repeat 4 --learn",
        ],
    ),
    (
        "teach",
        &[
            "fivebar teach --robot my-arm.toml --port /dev/ttyUSB0 --out wave.json",
            "fivebar teach --hand hand.csv --out wave.json",
        ],
    ),
    (
        "text",
        &[
            "fivebar text Hello --out hello.svg",
            "fivebar text 'Two lines' 'in the middle' --size 8mm --align middle --out two.gcode",
        ],
    ),
    (
        "workspace",
        &[
            "fivebar workspace",
            "fivebar workspace my-arm.toml --out out/reach --resolution 1",
            "fivebar workspace haply --branch left,left --json",
        ],
    ),
];

/// The command line with examples after each command's help.
pub(super) fn with_examples(program: Command) -> Command {
    EXAMPLES.iter().fold(program, |program, (name, lines)| {
        let text = format!("Examples:\n  {}", lines.join("\n  "));
        program.mut_subcommand(*name, |command| command.after_help(text))
    })
}

#[cfg(test)]
mod tests {
    use super::EXAMPLES;
    use crate::cli::command;

    #[test]
    fn every_command_has_examples_and_each_of_them_is_parsed() {
        let program = command();
        for subcommand in program.get_subcommands() {
            let name = subcommand.get_name();
            let found = EXAMPLES.iter().find(|(of, _)| *of == name);
            let (_, lines) = found.unwrap_or_else(|| panic!("`{name}` has no example"));
            for line in *lines {
                let start = line.find("fivebar ").unwrap();
                let words = line[start..].split([' ']);
                let words = words.take_while(|word| !["|", ">", "<"].contains(word));
                let matches = program.clone().try_get_matches_from(words);
                let matches = matches.unwrap_or_else(|error| panic!("{line}\n{error}"));
                assert_eq!(matches.subcommand_name(), Some(name));
            }
        }
    }

    #[test]
    fn the_definition_of_the_command_line_is_consistent() {
        command().debug_assert();
    }
}
