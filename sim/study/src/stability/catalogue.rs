//! The catalogue of hard cases.
