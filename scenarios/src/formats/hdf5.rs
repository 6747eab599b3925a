//! scenarios: HDF5 files, MATLAB v7.3 among them. In: the bytes. Out: data sets and groups as variables, or why not.

use super::Reason;
use super::variables::{Content, FileVariable, Stored};
use hdf5_reader::{ByteOrder, Dataset, Datatype, Hdf5File, OpenOptions, group::Group};

const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Groups in groups that are looked into.
const DEEPEST: usize = 4;
/// Most bytes that one byte of a packed file can stand for: deflate's best is 1032.
const PACKED: usize = 1032;

/// HDF5 begins at 0 or, after a block of the user's own as MATLAB writes it, at 512 or twice, four times ... that.
pub(super) fn is_hdf5(bytes: &[u8]) -> bool {
    let at = |place: usize| bytes.get(place..).is_some_and(|b| b.starts_with(SIGNATURE));
    at(0) || (0..12).any(|k| at(512 << k))
}

pub(super) fn read(bytes: Vec<u8>) -> Result<Vec<FileVariable>, Reason> {
    let most = bytes.len().saturating_mul(PACKED);
    let options = OpenOptions::default()
        .with_max_read_bytes(most)
        .with_max_chunk_bytes(most.min(hdf5_reader::DEFAULT_MAX_CHUNK_BYTES))
        .with_max_object_header_bytes(bytes.len());
    let file = Hdf5File::from_vec_with_options(bytes, options).map_err(|e| e.to_string())?;
    members(&file.root_group().map_err(|e| e.to_string())?, DEEPEST)
}

fn members(group: &Group, deepest: usize) -> Result<Vec<FileVariable>, Reason> {
    let (groups, sets) = group.members().map_err(|e| e.to_string())?;
    let mut all = Vec::new();
    for set in &sets {
        let content = numbers(set).map_err(|e| format!("{}: {e}", set.name()))?;
        all.push(FileVariable { name: set.name().to_owned(), content });
    }
    // What MATLAB keeps for itself begins with #.
    for inner in groups.iter().filter(|g| !g.name().starts_with('#')) {
        let content = if deepest == 0 {
            Content::Other("group in group in group".to_owned())
        } else {
            Content::Fields(members(inner, deepest - 1)?)
        };
        all.push(FileVariable { name: inner.name().to_owned(), content });
    }
    Ok(all)
}

fn numbers(set: &Dataset) -> Result<Content, Reason> {
    let class = set.attribute("MATLAB_class").ok().and_then(|a| a.read_string().ok()).unwrap_or_default();
    let text = class == "char" || class == "string";
    let (stored, order) = match set.dtype() {
        _ if text => return Ok(Content::Other("text".to_owned())),
        Datatype::FixedPoint { size, signed, byte_order } => {
            (Stored::Int { bytes: usize::from(*size), signed: *signed }, *byte_order)
        }
        Datatype::FloatingPoint { size, byte_order } => (Stored::Float { bytes: usize::from(*size) }, *byte_order),
        Datatype::Reference { .. } => return Ok(Content::Other("cells or an array of structs".to_owned())),
        Datatype::Compound { .. } => return Ok(Content::Other("complex or compound numbers".to_owned())),
        _ => return Ok(Content::Other("no numbers".to_owned())),
    };
    // An empty array of MATLAB is stored as its shape.
    if set.attribute("MATLAB_empty").is_ok() {
        return Ok(Content::Numbers { rows: 0, values: Vec::new() });
    }
    let bytes = set.read_raw_bytes().map_err(|e| e.to_string())?;
    let Some(values) = stored.decode(&bytes, order == ByteOrder::BigEndian) else {
        return Ok(Content::Other("numbers of an unusual size".to_owned()));
    };
    // HDF5 stores rows, MATLAB columns: the shape is the other way round, the order of the numbers the same.
    let shape = set.shape().iter().rev().map(|n| usize::try_from(*n)).collect::<Result<Vec<_>, _>>();
    Ok(Content::array(&shape.map_err(|e| e.to_string())?, values))
}
