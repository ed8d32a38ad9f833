//! Completion scripts for shells, and manual pages.

use std::process::{Command, Output};

fn fivebar(arguments: &[&str]) -> Output {
    let mut command = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"));
    command.args(arguments).output().unwrap()
}

fn printed(arguments: &[&str]) -> String {
    let output = fivebar(arguments);
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The commands that `fivebar help` lists.
fn commands() -> Vec<String> {
    let help = printed(&["help"]);
    let listed = help.split("Commands:\n").nth(1).unwrap();
    let listed = listed.lines().take_while(|line| !line.is_empty());
    let name = |line: &str| line.split_whitespace().next().unwrap().to_owned();
    listed
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .map(name)
        .filter(|name| name != "help")
        .collect()
}

#[test]
fn every_shell_completes_every_command() {
    assert!(commands().len() >= 15, "{:?}", commands());
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(&["completions", shell]);
        for command in commands() {
            assert!(
                script.contains(&command),
                "{command} is missing for {shell}"
            );
        }
        assert!(script.contains("origin"), "options are missing for {shell}");
    }
    assert_eq!(fivebar(&["completions", "cmd.exe"]).status.code(), Some(2));
}

/// Bash's completions of the last of these words.
fn offered(words: &[&str]) -> Vec<String> {
    let script = printed(&["completions", "bash"]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fivebar.bash");
    std::fs::write(&file, script).unwrap();
    let ask = format!(
        "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _fivebar fivebar '{}' '{}'; \
         printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        file.display(),
        words.join(" "),
        words.len() - 1,
        words[words.len() - 1],
        words[words.len() - 2],
    );
    let bash = Command::new("bash").args(["--norc", "-c", &ask]).output();
    let output = bash.expect("bash starts");
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn bash_completes_commands_options_and_values() {
    assert_eq!(offered(&["fivebar", "s"]), ["serve", "settings", "sim"]);
    let formats = offered(&["fivebar", "export", "m"]);
    assert!(formats.contains(&"mjcf".to_owned()), "{formats:?}");
    let options = offered(&["fivebar", "sim", "--o"]);
    assert_eq!(options, ["--origin", "--out"]);
}

#[test]
fn every_command_has_a_manual_page_with_its_examples() {
    let folder = tempfile::tempdir().unwrap();
    let message = printed(&["man", folder.path().to_str().unwrap()]);
    let commands = commands();
    assert!(
        message.starts_with(&format!("wrote {} pages", commands.len() + 1)),
        "{message}"
    );
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let program = read("fivebar.1");
    let all = printed(&["man"]);
    for command in commands {
        let page = read(&format!("fivebar-{command}.1"));
        assert!(
            page.contains(".TH ") && page.contains("Examples:"),
            "{page}"
        );
        assert!(
            program.contains(&format!("fivebar\\-{}(1)", command.replace('-', "\\-"))),
            "{command}"
        );
        assert!(all.contains(&page));
    }
    assert!(all.starts_with(&program));
}
