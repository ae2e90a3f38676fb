//! `firstlight schema`: the JSON Schema of scene files.

use crate::output::print_json;
use crate::{Exit, Outcome};

pub(crate) fn run() -> Outcome {
    print_json(&firstlight::io::scene_file::schema())?;
    Ok(Exit::Done)
}
