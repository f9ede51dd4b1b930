//! File names in commands that are printed to be pasted.

use std::fmt::Write as _;
use std::path::Path;

/// A path as one word of a shell's command line.
pub(crate) fn word(path: &Path) -> String {
    let bytes = path.as_os_str().as_encoded_bytes();
    // A path with a leading hyphen would be taken for an option.
    let prefix = if bytes.starts_with(b"-") { "./" } else { "" };
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"_./+,:@%=-".contains(byte);
    match path.to_str() {
        Some(text) if !text.is_empty() && bytes.iter().all(is_plain) => format!("{prefix}{text}"),
        Some(text) if !text.chars().any(char::is_control) => {
            format!("'{prefix}{}'", text.replace('\'', r"'\''"))
        }
        // Not to be printed as it is.
        _ => {
            let mut word = format!("$'{prefix}");
            for byte in bytes {
                // Writing to a string does not fail.
                let _ = write!(word, "\\x{byte:02x}");
            }
            word + "'"
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::Command;

    #[test]
    fn a_shell_reads_the_name_back() {
        for name in [
            &b"monday.parquet"[..],
            b"out/demo/recording.1",
            b"two words",
            b"it's \"quoted\" $HOME `x` \\ * ?",
            b"-rf",
            b"- -",
            b"a\nb\x1b[31m",
            b"\xff\xfe latin",
            "Knie rechts ö".as_bytes(),
        ] {
            let word = word(Path::new(OsStr::from_bytes(name)));
            let said = Command::new("bash")
                .args(["-c", &format!("printf %s {word}")])
                .output()
                .expect("a shell");
            let read = said.stdout.strip_prefix(b"./").unwrap_or(&said.stdout);
            assert_eq!(read, name, "{word}");
            assert!(!said.stdout.starts_with(b"-"));
            assert!(!word.chars().any(char::is_control));
        }
    }
}
