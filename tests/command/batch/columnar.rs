//! Parquet and Arrow: they are answered as text is; and the types that their columns may have.

use super::table::{WALK_QUESTIONS, walk};
use super::*;
use crate::support::random::Random;
use arrow_array::types::{Int8Type, Int32Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, DictionaryArray, Float32Array, Float64Array, Int64Array, NullArray, RecordBatch,
    StringArray, StructArray, TimestampSecondArray, UInt64Array,
};
use arrow_cast::cast;
use arrow_cast::display::array_value_to_string;
use arrow_ipc::reader::{FileReader, StreamReader};
use arrow_ipc::writer::{FileWriter, StreamWriter};
use arrow_schema::{ArrowError, DataType, Field, TimeUnit};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::sync::Arc;

const ENDINGS: [&str; 3] = ["parquet", "arrow", "arrows"];

/// Writes these columns, in batches of 40 rows, in the format of the name's ending; returns the path.
fn written(name: &str, columns: &[(&str, ArrayRef)]) -> String {
    let nullable = columns.iter().map(|(name, array)| (*name, Arc::clone(array), true));
    let whole = RecordBatch::try_from_iter_with_nullable(nullable).expect("columns of one length");
    let schema = whole.schema();
    let batches = (0..whole.num_rows()).step_by(40).map(|row| whole.slice(row, 40.min(whole.num_rows() - row)));
    let mut bytes = Vec::new();
    match name.rsplit_once('.').expect("an ending").1 {
        "parquet" => {
            let mut writer = ArrowWriter::try_new(&mut bytes, schema, None).expect("a writer");
            batches.for_each(|batch| writer.write(&batch).expect("memory"));
            writer.close().expect("memory");
        }
        "arrow" => {
            let mut writer = FileWriter::try_new(&mut bytes, &schema).expect("a writer");
            batches.for_each(|batch| writer.write(&batch).expect("memory"));
            writer.finish().expect("memory");
        }
        _ => {
            let mut writer = StreamWriter::try_new(&mut bytes, &schema).expect("a writer");
            batches.for_each(|batch| writer.write(&batch).expect("memory"));
            writer.finish().expect("memory");
        }
    }
    file(name, bytes)
}

fn batches(path: &str) -> Vec<RecordBatch> {
    let file = File::open(path).expect("a file");
    match path.rsplit_once('.').expect("an ending").1 {
        "parquet" => {
            let reader = ParquetRecordBatchReaderBuilder::try_new(file).expect("Parquet").build().expect("Parquet");
            reader.map(|batch| batch.expect("a batch")).collect()
        }
        "arrow" => FileReader::try_new(file, None).expect("Arrow").map(|batch| batch.expect("a batch")).collect(),
        _ => StreamReader::try_new(file, None).expect("Arrow").map(|batch| batch.expect("a batch")).collect(),
    }
}

/// The table of a Parquet or Arrow file as CSV.
fn as_csv(path: &str) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (at, batch) in batches(path).iter().enumerate() {
        if at == 0 {
            let schema = batch.schema();
            writer.write_record(schema.fields().iter().map(|field| field.name())).expect("memory");
        }
        for row in 0..batch.num_rows() {
            let cell = |column: &ArrayRef| match column.as_any().downcast_ref::<Float64Array>() {
                Some(numbers) if numbers.is_valid(row) => format!("{:?}", numbers.value(row)),
                _ => array_value_to_string(column, row).expect("text"),
            };
            writer.write_record(batch.columns().iter().map(cell)).expect("memory");
        }
    }
    String::from_utf8(writer.into_inner().expect("memory")).expect("text")
}

/// The columns of the walk: numbers if every cell is one, otherwise text.
fn walk_columns() -> Vec<(String, ArrayRef)> {
    let table = walk().0;
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().expect("a header").clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    let column = |(at, name): (usize, &str)| {
        let cells = rows.iter().map(|row| row[at].to_owned());
        let numbers: Result<Vec<f64>, _> = cells.clone().map(|cell| cell.parse()).collect();
        let texts = || Arc::new(StringArray::from_iter_values(cells)) as ArrayRef;
        (name.to_owned(), numbers.map_or_else(|_| texts(), |numbers| Arc::new(Float64Array::from(numbers))))
    };
    names.iter().enumerate().map(column).collect()
}

