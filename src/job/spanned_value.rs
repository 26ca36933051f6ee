//! A value with its place in the text, like [`toml::Spanned`], and with the JSON schema of the value.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use std::borrow::{Borrow, Cow};
use std::ops::Range;

/// A value with its place in the file. `None` if the key is absent.
pub(super) type S<T> = Option<SpannedValue<T>>;

/// A value and its place in the file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(transparent)]
pub(super) struct SpannedValue<T>(toml::Spanned<T>);

impl<T> SpannedValue<T> {
    /// Creates a value at `span`.
    pub(super) fn new(span: Range<usize>, value: T) -> Self {
        Self(toml::Spanned::new(span, value))
    }

    /// Returns the bytes of the text.
    pub(super) fn span(&self) -> Range<usize> {
        self.0.span()
    }

    /// Returns the value.
    pub(super) fn value(&self) -> &T {
        self.0.get_ref()
    }

    /// Returns the value alone.
    pub(super) fn into_inner(self) -> T {
        self.0.into_inner()
    }
}

impl Borrow<str> for SpannedValue<String> {
    fn borrow(&self) -> &str {
        self.value()
    }
}

impl<T: JsonSchema> JsonSchema for SpannedValue<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}
