//! The faults: `faults.toml`, and how they are planted.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The list that is in the repository.
const LIST: &str = include_str!("../../faults/faults.toml");

/// Marks of the expression that a fault replaces.
const MARKS: [char; 2] = ['«', '»'];

/// A fault of the model.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// Name on the command line.
    pub name: String,
    /// Description of the fault, in one line.
    pub what: String,
    /// The file to plant it in, from the root of the repository.
    pub file: String,
    /// A text that occurs once in the file; the expression between its marks
    /// is replaced.
    pub text: String,
    /// The replacement.
    pub with: String,
    /// Reason why the hard cases cannot detect it, if they cannot.
    #[serde(default)]
    pub unseen_by_cases: Option<String>,
    /// Reason why the model's tests cannot detect it, if they cannot.
    #[serde(default)]
    pub unseen_by_tests: Option<String>,
}

/// Reason why a list or a fault cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FaultError {
    /// The list is invalid.
    #[error("faults.toml: {0}")]
    List(#[from] toml::de::Error),
    /// No expression is marked.
    #[error("fault `{0}`: its text has no expression between « and »")]
    Marks(String),
    /// The text does not occur in its file exactly once.
    #[error(
        "fault `{name}`: its text stands {found} times in {file}, expected once; the source has changed, so \
         change the fault in tools/faults/faults.toml"
    )]
    Text {
        /// The fault.
        name: String,
        /// The file.
        file: String,
        /// Number of occurrences.
        found: usize,
    },
    /// Two faults replace parts of one expression.
    #[error(
        "faults `{0}` and `{1}` overlap: both must replace the same expression, or different ones"
    )]
    Overlap(String, String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    fault: Vec<Fault>,
}

/// All faults, in the order of the list.
///
/// # Errors
/// [`FaultError::List`] if the list cannot be read.
pub fn all() -> Result<Vec<Fault>, FaultError> {
    Ok(toml::from_str::<List>(LIST)?.fault)
}

impl Fault {
    /// Range of the replaced expression in a source, in bytes.
    ///
    /// # Errors
    /// [`FaultError::Text`] unless its text occurs in the source exactly once.
    pub fn place(&self, source: &str) -> Result<(usize, usize), FaultError> {
        let parts: Vec<&str> = self.text.split(MARKS).collect();
        let [before, expression, after] = parts[..] else {
            return Err(FaultError::Marks(self.name.clone()));
        };
        let text = [before, expression, after].concat();
        let found = source.matches(&text).count();
        match source.find(&text) {
            Some(start) if found == 1 => {
                let start = start + before.len();
                Ok((start, start + expression.len()))
            }
            _ => Err(FaultError::Text {
                name: self.name.clone(),
                file: self.file.clone(),
                found,
            }),
        }
    }
}

/// A source with faults in it, each behind a switch: fault `n`, counted from 1,
/// is in force where `crate::planted::is(n)`.
///
/// # Errors
/// [`FaultError`] if one does not apply, or two overlap.
pub fn plant(source: &str, faults: &[(usize, &Fault)]) -> Result<String, FaultError> {
    let mut places: BTreeMap<(usize, usize), Vec<(usize, &Fault)>> = BTreeMap::new();
    for &(number, fault) in faults {
        let place = fault.place(source)?;
        places.entry(place).or_default().push((number, fault));
    }
    let (mut text, mut done) = (String::new(), 0);
    let mut last: Option<&Fault> = None;
    for ((start, end), here) in places {
        if let (Some(last), Some((_, fault))) = (last, here.first())
            && start < done
        {
            return Err(FaultError::Overlap(last.name.clone(), fault.name.clone()));
        }
        text.push_str(&source[done..start]);
        text.push('(');
        for (number, fault) in &here {
            // Writing to a String cannot fail.
            let _ = write!(
                text,
                "if crate::planted::is({number}) {{ {} }} else ",
                fault.with
            );
        }
        let _ = write!(text, "{{ {} }})", &source[start..end]);
        done = end;
        last = here.last().map(|(_, fault)| *fault);
    }
    text.push_str(&source[done..]);
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(name: &str, text: &str, with: &str) -> Fault {
        Fault {
            name: name.to_owned(),
            what: "the torque's sign".to_owned(),
            file: "model/src/lib.rs".to_owned(),
            text: text.to_owned(),
            with: with.to_owned(),
            unseen_by_cases: None,
            unseen_by_tests: None,
        }
    }

    #[test]
    fn an_expression_is_replaced_where_its_text_stands_once() {
        let sign = fault("sign", "a = «x»;", "-x");
        let zero = fault("zero", "a = «x»;", "0");
        let other = fault("other", "b = «y»", "x");
        let planted = plant("a = x; b = y;", &[(1, &sign), (2, &zero), (3, &other)]).unwrap();
        assert_eq!(
            planted,
            "a = (if crate::planted::is(1) { -x } else if crate::planted::is(2) { 0 } else { x }); \
             b = (if crate::planted::is(3) { x } else { y });"
        );
        for (source, times) in [("b = x;", 0), ("a = x; a = x;", 2)] {
            let error = plant(source, &[(1, &sign)]).unwrap_err();
            assert!(matches!(error, FaultError::Text { found, .. } if found == times));
            assert!(error.to_string().contains("`sign`") && error.to_string().contains("lib.rs"));
        }
        let wide = fault("wide", "«a = x»", "()");
        let error = plant("a = x;", &[(1, &sign), (2, &wide)]).unwrap_err();
        assert!(matches!(error, FaultError::Overlap(..)), "{error}");
        let error = plant("a", &[(1, &fault("bare", "a", "b"))]).unwrap_err();
        assert!(matches!(error, FaultError::Marks(_)), "{error}");
    }
}