#[test]
fn columns_are_answered_as_flat_lines_are() {
    // Without their leading blank line, the number of each JSON line is that of its row.
    let lines = file("walk.ndjson", walk().1.trim_start());
    let columns = walk_columns();
    let columns: Vec<(&str, ArrayRef)> = columns.iter().map(|(name, array)| (&**name, Arc::clone(array))).collect();
    for ending in ENDINGS {
        let input = written(&format!("walk.{ending}"), &columns);
        for question in WALK_QUESTIONS {
            let run = |arguments: &[&str]| heelstrike(&[&["batch", RAMONE, "--friction", "0.6"], arguments].concat());
            let expected = run(&[&[&*lines], question].concat()).well();
            let answers = run(&[&[&*input], question].concat()).well();
            assert!(answers.stdout == expected.stdout && answers.stderr == expected.stderr, "{ending} {question:?}");
            if question.contains(&"csv") {
                let output = place(&format!("answers.{ending}"));
                let more = question.iter().filter(|word| !["--output-format", "csv"].contains(word)).copied();
                let more: Vec<&str> = more.chain(["-o", &output]).collect();
                for (input, threads) in [(&lines, "1"), (&input, "1"), (&input, "4")] {
                    assert_eq!(run(&[&[&**input, "--threads", threads], &more[..]].concat()).stdout, "");
                    assert!(as_csv(&output) == expected.stdout, "{input} {more:?}");
                }
                assert!(std::fs::metadata(output + ".run").is_err());
            }
        }
    }
    let stream = std::fs::read(place("walk.arrows")).expect("the stream");
    let always = ["batch", RAMONE, "-", "--friction", "0.6", "--input-format", "arrow"];
    let expected = heelstrike(&["batch", RAMONE, &lines, "--friction", "0.6"]).well();
    assert!(heelstrike_reads(&always, stream.clone()).well().stdout == expected.stdout);
    // Two concatenated streams are an error, because the second one is not read.
    let joined = heelstrike(&["batch", RAMONE, &file("joined.arrows", stream.repeat(2)), "--friction", "0.6"]);
    assert_eq!((joined.status, &joined.stdout), (1, &expected.stdout));
    assert!(joined.stderr.contains("more follows the end of the stream"), "{}", joined.stderr);
}

#[test]
fn feet_rest_in_columns_of_f32_as_in_those_of_f64() {
    let walk: Vec<_> =
        walk_columns().into_iter().filter(|(_, column)| column.data_type() == &DataType::Float64).collect();
    let verdicts = |file: &str, to: DataType| -> Vec<Value> {
        let column = |(name, column): &'_ (String, ArrayRef)| (name.clone(), cast(column, &to).expect("numbers"));
        let columns: Vec<(String, ArrayRef)> = walk.iter().map(column).collect();
        let columns: Vec<(&str, ArrayRef)> = columns.iter().map(|(name, own)| (&**name, Arc::clone(own))).collect();
        let options = ["--friction", "0.6", "--contact-tolerance", "1e-4", "--brief"];
        let answers = heelstrike(&[&["batch", RAMONE, &written(file, &columns)], &options[..]].concat()).well().lines();
        answers.into_iter().map(|mut answer| answer["verdict"].take()).collect()
    };
    let [double, single] =
        [("d.parquet", DataType::Float64), ("s.parquet", DataType::Float32)].map(|(file, to)| verdicts(file, to));
    let differing = double.iter().zip(&single).filter(|(double, single)| double != single).count();
    // In few states the velocities of f32 are farther from rest than their precision explains.
    assert!(double.len() > 100 && differing < 5, "{differing} of {}", double.len());
}

fn texts(texts: &[Option<&str>]) -> ArrayRef {
    Arc::new(StringArray::from(texts.to_vec()))
}

