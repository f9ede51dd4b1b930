//! `LIST INFO` chunk of a WAV file: title, comment and software, for programs that show them.
//!
//! Source: Microsoft and IBM, "Multimedia Programming Interface and Data Specifications 1.0", 1991,
//! chapter 2, INFO list chunk.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// Appends the chunk to a finished WAV file. `texts` are identifiers of four letters with their
/// text.
pub(crate) fn append(
    file: &mut (impl Read + Write + Seek),
    texts: &[(&[u8; 4], &str)],
) -> io::Result<()> {
    let mut list = b"INFO".to_vec();
    for (identifier, text) in texts {
        // Ends with a zero; chunks have even lengths.
        let mut content = text.as_bytes().to_vec();
        content.push(0);
        list.extend(*identifier);
        list.extend(length(content.len())?.to_le_bytes());
        if content.len() % 2 == 1 {
            content.push(0);
        }
        list.extend(content);
    }
    let mut chunk = b"LIST".to_vec();
    chunk.extend(length(list.len())?.to_le_bytes());
    chunk.extend(list);

    let mut riff = [0; 4];
    file.seek(SeekFrom::Start(4))?;
    file.read_exact(&mut riff)?;
    let whole = u64::from(u32::from_le_bytes(riff)) + chunk.len() as u64;
    let whole = u32::try_from(whole).map_err(io::Error::other)?;
    file.seek(SeekFrom::End(0))?;
    file.write_all(&chunk)?;
    file.seek(SeekFrom::Start(4))?;
    file.write_all(&whole.to_le_bytes())
}

fn length(bytes: usize) -> io::Result<u32> {
    u32::try_from(bytes).map_err(io::Error::other)
}
