//! Messages as tables: number, name, encoding, meaning.

use crate::walk::is_fixed;
use postcard_schema::schema::{DataModelType as Type, DataModelVariant as Content, NamedType};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Tables of a message and of every type in it that has none yet.
pub(crate) struct Tables {
    meanings: BTreeMap<String, String>,
    done: Vec<String>,
}

impl Tables {
    pub(crate) fn new() -> Self {
        Self {
            meanings: crate::source::meanings(),
            done: Vec::new(),
        }
    }

    /// The message's table, then those of what it is made of.
    pub(crate) fn of(&mut self, ty: &'static NamedType) -> String {
        let mut text = String::new();
        let mut queue = vec![ty];
        while !queue.is_empty() {
            let ty = queue.remove(0);
            if !self.done.iter().any(|name| name == ty.name) {
                self.done.push(ty.name.to_owned());
                self.table(ty, &mut text, &mut queue);
            }
        }
        text
    }

    fn meaning(&self, name: &str) -> String {
        let meaning = self.meanings.get(name);
        meaning
            .unwrap_or_else(|| panic!("no comment of {name}"))
            .replace('|', "\\|")
    }

    fn table(&self, ty: &NamedType, text: &mut String, queue: &mut Vec<&'static NamedType>) {
        let name = ty.name;
        match ty.ty {
            Type::Struct(fields) => {
                let _ = writeln!(text, "\n**{name}**: {}\n", self.meaning(name));
                text.push_str("| field | encoding | meaning |\n|---|---|---|\n");
                for field in *fields {
                    let place = format!("{name}.{}", field.name);
                    let _ = writeln!(
                        text,
                        "| `{}` | {} | {} |",
                        field.name,
                        encoding(field.ty, is_fixed(&place)),
                        self.meaning(&place)
                    );
                    enqueue(field.ty, queue);
                }
            }
            Type::Enum(variants) => {
                let _ = writeln!(text, "\n**{name}**: {}\n", self.meaning(name));
                text.push_str("| number | variant | followed by | meaning |\n|---|---|---|---|\n");
                for (number, variant) in variants.iter().enumerate() {
                    let place = format!("{name}.{}", variant.name);
                    let _ = writeln!(
                        text,
                        "| {number} | `{}` | {} | {} |",
                        variant.name,
                        followed_by(variant.ty, queue),
                        self.meaning(&place)
                    );
                }
            }
            _ => {}
        }
    }
}

fn followed_by(content: &'static Content, queue: &mut Vec<&'static NamedType>) -> String {
    match content {
        Content::UnitVariant => "–".to_owned(),
        Content::NewtypeVariant(ty) => {
            enqueue(ty, queue);
            encoding(ty, false)
        }
        Content::TupleVariant(all) => list(all.iter().map(|ty| {
            enqueue(ty, queue);
            encoding(ty, false)
        })),
        Content::StructVariant(fields) => list(fields.iter().map(|field| {
            enqueue(field.ty, queue);
            format!("`{}` {}", field.name, encoding(field.ty, false))
        })),
    }
}

fn list(all: impl Iterator<Item = String>) -> String {
    all.collect::<Vec<_>>().join(", ")
}

/// Puts what has a table of its own into the queue.
fn enqueue(ty: &'static NamedType, queue: &mut Vec<&'static NamedType>) {
    match ty.ty {
        Type::Enum(variants) if ty.name.starts_with("Result") => {
            for variant in *variants {
                let _ = followed_by(variant.ty, queue);
            }
        }
        Type::Struct(_) | Type::Enum(_) => queue.push(ty),
        Type::Option(inner) | Type::NewtypeStruct(inner) => enqueue(inner, queue),
        Type::Tuple(all) => {
            for inner in *all {
                enqueue(inner, queue);
            }
        }
        _ => {}
    }
}

/// Encoding of a type, in the words of the page.
fn encoding(ty: &NamedType, fixed: bool) -> String {
    let number = |name: &str| {
        if fixed {
            format!("{name}, fixed")
        } else {
            format!("{name}, varint")
        }
    };
    match ty.ty {
        Type::U16 => number("u16"),
        Type::U32 => number("u32"),
        Type::U64 => number("u64"),
        Type::I16 => number("i16"),
        Type::I32 => number("i32"),
        Type::Unit => "nothing".to_owned(),
        Type::Option(inner) => format!("option of {}", encoding(inner, false)),
        Type::NewtypeStruct(inner) => {
            let inner = encoding(inner, is_fixed(ty.name));
            format!("{}: {inner}", ty.name)
        }
        Type::Tuple(all) => {
            let mut names: Vec<_> = all.iter().map(|ty| encoding(ty, false)).collect();
            names.dedup();
            match names.as_slice() {
                [one] => format!("{} × {one}", all.len()),
                several => several.join(", then "),
            }
        }
        Type::Enum(variants) if ty.name.starts_with("Result") => {
            let [ok, error] = variants else {
                panic!("a result has two sides");
            };
            let side = |content: &'static Content| followed_by(content, &mut Vec::new());
            format!("result: {} or {}", side(ok.ty), side(error.ty))
        }
        _ => ty.name.to_owned(),
    }
}