/// States of a disc that strikes the ground, as columns of many types; rows 3 to 7 are broken.
fn strikes() -> Vec<(&'static str, ArrayRef)> {
    let dictionary = |texts: [Option<&str>; 8]| Arc::new(texts.into_iter().collect::<DictionaryArray<Int8Type>>());
    let z = [Some(0.5), Some(0.5), None, Some(f64::NAN), Some(0.5), Some(0.5), Some(0.5), Some(0.5)];
    vec![
        ("id", Arc::new(Int64Array::from(vec![Some(-1), Some(2), Some(3), Some(4), Some(5), Some(6), None, Some(8)]))),
        ("q_base_z", Arc::new(Float64Array::from(z.to_vec()))),
        ("v_base_x", Arc::new(Float32Array::from(vec![0.5; 8]))),
        ("v_base_z", Arc::new(Int64Array::from(vec![-1; 8]))),
        (
            "friction",
            dictionary([
                Some("0.8"),
                Some("infinite"),
                None,
                None,
                Some("rough"),
                Some("-1"),
                Some("inf"),
                Some("1e0"),
            ]),
        ),
        ("restitution", Arc::new(NullArray::new(8))),
        ("foot", dictionary([Some("l"), Some("r"), None, Some("l"), Some("r"), Some("l"), Some("l"), None])),
        ("when", Arc::new(TimestampSecondArray::from((0..8).collect::<Vec<i64>>()))),
        (
            "count",
            Arc::new(arrow_array::UInt16Array::from((0..8).map(|at| (at % 3 > 0).then_some(at)).collect::<Vec<_>>())),
        ),
        ("good", Arc::new(BooleanArray::from(vec![Some(true), None, Some(false), None, None, None, None, Some(true)]))),
        ("load", Arc::new(Float32Array::from(vec![0.1; 8]))),
        ("note", texts(&[Some("a, \"b\""), Some(""), None, None, None, None, None, Some("é")])),
    ]
}

#[test]
fn time_as_a_date_is_refused_where_it_is_needed() {
    let heights: ArrayRef = Arc::new(Float64Array::from(vec![0.7, 0.6]));
    let dates: ArrayRef = Arc::new(TimestampSecondArray::from(vec![0, 1]));
    for (times, found) in [(cast(&dates, &DataType::Date32), "dates"), (Ok(dates), "dates"), (durations(), "durations")]
    {
        let times = times.expect("times");
        let columns = [("time", times), ("q_base_z", Arc::clone(&heights)), ("v_base_z", Arc::clone(&heights))];
        let refused = batch(&[&written("dated.parquet", &columns), "--touchdowns"], "").refusal(1);
        assert!(refused.contains(&format!(": time: expected seconds, found {found}\nhint: ")), "{refused}");
    }
}

#[test]
fn ids_are_numbers_of_any_type() {
    let floats: ArrayRef = Arc::new(Float64Array::from(vec![Some(1.0), None, Some(2.5), Some(f64::NAN)]));
    let large: ArrayRef = Arc::new(UInt64Array::from(vec![Some(u64::MAX), None, Some(0), Some(7)]));
    let decimals = cast(&Int64Array::from(vec![1, 2, 3, 4]), &DataType::Decimal128(30, 0)).expect("decimals");
    let hundredths = cast(&Int64Array::from(vec![1, -2, 30, 4]), &DataType::Decimal128(10, 2)).expect("decimals");
    let halves = cast(&Float64Array::from(vec![1.5, 0.0, -0.5, 10.0]), &DataType::Decimal128(10, 2)).expect("decimals");
    let extreme: ArrayRef = Arc::new(Float64Array::from(vec![1e16, -0.0, -1.5e17, 1e19]));
    for (name, ids, expected) in [
        ("hundredths", hundredths, json!([1, -2, 30, 4])),
        ("halves", halves, json!([1.5, 0, -0.5, 10])),
        ("extreme", extreme, json!([10_000_000_000_000_000_i64, 0, -150_000_000_000_000_000_i64, 1e19])),
        ("floats", floats, json!([1, null, 2.5, null])),
        ("large", large, json!([u64::MAX, null, 0, 7])),
        ("decimals", decimals, json!([1, 2, 3, 4])),
    ] {
        let half: ArrayRef = Arc::new(Float64Array::from(vec![0.5; 4]));
        let columns = [("id", Arc::clone(&ids)), ("q_base_z", Arc::clone(&half)), ("v_base_z", half)];
        for ending in ENDINGS {
            let (input, output) = (written(&format!("{name}.{ending}"), &columns), place(&format!("ids.{ending}")));
            let answers = batch(&[&input, "--friction", "1", "--brief"], "").well().lines();
            assert_eq!(json!(answers.iter().map(|answer| &answer["id"]).collect::<Vec<_>>()), expected, "{name}");
            batch(&[&input, "--friction", "1", "-o", &output], "").well();
            assert_eq!(batches(&output)[0].column(0).as_ref(), ids.as_ref(), "{name}.{ending}");
        }
    }
}

