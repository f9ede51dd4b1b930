//! Reads a message by its schema alone, with nothing but the rules that
//! `docs/protocol.md` gives: so the rules are enough, and we know which
//! variants a message holds.

use postcard_schema::schema::{DataModelType as Type, DataModelVariant as Content, NamedType};
use std::collections::BTreeSet;

/// Fields that are of fixed width, little endian, although their type is not:
/// the schema does not say so.
const FIXED: [&str; 5] = [
    "Sample.count",
    "Sample.current_ma",
    "SampleFlags",
    "EffectPhases",
    "CoilCurrent",
];

/// Returns whether this field, or this type, is of fixed width.
pub(crate) fn is_fixed(name: &str) -> bool {
    FIXED.contains(&name)
}

/// Some bytes of a message, and their meaning.
pub(crate) struct Piece {
    pub(crate) path: String,
    pub(crate) bytes: Vec<u8>,
    pub(crate) value: String,
}

/// A choice of a message: the place where it stands or the type of it, and
/// what was chosen.
pub(crate) type Choice = (String, String);

/// A message, read.
#[derive(Default)]
pub(crate) struct Reading {
    pub(crate) pieces: Vec<Piece>,
    pub(crate) choices: BTreeSet<Choice>,
}

/// Reads a message of this type, and nothing after it.
pub(crate) fn read(ty: &NamedType, bytes: &[u8]) -> Reading {
    let mut walker = Walker {
        rest: bytes,
        reading: Reading::default(),
    };
    walker.value(ty, ty.name, false);
    assert!(walker.rest.is_empty(), "bytes are left of a {}", ty.name);
    walker.reading
}

/// All that can be chosen in messages of this type.
pub(crate) fn choices(ty: &NamedType) -> BTreeSet<Choice> {
    let mut found = BTreeSet::new();
    collect(ty, ty.name, &mut found);
    found
}

fn collect(ty: &NamedType, path: &str, found: &mut BTreeSet<Choice>) {
    match ty.ty {
        Type::Option(inner) => {
            for choice in ["none", "some"] {
                found.insert((path.to_owned(), choice.to_owned()));
            }
            collect(inner, path, found);
        }
        Type::NewtypeStruct(inner) => collect(inner, path, found),
        Type::Tuple(all) | Type::TupleStruct(all) => {
            for (i, inner) in all.iter().enumerate() {
                collect(inner, &format!("{path}.{i}"), found);
            }
        }
        Type::Struct(fields) => {
            for field in *fields {
                collect(field.ty, &format!("{}.{}", ty.name, field.name), found);
            }
        }
        Type::Enum(variants) => {
            let place = place(ty, path);
            for variant in *variants {
                found.insert((place.clone(), variant.name.to_owned()));
                let path = format!("{place}.{}", variant.name);
                match variant.ty {
                    Content::UnitVariant => {}
                    Content::NewtypeVariant(inner) => collect(inner, &path, found),
                    Content::TupleVariant(all) => {
                        for inner in *all {
                            collect(inner, &path, found);
                        }
                    }
                    Content::StructVariant(fields) => {
                        for field in *fields {
                            collect(field.ty, &format!("{path}.{}", field.name), found);
                        }
                    }
                }
            }
        }
        _ => {}
    }
}

/// Identifier of an enumeration: its name; a result's has none of its own.
fn place(ty: &NamedType, path: &str) -> String {
    let name = ty.name;
    if name.starts_with("Result") {
        path.to_owned()
    } else {
        name.to_owned()
    }
}

struct Walker<'a> {
    rest: &'a [u8],
    reading: Reading,
}

