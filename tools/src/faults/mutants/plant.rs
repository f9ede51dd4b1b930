//! Mutants in the text of a file, each behind its switch.
//!
//! Both operands of an operator are computed once, and then either operator is taken,
//! so that nested mutants do not multiply the text:
//!
//! ```text
//! a * b   ─>   (match (a, b) { (mu_a, mu_b) => if is(7) { mu_a / mu_b } else { mu_a * mu_b } })
//! ```

use crate::faults::mutants::{Genre, Mutant, Place};
use proc_macro2::{LineColumn, Span};
use std::cmp::Reverse;
use std::collections::HashMap;
use std::fmt::Write;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// The call that asks for a mutant.
pub const SWITCH: &str = "crate::mutant::is(";

/// The text with these mutants, by number, and the numbers that have a place in it.
///
/// # Errors
/// If it is no source.
pub fn plant(source: &str, mutants: &[(u32, &Mutant)]) -> syn::Result<(String, Vec<u32>)> {
    let mut found = MutantPlaces {
        lines: Lines::of(source),
        mutants: HashMap::new(),
        edits: Vec::new(),
        placed: Vec::new(),
    };
    for (number, mutant) in mutants {
        let place = (mutant.genre, mutant.span.start);
        let replacement = mutant.replacement.clone();
        let here = found.mutants.entry(place).or_default();
        here.push(Switched {
            number: *number,
            replacement,
        });
    }
    found.visit_file(&syn::parse_file(source)?);
    let mut edits = found.edits;
    // The outer ones first; the sort is stable, and an outer one was found first.
    edits.sort_by_key(|edit| {
        (
            edit.range.start,
            !edit.range.is_empty(),
            Reverse(edit.range.end),
        )
    });
    Ok((written(source, &edits, 0..source.len()), found.placed))
}

/// A mutant that is switched.
#[derive(Clone, Debug)]
struct Switched {
    number: u32,
    replacement: String,
}

/// Replacement of a range of the text.
struct Edit {
    range: Range<usize>,
    kind: Kind,
    mutants: Vec<Switched>,
}

enum Kind {
    /// Insertion before the first statement of a function.
    Body,
    Binary {
        left: Range<usize>,
        operator: String,
        right: Range<usize>,
    },
    Unary {
        operator: String,
        operand: Range<usize>,
    },
    /// Edit behind the pattern of an arm, with its guard if it has one.
    Arm {
        guard: Option<Range<usize>>,
    },
    Guard,
}

/// A source and the beginning of each of its lines.
struct Lines<'a> {
    source: &'a str,
    begins: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn of(source: &'a str) -> Self {
        let ends = source.match_indices('\n').map(|(end, _)| end + 1);
        Self {
            source,
            begins: std::iter::once(0).chain(ends).collect(),
        }
    }

    fn at(&self, place: LineColumn) -> usize {
        let begin = self.begins[place.line - 1];
        let line = &self.source[begin..];
        begin
            + line
                .char_indices()
                .nth(place.column)
                .map_or(line.len(), |(at, _)| at)
    }

    fn range(&self, span: Span) -> Range<usize> {
        self.at(span.start())..self.at(span.end())
    }

    fn text(&self, span: Span) -> String {
        self.source[self.range(span)].to_owned()
    }
}

/// Looks for the places of mutants.
struct MutantPlaces<'a> {
    lines: Lines<'a>,
    mutants: HashMap<(Genre, Place), Vec<Switched>>,
    edits: Vec<Edit>,
    placed: Vec<u32>,
}

impl MutantPlaces<'_> {
    fn take(&mut self, genre: Genre, at: LineColumn) -> Vec<Switched> {
        let place = Place {
            line: at.line,
            column: at.column + 1,
        };
        self.mutants.remove(&(genre, place)).unwrap_or_default()
    }

    fn edit(&mut self, range: Range<usize>, kind: Kind, mutants: Vec<Switched>) {
        if !mutants.is_empty() {
            self.placed
                .extend(mutants.iter().map(|mutant| mutant.number));
            self.edits.push(Edit {
                range,
                kind,
                mutants,
            });
        }
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        let Some(first) = block
            .stmts
            .first()
            .filter(|_| signature.constness.is_none())
        else {
            return;
        };
        let at = first.span().start();
        let mutants = self.take(Genre::FnValue, at);
        let at = self.lines.at(at);
        self.edit(at..at, Kind::Body, mutants);
        self.visit_block(block);
    }
}