#[test]
fn dictionaries_of_many_rows_are_written() {
    const ROWS: usize = 20_000;
    let dictionary = |text: fn(usize) -> String| -> ArrayRef {
        let texts: Vec<String> = (0..ROWS).map(text).collect();
        Arc::new(texts.iter().map(|text| Some(&**text)).collect::<DictionaryArray<Int32Type>>())
    };
    let half: ArrayRef = Arc::new(Float64Array::from(vec![0.5; ROWS]));
    let phase = dictionary(|row| format!("{}", row / 7));
    let item = Arc::new(Field::new("item", phase.data_type().clone(), true));
    // A list of one entry in each row.
    let lists = cast(&phase, &DataType::List(Arc::clone(&item))).expect("lists");
    let member: ArrayRef = Arc::new(StructArray::from(vec![(item, Arc::clone(&phase))]));
    let own = [("id", dictionary(|row| format!("id {row}"))), ("phase", phase), ("lists", lists), ("member", member)];
    let columns = [&own[..], &[("q_base_z", Arc::clone(&half)), ("v_base_z", half)]].concat();
    // One batch, because a file of Arrow has one dictionary.
    let whole = RecordBatch::try_from_iter(columns).expect("columns of one length");
    let (mut arrow, mut parquet) = (Vec::new(), Vec::new());
    let mut writer = FileWriter::try_new(&mut arrow, &whole.schema()).expect("a writer");
    writer.write(&whole).and_then(|()| writer.finish()).expect("memory");
    let mut writer = ArrowWriter::try_new(&mut parquet, whole.schema(), None).expect("a writer");
    writer.write(&whole).expect("memory");
    writer.close().expect("memory");
    for input in [file("dictionaries.arrow", arrow), file("dictionaries.parquet", parquet)] {
        for ending in ENDINGS {
            let output = place(&format!("dictionaries-answers.{ending}"));
            batch(&[&input, "--friction", "1", "--brief", "-o", &output], "").well();
            for (name, array) in &own {
                let found = batches(&output);
                let texts = |own: &ArrayRef| {
                    let text = |row| array_value_to_string(own, row).expect("text");
                    (0..own.len()).map(text).collect::<Vec<_>>()
                };
                let own = |rows: &RecordBatch| texts(rows.column_by_name(name).expect("a column"));
                assert_eq!(found.iter().flat_map(own).collect::<Vec<_>>(), texts(array), "{input} {name} {ending}");
            }
        }
    }
}

#[test]
fn whole_numbers_take_few_bytes_in_parquet() {
    const ROWS: i64 = 20_000;
    let half: ArrayRef = Arc::new(Float64Array::from(vec![0.5; ROWS as usize]));
    let whole: ArrayRef = Arc::new(Int64Array::from_iter_values(0..ROWS));
    let texts: ArrayRef = Arc::new(StringArray::from_iter_values((0..ROWS).map(|row| row.to_string())));
    let columns = [("id", Arc::clone(&whole)), ("q_base_z", Arc::clone(&half)), ("v_base_z", half)];
    let columns = [&columns[..], &[("count", whole), ("remark", texts)]].concat();
    let output = place("whole-answers.parquet");
    batch(&[&written("whole.parquet", &columns), "--friction", "1", "--brief", "-o", &output], "").well();
    let read = ParquetRecordBatchReaderBuilder::try_new(File::open(output).expect("a file")).expect("Parquet");
    let metadata = read.metadata().row_group(0);
    for column in metadata.columns() {
        let name = column.column_path().string();
        if matches!(name.as_str(), "id" | "count") {
            assert!(column.compressed_size() < 4000, "{name} {}", column.compressed_size());
        }
        assert!(column.statistics().is_none() || !matches!(name.as_str(), "verdict" | "remark"), "{name}");
    }
}