impl Walker<'_> {
    fn take(&mut self, count: usize) -> Vec<u8> {
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        taken.to_vec()
    }

    fn say(&mut self, path: &str, bytes: Vec<u8>, value: String) {
        self.reading.pieces.push(Piece {
            path: path.to_owned(),
            bytes,
            value,
        });
    }

    /// Seven bits a byte, the lowest first; the eighth says that more follow.
    fn varint(&mut self) -> (Vec<u8>, u64) {
        let length = self.rest.iter().take_while(|b| **b >= 0x80).count() + 1;
        let bytes = self.take(length);
        let value = bytes
            .iter()
            .rev()
            .fold(0, |value, byte| value << 7 | u64::from(byte & 0x7f));
        (bytes, value)
    }

    fn unsigned(&mut self, path: &str, width: usize, fixed: bool) {
        let (bytes, value) = if fixed {
            let bytes = self.take(width);
            let value = little_endian(&bytes);
            (bytes, value)
        } else {
            self.varint()
        };
        self.say(path, bytes, value.to_string());
    }

    /// Zigzag: 0, −1, 1, −2, … are 0, 1, 2, 3, …
    fn signed(&mut self, path: &str, width: usize, fixed: bool) {
        let (bytes, value) = if fixed {
            let bytes = self.take(width);
            let unused = 64 - 8 * u32::try_from(width).unwrap();
            let value = (little_endian(&bytes) << unused).cast_signed() >> unused;
            (bytes, value)
        } else {
            let (bytes, n) = self.varint();
            (bytes, (n >> 1).cast_signed() ^ -(n & 1).cast_signed())
        };
        self.say(path, bytes, value.to_string());
    }

    fn value(&mut self, ty: &NamedType, path: &str, fixed: bool) {
        match ty.ty {
            Type::Bool => {
                let bytes = self.take(1);
                let value = (bytes == [1]).to_string();
                self.say(path, bytes, value);
            }
            Type::U8 => self.unsigned(path, 1, true),
            Type::U16 => self.unsigned(path, 2, fixed),
            Type::U32 => self.unsigned(path, 4, fixed),
            Type::U64 => self.unsigned(path, 8, fixed),
            Type::I16 => self.signed(path, 2, fixed),
            Type::I32 => self.signed(path, 4, fixed),
            Type::F32 => {
                let bytes = self.take(4);
                let value = f32::from_le_bytes(bytes[..].try_into().unwrap());
                self.say(path, bytes, value.to_string());
            }
            Type::F64 => {
                let bytes = self.take(8);
                let value = f64::from_le_bytes(bytes[..].try_into().unwrap());
                self.say(path, bytes, value.to_string());
            }
            Type::Unit => {}
            Type::Option(inner) => {
                let bytes = self.take(1);
                let choice = if bytes == [0] { "none" } else { "some" };
                self.say(path, bytes, choice.to_owned());
                self.choose(path.to_owned(), choice);
                if choice == "some" {
                    self.value(inner, path, false);
                }
            }
            Type::NewtypeStruct(inner) => self.value(inner, path, is_fixed(ty.name)),
            Type::Tuple(all) | Type::TupleStruct(all) => {
                for (i, inner) in all.iter().enumerate() {
                    self.value(inner, &format!("{path}.{i}"), false);
                }
            }
            Type::Struct(fields) => {
                for field in *fields {
                    let path = format!("{}.{}", ty.name, field.name);
                    self.value(field.ty, &path, is_fixed(&path));
                }
            }
            Type::Enum(_) => self.variant(ty, path),
            other => panic!("no message has a {other:?}: add its rule here and to the page"),
        }
    }

    fn variant(&mut self, ty: &NamedType, path: &str) {
        let Type::Enum(variants) = ty.ty else { return };
        let (bytes, number) = self.varint();
        let variant = variants[usize::try_from(number).unwrap()];
        let place = place(ty, path);
        self.say(path, bytes, format!("{number}: {}", variant.name));
        self.choose(place.clone(), variant.name);
        let path = format!("{place}.{}", variant.name);
        match variant.ty {
            Content::UnitVariant => {}
            Content::NewtypeVariant(inner) => self.value(inner, &path, false),
            Content::TupleVariant(all) => {
                for inner in *all {
                    self.value(inner, &path, false);
                }
            }
            Content::StructVariant(fields) => {
                for field in *fields {
                    self.value(field.ty, &format!("{path}.{}", field.name), false);
                }
            }
        }
    }

    fn choose(&mut self, place: String, choice: &str) {
        self.reading.choices.insert((place, choice.to_owned()));
    }
}

fn little_endian(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .rev()
        .fold(0, |value, byte| value << 8 | u64::from(*byte))
}
