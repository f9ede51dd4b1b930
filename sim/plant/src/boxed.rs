//! Copies of parts whose type is not known: with their state, as a snapshot of a plant needs them.

/// Gives the boxes of a trait a `Clone`: each part copies itself.
macro_rules! cloned_in_boxes {
    ($trait:ident, $copies:ident) => {
        /// Copies itself into a box, state and all; every type that can be cloned does.
        pub trait $copies {
            /// The copy.
            fn boxed(&self) -> Box<dyn $trait>;
        }

        impl<T: $trait + Clone + 'static> $copies for T {
            fn boxed(&self) -> Box<dyn $trait> {
                Box::new(self.clone())
            }
        }

        impl Clone for Box<dyn $trait> {
            fn clone(&self) -> Self {
                $copies::boxed(self.as_ref())
            }
        }
    };
}

pub(crate) use cloned_in_boxes;
