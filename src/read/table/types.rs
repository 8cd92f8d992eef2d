//! The types of typed columns: the types to which they are cast, and their names in messages.

use arrow_schema::DataType;

/// Returns the type as which a column is read: f64, whole numbers of 64 bits, text, or `data_type` itself.
pub fn kind(data_type: &DataType) -> DataType {
    match data_type {
        DataType::Dictionary(_, values) => kind(values),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => DataType::Utf8,
        _ if data_type.is_integer() && *data_type != DataType::UInt64 => DataType::Int64,
        _ if data_type.is_numeric() => DataType::Float64,
        _ => data_type.clone(),
    }
}

/// Returns what a column of this type holds.
pub fn content(data_type: &DataType) -> &'static str {
    match kind(data_type) {
        DataType::Utf8 => "text",
        DataType::Int64 | DataType::Float64 => "numbers",
        DataType::Boolean => "true and false",
        DataType::Duration(_) | DataType::Interval(_) => "durations",
        kind if kind.is_temporal() => "dates",
        kind if kind.is_nested() => "lists or structures",
        _ => "values of another kind",
    }
}
