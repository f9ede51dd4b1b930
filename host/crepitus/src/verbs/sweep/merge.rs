//! `crepitus sweep --merge DIR…`: the table of a sweep that ran in parts.

use super::{Arguments, store_failure, table, warn_of_failed, words};
use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crepitus_files::json_path;
use crepitus_studies::sweep::Store;
use serde_json::json;
use std::path::PathBuf;

pub(super) fn run(
    folders: &[PathBuf],
    arguments: &Arguments,
    as_json: bool,
) -> Result<(), Failure> {
    interrupt::listen();
    let Some((first, others)) = folders.split_first() else {
        return Err(Failure::Input("--merge: name a folder".to_owned()));
    };
    let claim = arguments.force.claim("sweep", [""; 0]);
    let format = arguments.format();
    let mut store = Store::open(first, format, claim).map_err(store_failure)?;
    let others = others.iter().map(|other| Store::read(other));
    let others = others
        .collect::<Result<Vec<_>, _>>()
        .map_err(store_failure)?;
    let written = if let Some(written) = store.table() {
        written
    } else {
        for other in &others {
            store.take_parts_of(other).map_err(store_failure)?;
        }
        table(&mut store, format, first)?
    };
    let sweep = store.identity();
    if as_json {
        return print_json(&json!({
            "table": json_path(&written.file),
            "bytes": written.bytes,
            "runs": sweep.runs,
            "failed": written.failed,
            "sweep": sweep,
        }));
    }
    warn_of_failed(&written, sweep.runs);
    print(&format!(
        "all {} runs are there\ntable: {} ({})\n",
        sweep.runs,
        written.file.display(),
        words::size(written.bytes)
    ))
}
