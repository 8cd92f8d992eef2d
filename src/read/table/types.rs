//! The types of typed columns: the types to which they are cast, and their names in messages.

use arrow_schema::DataType;

/// Returns the type as which a column of type `own` is read: f64, whole numbers of 64 bits, text, or `own` itself.
pub fn kind(own: &DataType) -> DataType {
    match own {
        DataType::Dictionary(_, values) => kind(values),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => DataType::Utf8,
        own if own.is_integer() && *own != DataType::UInt64 => DataType::Int64,
        own if own.is_numeric() => DataType::Float64,
        own => own.clone(),
    }
}

/// Returns what a column of type `own` holds.
pub fn content(own: &DataType) -> &'static str {
    match kind(own) {
        DataType::Utf8 => "text",
        DataType::Int64 | DataType::Float64 => "numbers",
        DataType::Boolean => "true and false",
        DataType::Duration(_) | DataType::Interval(_) => "durations",
        own if own.is_temporal() => "dates",
        own if own.is_nested() => "lists or structures",
        _ => "values of another kind",
    }
}