#[test]
fn arrow_is_read_under_either_of_its_names() {
    let half: ArrayRef = Arc::new(Float64Array::from(vec![0.5; 50]));
    let columns = [("q_base_z", Arc::clone(&half)), ("v_base_z", half)];
    let answers = |input: &str| batch(&[input, "--friction", "1"], "").well().stdout;
    let expected = answers(&written("named.parquet", &columns));
    for (own, other) in [("named.arrow", "renamed.arrows"), ("named.arrows", "renamed.arrow")] {
        let bytes = std::fs::read(written(own, &columns)).expect("a file");
        assert!(answers(&file(other, bytes)) == expected, "{own}");
    }
}

#[test]
fn columns_of_text_are_read_as_those_of_csv() {
    let cells = [["0.5", "-1", "0.5", ""], ["0,5", "-1", "", ""], ["0.5", "oops", "", "x"], ["0.5", "-1", "-3", "2"]];
    let cells = [&cells[..], &[["", "-1", "", ""], ["0.5", "-1", "1e400", " 1 "]]].concat();
    let names = ["q_base_z", "v_base_z", "friction", "restitution"];
    let column =
        |at: usize| texts(&cells.iter().map(|row| Some(row[at]).filter(|cell| !cell.is_empty())).collect::<Vec<_>>());
    let columns: Vec<(&str, ArrayRef)> = names.into_iter().zip((0..4).map(column)).collect();
    let rows: String = cells.iter().map(|row| row.map(|cell| format!("\"{cell}\"")).join(",") + "\n").collect();
    let answers = |input: &str| {
        let mut answers = batch(&[input, "--friction", "1", "--refused", "ok"], "").well().lines();
        answers.iter_mut().for_each(|answer| answer["line"] = json!(null));
        answers
    };
    let found = answers(&written("texts.parquet", &columns));
    assert_eq!(found, answers(&file("texts.csv", format!("{}\n{rows}", names.join(",")))));
    assert_eq!(found.iter().filter(|answer| answer["error"].is_object()).count(), 5);
}

/// Times as an engine writes differences of dates.
fn durations() -> Result<ArrayRef, ArrowError> {
    cast(&Int64Array::from(vec![0, 1]), &DataType::Duration(TimeUnit::Second))
}

#[test]
fn columns_of_any_type_are_carried_and_cells_refused() {
    for ending in ENDINGS {
        let input = written(&format!("strikes.{ending}"), &strikes());
        let output = place(&format!("answers.{ending}"));
        let brief = ["--brief", "--refused", "ok"];
        let run = batch(&[&[&*input, "-o", &*output], &brief[..]].concat(), "").well();
        let stderr = run.stderr.replace(&input, "strikes");
        insta::allow_duplicates! {
            insta::assert_snapshot!("columns_of_any_type", format!("{}\n{stderr}", as_csv(&output)));
        }
        let table = batch(&[&[&*input, "--output-format", "csv"], &brief[..]].concat(), "").well().stdout;
        assert_eq!(table, as_csv(&output));
        let found = &batches(&output)[0];
        for (name, array) in strikes().iter().skip(6).chain([&strikes()[0]]) {
            // A file of Arrow has one dictionary for all blocks.
            let expected = match array.data_type() {
                DataType::Dictionary(_, values) if ending == "arrow" => cast(array, values).expect("values"),
                _ => Arc::clone(array),
            };
            assert_eq!(found.column_by_name(name).expect("a carried column"), &expected, "{name} {ending}");
        }
        let lines = batch(&[&*input, "--refused", "ok"], "").well().lines();
        assert_eq!(lines.iter().map(|line| &line["line"]).collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6, 7, 8]);
        let carried = json!({
            "foot": "l", "when": "1970-01-01T00:00:00", "count": null, "good": true, "load": 0.1, "note": "a, \"b\""
        });
        assert_eq!((&lines[0]["id"], &lines[0]["carried"]), (&json!(-1), &carried));
    }
}

