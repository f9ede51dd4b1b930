//! Arrays of more than 32 elements as serde takes shorter ones: a tuple, element
//! after element.

use core::fmt;
use core::marker::PhantomData;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Serializes an array.
pub(crate) fn serialize<S: Serializer, T: Serialize, const N: usize>(
    array: &[T; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut tuple = serializer.serialize_tuple(N)?;
    for element in array {
        tuple.serialize_element(element)?;
    }
    tuple.end()
}

/// Deserializes an array.
pub(crate) fn deserialize<'de, D, T, const N: usize>(deserializer: D) -> Result<[T; N], D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de> + Default + Copy,
{
    deserializer.deserialize_tuple(N, Elements(PhantomData))
}

/// Takes the elements of an array.
struct Elements<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de> + Default + Copy, const N: usize> Visitor<'de> for Elements<T, N> {
    type Value = [T; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<[T; N], A::Error> {
        let mut array = [T::default(); N];
        for (index, element) in array.iter_mut().enumerate() {
            *element = elements
                .next_element()?
                .ok_or_else(|| Error::invalid_length(index, &self))?;
        }
        Ok(array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Short([f64; 3]);

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Long(#[serde(with = "super")] [f64; 3]);

    #[test]
    fn its_bytes_are_those_of_a_short_array_and_fewer_are_an_error() {
        let mut bytes = [0; 24];
        let numbers = [1.5, -0.0, 7e300];
        let used = postcard::to_slice(&Long(numbers), &mut bytes)
            .unwrap()
            .len();
        assert_eq!(used, 24);
        assert_eq!(postcard::from_bytes(&bytes), Ok(Short(numbers)));
        assert_eq!(postcard::from_bytes(&bytes), Ok(Long(numbers)));
        assert!(postcard::from_bytes::<Long>(&bytes[..23]).is_err());
    }
}
