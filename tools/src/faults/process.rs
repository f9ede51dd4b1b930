//! Programs that may hang or crash: a planted fault can do both.

use std::fs::File;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// End of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Exit code 0.
    Success,
    /// Another exit code, or a signal.
    Failure,
    /// The program was killed after its timeout.
    Timeout,
}

/// Runs a program with its output in a file, for `most` at the longest.
///
/// # Errors
/// If it cannot be started.
pub fn run(command: &mut Command, output: &Path, most: Duration) -> io::Result<End> {
    let file = File::create(output)?;
    command.stdin(Stdio::null());
    command.stdout(file.try_clone()?).stderr(file);
    let mut child = command.spawn()?;
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(if status.success() {
                End::Success
            } else {
                End::Failure
            });
        }
        if begun.elapsed() > most {
            child.kill()?;
            child.wait()?;
            return Ok(End::Timeout);
        }
        sleep(Duration::from_millis(20));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_told_apart() {
        let folder = std::env::temp_dir().join(format!("crepitus-faults-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let shell = |script: &str| {
            let most = Duration::from_millis(500);
            let mut command = Command::new("sh");
            run(command.args(["-c", script]), &folder.join("out"), most).unwrap()
        };
        assert_eq!(shell("echo said"), End::Success);
        assert_eq!(
            std::fs::read_to_string(folder.join("out")).unwrap(),
            "said\n"
        );
        assert_eq!(shell("exit 3"), End::Failure);
        assert_eq!(shell("exec sleep 20"), End::Timeout);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
