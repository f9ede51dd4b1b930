//! Files that are no table of numbers, recognised by their content: what each is, and what to do.

use std::fmt;

/// A file that is no table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the text of each is in Display below")]
pub enum Foreign {
    Gzip,
    OtherArchive,
    Zip,
    Workbook,
    OldWorkbook,
    Matlab,
    Hdf5,
    Pdf,
    Parquet,
    C3d,
    LfsPointer,
    AnnexPointer,
    WebPage,
    Xml,
    Json,
    Markers,
    Quaternions,
    Vectors,
    OtherBinary,
}

impl fmt::Display for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Gzip => "is compressed (gzip); unpack it (gunzip) and name what comes out",
            Self::OtherArchive => "is a compressed archive; unpack it and name the file in it",
            Self::Zip => "is a zip archive; unpack it and name the file in it",
            Self::Workbook => "is a spreadsheet's workbook (.xlsx or .ods); save the sheet as CSV (UTF-8) and name that",
            Self::OldWorkbook => "is a spreadsheet's workbook (.xls); save the sheet as CSV (UTF-8) and name that",
            Self::Matlab | Self::Hdf5 => {
                "is binary data (MATLAB or HDF5); write the columns as CSV, in MATLAB with writetable, and name that"
            }
            Self::Pdf => "is a PDF document; name the table that it was made from",
            Self::Parquet => "is a Parquet file; write it as CSV (pandas: to_csv) and name that",
            Self::C3d => "is a C3D file (markers and forces); compute joint angles from it, and save those as CSV or .mot",
            Self::LfsPointer => {
                "is a pointer of Git LFS, the data are not here; fetch them with `git lfs pull`"
            }
            Self::AnnexPointer => {
                "is a pointer of git-annex, the data are not here; fetch them with `git annex get` (or `datalad get`)"
            }
            Self::WebPage => "is a web page, no table; download the file itself (its \"raw\" link)",
            Self::Xml => "is XML, no table; save the motion as .mot, .sto or CSV",
            Self::Json => "is JSON, no table; write the columns as CSV",
            Self::Markers => {
                "has positions of markers (TRC), which are no joint angles; run inverse kinematics on it (in OpenSim: Tools, \
                 Inverse Kinematics) and name the .mot that this writes"
            }
            Self::Quaternions => {
                "has orientations as quaternions, which are no joint angles; run inverse kinematics on it (in OpenSim: \
                 IMU Inverse Kinematics) and name the .mot that this writes"
            }
            Self::Vectors => {
                "has vectors in its cells, not numbers; name a file with one number in each cell, such as a .mot of angles"
            }
            Self::OtherBinary => "is binary, no text; export the table as CSV (UTF-8) and name that",
        })
    }
}

/// Returns what a file is by its first bytes, unless that may be a table.
pub(super) fn of_bytes(first: &[u8], is_utf_16: bool) -> Option<Foreign> {
    const MAGIC: [(&[u8], Foreign); 13] = [
        (b"\x1f\x8b", Foreign::Gzip),
        (b"BZh", Foreign::OtherArchive),
        (b"\xfd7zXZ", Foreign::OtherArchive),
        (b"7z\xbc\xaf", Foreign::OtherArchive),
        (b"\x28\xb5\x2f\xfd", Foreign::OtherArchive),
        (b"\xd0\xcf\x11\xe0", Foreign::OldWorkbook),
        (b"MATLAB 5.0 MAT-file", Foreign::Matlab),
        (b"\x89HDF", Foreign::Hdf5),
        (b"%PDF", Foreign::Pdf),
        (b"PAR1", Foreign::Parquet),
        (b"\x02\x50", Foreign::C3d),
        (b"/annex/objects/", Foreign::AnnexPointer),
        (b"version https://git-lfs", Foreign::LfsPointer),
    ];
    if first.starts_with(b"PK\x03\x04") {
        let holds = |part: &[u8]| first.windows(part.len()).any(|window| window == part);
        let is_workbook = [
            &b"[Content_Types].xml"[..],
            b"xl/",
            b"opendocument.spreadsheet",
        ];
        return Some(if is_workbook.into_iter().any(holds) {
            Foreign::Workbook
        } else {
            Foreign::Zip
        });
    }
    if let Some((_, foreign)) = MAGIC.iter().find(|(magic, _)| first.starts_with(magic)) {
        return Some(*foreign);
    }
    (!is_utf_16 && first.contains(&0)).then_some(Foreign::OtherBinary)
}

/// Returns what a file is by its first lines, unless that may be a table.
pub(super) fn of_lines<'a>(lines: impl Iterator<Item = &'a str>) -> Option<Foreign> {
    for (at, line) in lines.enumerate() {
        let line = line.trim();
        let lower = line.get(..line.len().min(64)).unwrap_or(line);
        let lower = lower.to_ascii_lowercase();
        let starts = |part: &str| lower.starts_with(part);
        if at == 0 || (at < 8 && starts("<")) {
            if starts("<!doctype html") || starts("<html") {
                return Some(Foreign::WebPage);
            }
            if starts("<opensim") || starts("<svg") {
                return Some(Foreign::Xml);
            }
        }
        if at == 0 {
            if starts("pathfiletype") {
                return Some(Foreign::Markers);
            }
            if line.contains("/annex/objects/") && !line.contains([',', ';', '\t']) {
                return Some(Foreign::AnnexPointer);
            }
            if starts("{") || starts("[{") || starts("[[") || line == "[" {
                return Some(Foreign::Json);
            }
        }
        // In the header of OpenSim's newer tables.
        let lower = lower.replace(' ', "");
        if lower.starts_with("datatype=quaternion") {
            return Some(Foreign::Quaternions);
        }
        if lower.starts_with("datatype=") && !lower.starts_with("datatype=double") {
            return Some(Foreign::Vectors);
        }
        if lower == "endheader" {
            return None;
        }
    }
    None
}