/// Constants, types and patterns are left alone: there nothing can be switched.
impl<'ast> Visit<'ast> for MutantPlaces<'_> {
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}
    fn visit_variant(&mut self, _: &'ast syn::Variant) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}

    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
    }

    fn visit_expr_binary(&mut self, expr: &'ast syn::ExprBinary) {
        if !binds(&expr.left) && !binds(&expr.right) {
            let mutants = self.take(Genre::BinaryOperator, expr.op.span().start());
            let kind = Kind::Binary {
                left: self.lines.range(expr.left.span()),
                operator: self.lines.text(expr.op.span()),
                right: self.lines.range(expr.right.span()),
            };
            self.edit(self.lines.range(expr.span()), kind, mutants);
        }
        visit::visit_expr_binary(self, expr);
    }

    fn visit_expr_unary(&mut self, expr: &'ast syn::ExprUnary) {
        let mutants = self.take(Genre::UnaryOperator, expr.op.span().start());
        let kind = Kind::Unary {
            operator: self.lines.text(expr.op.span()),
            operand: self.lines.range(expr.expr.span()),
        };
        self.edit(self.lines.range(expr.span()), kind, mutants);
        visit::visit_expr_unary(self, expr);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        let (pattern, guard) = match &arm.pat {
            syn::Pat::Guard(guarded) => (guarded.pat.as_ref(), Some(guarded.guard.as_ref())),
            pattern => (pattern, None),
        };
        if !guard.is_some_and(binds) {
            let mutants = self.take(Genre::MatchArm, arm.span().start());
            let behind = self.lines.range(pattern.span()).end;
            let range = guard.map(|guard| self.lines.range(guard.span()));
            let end = range.as_ref().map_or(behind, |range| range.end);
            let kind = Kind::Arm {
                guard: range.clone(),
            };
            self.edit(behind..end, kind, mutants);
            if let (Some(range), Some(guard)) = (range, guard) {
                let mutants = self.take(Genre::MatchArmGuard, guard.span().start());
                self.edit(range, Kind::Guard, mutants);
            }
        }
        if let Some(guard) = guard {
            self.visit_expr(guard);
        }
        self.visit_expr(&arm.body);
    }
}

/// Returns whether a chain of conditions binds with `let`.
fn binds(expr: &syn::Expr) -> bool {
    match expr {
        syn::Expr::Let(_) => true,
        syn::Expr::Binary(binary) => binds(&binary.left) || binds(&binary.right),
        syn::Expr::Paren(paren) => binds(&paren.expr),
        _ => false,
    }
}

/// The text of a range with the edits in it.
fn written(source: &str, edits: &[Edit], range: Range<usize>) -> String {
    let (mut text, mut at) = (String::new(), range.start);
    for (n, edit) in edits.iter().enumerate() {
        if edit.range.start > range.end {
            break;
        }
        // Within one that is written, or around this range.
        if edit.range.start < at || edit.range.end > range.end {
            continue;
        }
        text.push_str(&source[at..edit.range.start]);
        text.push_str(&edit.text(source, &edits[n + 1..]));
        at = edit.range.end;
    }
    text + &source[at..range.end]
}

impl Edit {
    fn text(&self, source: &str, inner: &[Self]) -> String {
        let of = |range: &Range<usize>| written(source, inner, range.clone());
        match &self.kind {
            Kind::Body => self.mutants.iter().fold(String::new(), |mut text, mutant| {
                let Switched {
                    number,
                    replacement,
                } = mutant;
                let _ = write!(text, "if {SWITCH}{number}) {{ return {replacement}; }} ");
                text
            }),
            Kind::Arm { guard } => {
                let number = self.mutants.first().map_or(0, |mutant| mutant.number);
                let guard = guard
                    .as_ref()
                    .map_or_else(String::new, |guard| format!(" && ({})", of(guard)));
                format!(" if !{SWITCH}{number}){guard} ")
            }
            Kind::Guard => format!("({})", self.chosen(&of(&self.range), str::to_owned)),
            Kind::Unary { operator, operand } => {
                let chosen = self.chosen(&format!("{operator}mu_a"), |_| "mu_a".to_owned());
                format!("(match {} {{ mu_a => {chosen} }})", of(operand))
            }
            Kind::Binary {
                left,
                operator,
                right,
            } => {
                let (left, right) = (of(left), of(right));
                match operator.as_str() {
                    // The right one is not computed if the left one decides.
                    "&&" | "||" => {
                        let with = |operator: &str| format!("mu_a {operator} ({right})");
                        let chosen = self.chosen(&with(operator), with);
                        format!("(match {left} {{ mu_a => {chosen} }})")
                    }
                    // Compared, not moved.
                    "==" | "!=" | "<" | ">" | "<=" | ">=" => {
                        let with = |operator: &str| format!("*mu_a {operator} *mu_b");
                        let chosen = self.chosen(&with(operator), with);
                        format!("(match (&({left}), &({right})) {{ (mu_a, mu_b) => {chosen} }})")
                    }
                    assigns if assigns.ends_with('=') => {
                        let with = |operator: &str| format!("{left} {operator} mu_b;");
                        let chosen = self.chosen(&with(operator), with);
                        format!("{{ let mu_b = {right}; {chosen} }}")
                    }
                    _ => {
                        let with = |operator: &str| format!("mu_a {operator} mu_b");
                        let chosen = self.chosen(&with(operator), with);
                        format!("(match ({left}, {right}) {{ (mu_a, mu_b) => {chosen} }})")
                    }
                }
            }
        }
    }

