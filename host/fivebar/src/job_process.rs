//! Jobs are read in a process of their own, whose memory and processor time are limited.
//!
//! The process that serves the page also stops the arm, and a file comes from anywhere. A library that asks for
//! more memory than there is ends its process, and so does a stack that overflows; no thread can catch either. So
//! the program runs itself once more with [`COMMAND`]: it gets the placement, the options and the text at its
//! standard input, and answers with the job, or with the sentence that refuses it. Its limits are set on Linux;
//! elsewhere it only keeps a crash away.

use fivebar_files::job::{Job, JobError, JobOptions, JobReader, Placement};
use std::io::{self, Read as _, Write as _};
use std::path::PathBuf;
use std::process::{Command, ExitCode, ExitStatus, Stdio};

/// The argument with which the program only reads a job.
pub(crate) const COMMAND: &str = "read-job-apart";

/// Most memory of the process [bytes].
#[cfg(target_os = "linux")]
const MEMORY: u64 = 1 << 30;
/// Most time of the processor [s]. A build without optimisation is ten times slower.
#[cfg(target_os = "linux")]
const SECONDS: u64 = if cfg!(debug_assertions) { 50 } else { 5 };
/// Greatest length of its answer [bytes]: a million steps have 80 MB.
const LONGEST_ANSWER: u64 = 256 << 20;

/// Reads jobs in a process of its own.
pub(crate) const APART: JobReader = JobReader(read);

fn read(text: &str, placement: &Placement, options: &JobOptions) -> Result<Job, JobError> {
    let answer = ask(text, placement, options);
    answer
        .unwrap_or_else(|error| Err(format!("the job cannot be read: {error}")))
        .map_err(JobError::Refused)
}

fn ask(text: &str, placement: &Placement, options: &JobOptions) -> io::Result<Result<Job, String>> {
    let mut child = Command::new(program()?)
        .arg(COMMAND)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let header = postcard::to_extend(&(placement, options), Vec::new());
    let header = header.map_err(io::Error::other)?;
    if let Some(mut input) = child.stdin.take() {
        // It answers when it has read all. If it has ended before, its status says why.
        let length = (header.len() as u32).to_le_bytes();
        let parts = [&length[..], &header, text.as_bytes()];
        let _ = parts.iter().try_for_each(|part| input.write_all(part));
    }
    let mut answer = Vec::new();
    if let Some(output) = child.stdout.take() {
        output.take(LONGEST_ANSWER).read_to_end(&mut answer)?;
    }
    let status = child.wait()?;
    if !status.success() {
        return Ok(Err(why_it_ended(status)));
    }
    postcard::from_bytes(&answer).map_err(io::Error::other)
}

/// This program, also if its file was replaced meanwhile.
fn program() -> io::Result<PathBuf> {
    if cfg!(target_os = "linux") {
        return Ok("/proc/self/exe".into());
    }
    std::env::current_exe()
}

fn why_it_ended(status: ExitStatus) -> String {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::process::ExitStatusExt as _;
        match status.signal() {
            Some(9 | 24) => {
                return format!(
                    "reading it takes more than {SECONDS} s of the processor: simplify it, or draw it in parts"
                );
            }
            Some(6) => {
                return format!(
                    "reading it takes more than {} MiB of memory: simplify it, or draw it in parts",
                    MEMORY >> 20
                );
            }
            _ => {}
        }
    }
    format!("its reader failed ({status}): save it once more by another program, or as a plain SVG")
}

/// Reads the job at the standard input.
pub(crate) fn main() -> ExitCode {
    match answer() {
        Ok(()) => ExitCode::SUCCESS,
        Err(_) => ExitCode::FAILURE,
    }
}

fn answer() -> io::Result<()> {
    limit()?;
    let mut input = io::stdin().lock();
    let mut length = [0; 4];
    input.read_exact(&mut length)?;
    let mut header = vec![0; u32::from_le_bytes(length) as usize];
    input.read_exact(&mut header)?;
    let mut text = String::new();
    input.read_to_string(&mut text)?;
    let header = postcard::from_bytes(&header).map_err(io::Error::other)?;
    let (placement, options): (Placement, JobOptions) = header;
    let job = Job::parse_with(&text, &placement, &options);
    let job = job.map_err(|error| error.to_string());
    drop(text);
    let answer = postcard::to_extend(&job, Vec::new()).map_err(io::Error::other)?;
    io::stdout().lock().write_all(&answer)
}

#[cfg(target_os = "linux")]
fn limit() -> io::Result<()> {
    use nix::sys::resource::{Resource, setrlimit};
    for (resource, most) in [
        (Resource::RLIMIT_AS, MEMORY),
        (Resource::RLIMIT_CPU, SECONDS),
        // Without an image of the memory on the disk.
        (Resource::RLIMIT_CORE, 0),
    ] {
        setrlimit(resource, most, most)?;
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn limit() -> io::Result<()> {
    Ok(())
}
