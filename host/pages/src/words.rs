//! Words that all pages and screens have in common.

/// Columns of a terminal that text fills.
pub const WIDTH: usize = 100;

/// The last line of every report.
pub fn footer() -> String {
    format!(
        "crepitus {} · research and education prototype, not a medical device",
        env!("CARGO_PKG_VERSION")
    )
}

/// The words of a paragraph in lines of at most `width` columns; a longer word has a line of its own.
pub fn wrapped(paragraph: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in paragraph.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let length = line.chars().count();
            if length == 0 {
                line.push_str(word);
            } else if length + 1 + word.chars().count() <= width {
                line.push(' ');
                line.push_str(word);
            } else {
                lines.push(word.to_owned());
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_lose_no_word() {
        let words = "ωn·h ".repeat(60);
        let lines = wrapped(&words, 80);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| line.chars().count() <= 80));
        assert_eq!(lines.join(" "), words.trim_end());
        assert_eq!(wrapped("", 80), [""]);
    }
}
