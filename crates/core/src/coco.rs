//! COCO annotation files (cocodataset.org, "Data format", object detection), as far as they are read; other keys are passed over.

use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer};

/// Reads a whole number that is not negative, as JSON has it: `1`, or `1.0` as pandas writes it.
pub fn whole<'de, D: Deserializer<'de>, T: TryFrom<u64>>(from: D) -> Result<T, D::Error> {
    /// Most whole numbers that a double tells apart: 2⁵³.
    const MOST: f64 = 9_007_199_254_740_992.0;
    let whole = match Number::deserialize(from)? {
        Number::Whole(number) => number,
        Number::Fraction(number) if number.fract() == 0.0 && (0.0..=MOST).contains(&number) => number as u64,
        Number::Fraction(number) => return Err(Error::custom(format!("{number} is no whole number from 0 up"))),
    };
    T::try_from(whole).map_err(|_| too_large(whole))
}

/// Reads a [`whole`] number that may be `null`; the key needs serde's `default` where it may be absent.
pub fn whole_if_any<'de, D: Deserializer<'de>, T: TryFrom<u64>>(from: D) -> Result<Option<T>, D::Error> {
    let converted = |Whole(number)| T::try_from(number).map_err(|_| too_large(number));
    Option::<Whole>::deserialize(from)?.map(converted).transpose()
}

fn too_large<E: Error>(number: u64) -> E {
    E::custom(format!("{number} is too large a number"))
}

/// A [`whole`] number as a value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Whole(#[serde(deserialize_with = "whole")] pub u64);

#[derive(Deserialize)]
#[serde(untagged, expecting = "a whole number belongs here")]
enum Number {
    Whole(u64),
    Fraction(f64),
}

/// A file of images `I`, whose annotations have attributes `A` and, where it is read, the mark `C` of a crowd.
#[derive(Debug, Deserialize)]
pub struct File<I, A, C: Default = IgnoredAny> {
    pub images: Vec<I>,
    pub annotations: Vec<Annotation<A, C>>,
    pub categories: Vec<Category>,
}

/// A box in an image.
#[derive(Debug, Deserialize)]
pub struct Annotation<A, C: Default = IgnoredAny> {
    #[serde(deserialize_with = "whole")]
    pub image_id: u64,
    #[serde(deserialize_with = "whole")]
    pub category_id: u64,
    /// x, y, width, height in px.
    pub bbox: [f64; 4],
    /// 1 for a box around many objects.
    #[serde(default)]
    pub iscrowd: C,
    pub attributes: Option<A>,
}

/// Category of boxes.
#[derive(Debug, Clone, Deserialize)]
pub struct Category {
    #[serde(deserialize_with = "whole")]
    pub id: u64,
    pub name: String,
}
