//! Edits of a built image: bytes that are replaced wherever they are.

/// Bytes, and those that replace them.
#[derive(Clone, Debug)]
pub struct ImageEdit {
    pattern: Vec<Masked>,
    with: Vec<u8>,
}

/// A byte, of which digits may be free.
#[derive(Clone, Debug)]
struct Masked {
    value: u8,
    mask: u8,
}

impl ImageEdit {
    /// Edit of a text such as `8? f3 12 88 -> af f3 00 80`, in which `?` is any digit. `None`
    /// if these are no pairs of hexadecimal digits, or not as many on both sides.
    pub fn parse(text: &str) -> Option<Self> {
        let (pattern, with) = text.split_once("->")?;
        let (pattern, with) = (digits(pattern)?, digits(with)?);
        let is_whole = with.iter().all(|byte| byte.mask == u8::MAX);
        let with: Vec<u8> = with.iter().map(|byte| byte.value).collect();
        let is_edit = is_whole && !pattern.is_empty() && pattern.len() == with.len();
        is_edit.then_some(Self { pattern, with })
    }

    /// Replaces the bytes, and returns in how many places.
    pub fn apply(&self, image: &mut [u8]) -> usize {
        let (mut at, mut found) = (0, 0);
        while let Some(window) = image.get_mut(at..at + self.pattern.len()) {
            let is_it = (self.pattern.iter())
                .zip(&*window)
                .all(|(byte, is)| is & byte.mask == byte.value);
            if is_it {
                window.copy_from_slice(&self.with);
                found += 1;
            }
            // Instructions are halves of words.
            at += 2;
        }
        found
    }
}

fn digits(text: &str) -> Option<Vec<Masked>> {
    let pairs: Vec<char> = text
        .chars()
        .filter(|digit| !digit.is_whitespace())
        .collect();
    let digit = |digit: char| match digit {
        '?' => Some((0, 0)),
        _ => Some((u8::try_from(digit.to_digit(16)?).ok()?, 15)),
    };
    let bytes = pairs.chunks(2).map(|pair| {
        let [high, low] = pair else { return None };
        let ((high, high_mask), (low, low_mask)) = (digit(*high)?, digit(*low)?);
        Some(Masked {
            value: high << 4 | low,
            mask: high_mask << 4 | low_mask,
        })
    });
    bytes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_replaced_wherever_they_are() {
        let edit = ImageEdit::parse("8? f3 12 88 -> af f3 00 80").unwrap();
        let mut image = [0, 0, 0x81, 0xf3, 0x12, 0x88, 0x82, 0xf3, 0x12, 0x88];
        assert_eq!(edit.apply(&mut image), 2);
        assert_eq!(image, [0, 0, 0xaf, 0xf3, 0, 0x80, 0xaf, 0xf3, 0, 0x80]);
        assert_eq!(edit.apply(&mut image), 0);
    }

    #[test]
    fn what_is_no_edit_is_none() {
        for text in ["80", "8 -> 9", "zz -> 80", "80 -> 8?", "80 -> ", "->"] {
            assert!(ImageEdit::parse(text).is_none(), "{text}");
        }
    }
}