#[test]
fn many_rows_are_read_together_and_none_is_lost() {
    const ROWS: i64 = 1300;
    let rough = |row: i64| (row % 3 > 0).then_some("0.5");
    let columns: [(&str, ArrayRef); 5] = [
        ("id", Arc::new(Int64Array::from_iter_values(0..ROWS))),
        ("q_base_z", Arc::new(Float64Array::from(vec![0.5; ROWS as usize]))),
        ("v_base_x", Arc::new(Float64Array::from_iter_values((0..ROWS).map(|row| row as f64 / 1000.0)))),
        ("v_base_z", Arc::new(Float64Array::from(vec![-1.0; ROWS as usize]))),
        ("friction", texts(&(0..ROWS).map(rough).collect::<Vec<_>>())),
    ];
    let line = |row: i64| {
        let v = row as f64 / 1000.0;
        json!({"id": row, "q_base_z": 0.5, "v_base_x": v, "v_base_z": -1.0, "friction": rough(row)}).to_string() + "\n"
    };
    let lines = file("many.ndjson", (0..ROWS).map(line).collect::<String>());
    let input = written("many.parquet", &columns);
    let run = |input: &str| batch(&[input, "--friction", "0.1", "--threads", "2"], "").well().stdout;
    let (expected, found) = (run(&lines), run(&input));
    assert!(expected.lines().count() == ROWS as usize && found == expected);
    let output = place("many.arrow");
    batch(&[&input, "--friction", "0.1", "-o", &output], "").well();
    let errors: usize =
        batches(&output).iter().map(|rows| rows.column_by_name("error").expect("errors").null_count()).sum();
    assert_eq!(errors, ROWS as usize, "what is empty is null");
}

#[test]
fn a_row_takes_nothing_from_the_rows_before() {
    // Rows that give x and z, rows whose stance places the base, and one that does both.
    let placed = |row: usize| row % 3 == 1 || row == 11;
    let numbers = |number: fn(usize) -> f64, is_empty: fn(usize) -> bool| -> ArrayRef {
        Arc::new((0..24).map(|row| (!is_empty(row)).then(|| number(row))).collect::<Float64Array>())
    };
    let columns: [(&str, ArrayRef); 9] = [
        ("id", texts(&(0..24).map(|row| (row % 5 > 0).then_some("named")).collect::<Vec<_>>())),
        ("friction", numbers(|row| 0.1 * row as f64, |row| row % 2 == 1)),
        ("restitution", numbers(|_| 0.5, |row| row % 4 > 0)),
        ("q_base_x", numbers(|row| row as f64, |row| row % 3 == 1)),
        ("q_base_z", numbers(|_| 0.9, |row| row % 3 == 1 || row == 11)),
        // A rate that is noted.
        ("v_base_x", numbers(|_| 300.0, |row| row % 3 == 1)),
        ("v_base_z", numbers(|_| -1.0, |row| row % 3 == 1)),
        ("q_left_hip", numbers(|row| 0.01 * row as f64, |_| false)),
        ("stance", texts(&(0..24).map(|row| placed(row).then_some("right_foot")).collect::<Vec<_>>())),
    ];
    let run = |input: &str| {
        let run =
            heelstrike(&["batch", RAMONE, input, "--friction", "0.5", "--place", "lowest", "--refused", "ok"]).well();
        let without_line = |mut answer: Value| {
            answer.as_object_mut().expect("an answer").remove("line");
            answer
        };
        run.lines().into_iter().map(without_line).collect::<Vec<_>>()
    };
    let found = run(&written("placed.parquet", &columns));
    let refused = found.iter().filter(|answer| answer["error"].is_object()).count();
    let noted = found.iter().filter(|answer| answer["notes"].to_string().contains("the rate of x is 300")).count();
    assert_eq!((refused, noted), (1, 15));
    let table = run(&file("placed.csv", as_csv(&written("placed.arrow", &columns))));
    for (row, found) in found.iter().enumerate() {
        let columns = columns.each_ref().map(|(name, column)| (*name, column.slice(row, 1)));
        let alone = run(&written("alone.parquet", &columns));
        assert_eq!(json!(alone), json!([found]), "row {row}");
        assert!(found["error"].is_object() && table[row]["error"].is_object() || table[row] == *found, "row {row}");
    }
}