    /// Code that chooses what a mutant makes of its replacement, or else what is there.
    fn chosen(&self, otherwise: &str, with: impl Fn(&str) -> String) -> String {
        let mut text = String::new();
        for Switched {
            number,
            replacement,
        } in &self.mutants
        {
            let _ = write!(
                text,
                "if {SWITCH}{number}) {{ {} }} else ",
                with(replacement)
            );
        }
        text + "{ " + otherwise + " }"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::mutants::Span;

    /// The mutants of a genre at the first place of a text in the source.
    fn mutants(source: &str, list: &[(Genre, &str, &str)]) -> Vec<Mutant> {
        let mutant = |(genre, at, replacement): &(Genre, &str, &str)| {
            let before = &source[..source.find(at).expect("the place")];
            let line = before.matches('\n').count() + 1;
            let column = before
                .rsplit('\n')
                .next()
                .map_or(0, |line| line.chars().count())
                + 1;
            Mutant {
                file: "lib.rs".into(),
                name: String::new(),
                genre: *genre,
                replacement: (*replacement).to_owned(),
                span: Span {
                    start: Place { line, column },
                },
            }
        };
        list.iter().map(mutant).collect()
    }

    fn planted(source: &str, list: &[(Genre, &str, &str)]) -> (String, Vec<u32>) {
        let mutants = mutants(source, list);
        let numbered: Vec<_> = (1..).zip(&mutants).collect();
        let (text, placed) = plant(source, &numbered).expect("source");
        syn::parse_file(&text).expect("still source");
        (text.replace(SWITCH, "is("), placed)
    }

    #[test]
    fn operands_are_computed_once_and_nested_mutants_do_not_multiply() {
        let source = "fn f(α: f64, b: f64) -> f64 { α * (b + 1.0) }";
        let list = [
            (Genre::FnValue, "α * (", "0.0"),
            (Genre::BinaryOperator, "* (", "+"),
            (Genre::BinaryOperator, "* (", "/"),
            (Genre::BinaryOperator, "+ 1.0", "-"),
        ];
        let (text, placed) = planted(source, &list);
        assert_eq!(placed.len(), 4);
        assert_eq!(
            text,
            "fn f(α: f64, b: f64) -> f64 { if is(1) { return 0.0; } (match (α, ((match (b, 1.0) { (mu_a, \
             mu_b) => if is(4) { mu_a - mu_b } else { mu_a + mu_b } }))) { (mu_a, mu_b) => if is(2) { mu_a + mu_b } \
             else if is(3) { mu_a / mu_b } else { mu_a * mu_b } }) }"
        );
    }

    #[test]
    fn each_kind_of_operator_keeps_what_it_means() {
        for (expression, at, other, expected) in [
            (
                "a && b",
                "&&",
                "||",
                "(match a { mu_a => if is(1) { mu_a || (b) } else { mu_a && (b) } })",
            ),
            (
                "a < b",
                "<",
                "==",
                "(match (&(a), &(b)) { (mu_a, mu_b) => if is(1) { *mu_a == *mu_b } else { *mu_a < *mu_b } })",
            ),
            (
                "a.x -= b",
                "-=",
                "+=",
                "{ let mu_b = b; if is(1) { a.x += mu_b; } else { a.x -= mu_b; } }",
            ),
        ] {
            let source = format!("fn f() {{ {expression} }}");
            let (text, _) = planted(&source, &[(Genre::BinaryOperator, at, other)]);
            assert_eq!(text, format!("fn f() {{ {expected} }}"));
        }
        let (text, _) = planted("fn f() { !a.b() }", &[(Genre::UnaryOperator, "!", "")]);
        assert_eq!(
            text,
            "fn f() { (match a.b() { mu_a => if is(1) { mu_a } else { !mu_a } }) }"
        );
    }

    #[test]
    fn arms_and_guards_are_switched_in_their_place() {
        let source = "fn f() { match a { Some(x) if x > 0 => 1, 2 | 3 => 2, _ => 0 } }";
        let list = [
            (Genre::MatchArm, "Some", ""),
            (Genre::MatchArmGuard, "x > 0", "true"),
            (Genre::BinaryOperator, "> 0", ">="),
            (Genre::MatchArm, "2 |", ""),
        ];
        let (text, placed) = planted(source, &list);
        assert_eq!(placed.len(), 4);
        assert_eq!(
            text,
            "fn f() { match a { Some(x) if !is(1) && ((if is(2) { true } else { (match (&(x), &(0)) { (mu_a, mu_b) \
             => if is(3) { *mu_a >= *mu_b } else { *mu_a > *mu_b } }) }))  => 1, 2 | 3 if !is(4)  => 2, _ => 0 } }"
        );
    }

    #[test]
    fn what_cannot_be_switched_stays_as_it_is() {
        for (source, at) in [
            ("const A: u32 = 1 + 2;", "+ 2"),
            ("const fn f() -> u32 { 1 + 2 }", "+ 2"),
            ("fn f() { let a = [0; 1 + 2]; }", "+ 2"),
            ("fn f() { if let Some(x) = a && x { } }", "&& x"),
        ] {
            let (text, placed) = planted(source, &[(Genre::BinaryOperator, at, "-")]);
            assert_eq!((text.as_str(), placed.len()), (source, 0));
        }
    }
}
