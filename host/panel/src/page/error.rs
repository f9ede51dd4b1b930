//! Errors of the assembler: mistakes in the files of the page, which a test finds.

/// Mistake in a file of the page.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PageError {
    /// A form of import or export that the assembler does not know.
    #[error(
        "{file}: `{line}`: expected `import {{ a, b as c }} from \"./x.js\";`, or `export` before \
         a `const` with one name, a `function` or a `class`"
    )]
    Form {
        /// The module.
        file: String,
        /// The line.
        line: String,
    },
    /// A module that is not in the program.
    #[error("{file} imports {import}, which is not in the program")]
    Missing {
        /// The module.
        file: String,
        /// Module that it imports.
        import: String,
    },
    /// A name that the other module does not export.
    #[error("{file} imports {name} of {import}, which does not export it")]
    NotExported {
        /// The module.
        file: String,
        /// Module that it imports.
        import: String,
        /// The name.
        name: String,
    },
    /// Modules that import each other.
    #[error("{file} imports itself by others")]
    Circle {
        /// The module.
        file: String,
    },
    /// A text that would end a script or a style sheet.
    #[error("{file} has `{text}`, which ends a script or a style sheet inside a page")]
    Ends {
        /// The file.
        file: String,
        /// The text.
        text: String,
    },
    /// A template without one of its places.
    #[error("the template has no place for {0}")]
    NoPlace(&'static str),
    /// A language without texts.
    #[error("there are no texts in `{0}`")]
    NoLanguage(String),
}
