//! Queries about a mechanism: one JSON object per line, each answered by one line.
//!
//! [`five_bar`] and [`slider`] define the queries of the two mechanisms. This module reads
//! the lines, writes the answers and makes the checks that both need.

pub mod five_bar;
pub mod slider;

use fivebar_files::did_you_mean;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt;
use std::io::{self, BufRead, Write};

/// The kind of an error, for scripts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum QueryErrorKind {
    /// No pose exists there.
    Unreachable,
    /// The answer is not unique or not finite there.
    Singular,
    /// The query is not valid.
    Invalid,
}

/// Why a query has no answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct QueryError {
    /// Its kind.
    pub error: QueryErrorKind,
    /// The reason, in a sentence.
    pub message: String,
}

impl QueryError {
    /// The query is not valid, for this reason.
    pub fn invalid(reason: impl fmt::Display) -> Self {
        Self {
            error: QueryErrorKind::Invalid,
            message: reason.to_string(),
        }
    }
}

/// Answers every line of `input` on `output` as soon as it is read, until one of them ends. A
/// query without an answer gets an error on its line, and the next line is read. `keys` are all that a query may have.
///
/// # Errors
/// Reading or writing fails. A closed `output` is no error.
pub fn serve<Query: DeserializeOwned>(
    mut input: impl BufRead,
    mut output: impl Write,
    keys: &[&str],
    answer: impl Fn(Query) -> Result<Value, QueryError>,
) -> io::Result<()> {
    let mut line = Vec::new();
    while input.read_until(b'\n', &mut line)? > 0 {
        let reply = parse(&line, keys)
            .and_then(&answer)
            .and_then(finite)
            .unwrap_or_else(|refusal| serde_json::json!(refusal));
        let written = writeln!(output, "{reply}").and_then(|()| output.flush());
        match written {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
            other => other?,
        }
        line.clear();
    }
    Ok(())
}

/// The query on a line.
fn parse<Query: DeserializeOwned>(line: &[u8], keys: &[&str]) -> Result<Query, QueryError> {
    if let Ok(Value::Object(fields)) = serde_json::from_slice(line)
        && let Some(unknown) = fields.keys().find(|key| !keys.contains(&key.as_str()))
    {
        let meant = did_you_mean(unknown, keys.iter().copied());
        return Err(QueryError::invalid(format_args!(
            "unknown key `{unknown}`{meant}"
        )));
    }
    let read = serde_json::from_slice(line);
    // The reader takes a list for an object without its keys.
    if read.is_ok() && line.trim_ascii_start().starts_with(b"[") {
        return Err(QueryError::invalid(no_object("a list")));
    }
    read.map_err(|error| QueryError::invalid(sentence(line, &error)))
}

fn no_object(given: &str) -> String {
    format!("a query is a JSON object with an \"op\", not {given}")
}

/// Why a line is no query. The reader's line number, which is always 1, is left out.
fn sentence(line: &[u8], error: &serde_json::Error) -> String {
    let given = match serde_json::from_slice(line) {
        Ok(Value::Null) => Some("null"),
        Ok(Value::Bool(_)) => Some("true or false"),
        Ok(Value::Number(_)) => Some("a number"),
        Ok(Value::String(_)) => Some("a string"),
        Ok(Value::Array(_)) => Some("a list"),
        Ok(Value::Object(_)) | Err(_) => None,
    };
    if let Some(given) = given {
        return no_object(given);
    }
    let text = error
        .to_string()
        .replace("expected f64", "expected a number")
        .replace("variant identifier", "one of the names it can be");
    let reason = text.split(" at line ").next().unwrap_or(&text);
    if error.is_eof() {
        format!("the line is not one complete JSON object: {reason}")
    } else {
        reason.to_owned()
    }
}

/// The answer, if all its numbers are finite: JSON writes any other number as null.
fn finite(answer: Value) -> Result<Value, QueryError> {
    fn holds_null(value: &Value) -> bool {
        match value {
            Value::Null => true,
            Value::Array(items) => items.iter().any(holds_null),
            Value::Object(fields) => fields.values().any(holds_null),
            Value::Bool(_) | Value::Number(_) | Value::String(_) => false,
        }
    }
    if holds_null(&answer) {
        Err(QueryError::invalid(
            "the given numbers are too large: the answer is not finite",
        ))
    } else {
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(input: &[u8]) -> Vec<Value> {
        let mut output = Vec::new();
        serve(input, &mut output, &[], |number: f64| {
            Ok(serde_json::json!({ "twice": 2.0 * number }))
        })
        .unwrap();
        output
            .split(|&byte| byte == b'\n')
            .filter(|line| !line.is_empty())
            .map(|line| serde_json::from_slice(line).unwrap())
            .collect()
    }

    #[test]
    fn every_line_gets_one_answer_in_order_whatever_its_content() {
        let answers = lines(b"1\n\nnot json\n\xff\xfe\n1e400\n1e308\nNaN\n{}\n2");
        assert_eq!(answers.len(), 9);
        assert_eq!(answers[0]["twice"], 2.0);
        for refused in &answers[1..8] {
            assert_eq!(refused["error"], "invalid", "{refused}");
            assert!(!refused["message"].as_str().unwrap().is_empty());
        }
        assert_eq!(answers[8]["twice"], 4.0);
    }

    #[test]
    fn json_that_is_no_object_is_refused_by_its_kind() {
        let mut output = Vec::new();
        let answer = |_: std::collections::BTreeMap<String, f64>| Ok(Value::Bool(true));
        serve(
            &b"[1]\n\"forward\"\n7\nnull\n{}\n"[..],
            &mut output,
            &[],
            answer,
        )
        .unwrap();
        let text = String::from_utf8(output).unwrap();
        for (line, given) in text.lines().zip(["a list", "a string", "a number", "null"]) {
            assert!(line.contains("a query is a JSON object") && line.contains(given));
        }
        assert_eq!(text.lines().last(), Some("true"));
    }

    #[test]
    fn a_closed_output_ends_the_run_without_error() {
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let answer = |number: f64| Ok(serde_json::json!(number));
        assert!(serve(&b"1\n2\n"[..], Closed, &[], answer).is_ok());
    }
}
