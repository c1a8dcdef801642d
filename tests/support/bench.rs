//! Measurements, as tests of `lie bench` need them.

use std::{fs, path::Path, process::Command};

use serde_json::Value;

use super::{cornell, lie, succeeds};

/// A small measurement of the Cornell box.
pub(crate) fn bench(command: &str, more: &[&str]) -> Command {
    let mut bench = lie();
    bench.args(["bench", command]).arg(cornell());
    if !more.contains(&"--size") {
        bench.args(["--size", "64x48"]);
    }
    bench.args(more);
    bench
}

/// What a measurement writes to `--json`.
pub(crate) fn json(mut bench: Command) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.json");
    succeeds(bench.arg("--json").arg(&path));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Checks that rows have these keys, and a number in those that are not in `may_be_null`.
pub(crate) fn check_rows(rows: &Value, keys: &str, may_be_null: &[&str]) {
    let rows = rows.as_array().unwrap();
    assert!(!rows.is_empty());
    for row in rows {
        for key in keys.split(' ') {
            let value = row.get(key).unwrap_or_else(|| panic!("no {key} in {row}"));
            let is_text = ["scene", "integrator", "mode"].contains(&key);
            let is_right = if is_text {
                value.is_string()
            } else {
                value.is_number()
            };
            assert!(
                is_right || (value.is_null() && may_be_null.contains(&key)),
                "{key} in {row}"
            );
        }
    }
}

/// Every picture that a report shows is there.
pub(crate) fn check_links(report: &Path, text: &str) {
    let links: Vec<&str> = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .collect();
    assert!(links.len() > 1, "{text}");
    for link in links {
        let path = report.parent().unwrap().join(link);
        assert!(fs::metadata(&path).unwrap().len() > 0, "{}", path.display());
    }
}