#[test]
fn columns_that_do_not_fit_are_refused_as_a_whole() {
    let numbers: ArrayRef = Arc::new(Float64Array::from(vec![0.5, 0.5]));
    let lists = cast(&numbers, &DataType::new_list(DataType::Float64, true)).expect("lists");
    let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true, false]));
    let z = ("q_base_z", Arc::clone(&numbers));
    let mut refusals = String::new();
    for (name, columns) in [
        ("list.parquet", vec![("q_base_z", lists), ("v_base_z", Arc::clone(&numbers))]),
        ("none.parquet", vec![("load", Arc::clone(&numbers))]),
        ("truth.arrow", vec![z.clone(), ("v_base_z", Arc::clone(&truths))]),
        ("stance.arrow", vec![("v_base_z", Arc::clone(&numbers)), ("stance", Arc::clone(&numbers))]),
        ("id.parquet", vec![("id", truths), z.clone(), ("v_base_z", Arc::clone(&numbers))]),
        ("missing.arrows", vec![z.clone()]),
        ("unknown.parquet", vec![z.clone(), ("v_base_z", Arc::clone(&numbers)), ("q_kne", numbers)]),
        (
            "empty.parquet",
            vec![
                ("q_base_z", Arc::new(Float64Array::new_null(0)) as ArrayRef),
                ("v_base_z", Arc::new(Float64Array::new_null(0))),
            ],
        ),
    ] {
        let input = written(name, &columns);
        let stderr = batch(&[&input, "--friction", "1"], "").refusal(1);
        refusals += &stderr.replace(&input, name);
    }
    for (name, bytes) in [
        ("text.parquet", &b"q_base_z\n"[..]),
        ("text.arrow", b"{\"q_base_z\": 1}\n"),
        ("none.arrow", b"ARROW1"),
        ("none.arrows", b""),
        ("empty.arrow", b""),
        ("cut.parquet", b"PAR1PAR1PAR1"),
        ("packed.parquet", b"\x1f\x8b\x08\x00"),
        ("other.arrow", b"PAR1"),
    ] {
        let input = file(name, bytes);
        let stderr = batch(&[&input], "").refusal(1);
        refusals += &stderr.replace(&input, name);
    }
    insta::assert_snapshot!("columns_that_do_not_fit", refusals);
    // A query engine may write an empty part; the answers to it still have all columns.
    let output = place("empty-answers.parquet");
    batch(&[&place("empty.parquet"), "--refused", "ok", "-o", &output], "").well();
    let read = ParquetRecordBatchReaderBuilder::try_new(File::open(output).expect("a file")).expect("Parquet");
    assert_eq!(read.schema().field(0).data_type(), &DataType::Utf8);
    for arguments in [
        &["-", "--input-format", "parquet"][..],
        &["x.arrow", "-o", "y", "--resume"],
        &["x.csv", "--csv-safe", "-o", "x.parquet"],
    ] {
        batch(arguments, "").refusal(2);
    }
}

#[test]
fn damaged_tables_are_refused() {
    let mut random = Random::new(1);
    for (ending, at) in ENDINGS.into_iter().flat_map(|ending| (0..40).map(move |at| (ending, at))) {
        let mut bytes = std::fs::read(written(&format!("whole.{ending}"), &strikes())).expect("a file");
        for _ in 0..3 {
            let place = random.bits() as usize % bytes.len();
            bytes[place] ^= random.bits() as u8;
        }
        bytes.truncate(if at % 4 == 0 { bytes.len() * at / 40 } else { bytes.len() });
        let run = batch(&[&file(&format!("damaged.{ending}"), bytes), "--friction", "1"], "");
        // A panic within the reader of the format is caught, and some of the rows are refused.
        assert_eq!(run.status, 1, "{at} {ending} {}", run.stderr);
        let cannot_be_read = format!("damaged.{ending}: cannot be read");
        assert!(at % 4 != 0 || run.stderr.contains(&cannot_be_read), "{at} {ending} {}", run.stderr);
    }
}
