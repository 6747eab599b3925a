//! scenarios: aerodynamic structures. In: `[aero.<name>]` and structure files. Out: a structure with values.

use crate::error::ReadError;
use crate::keys;
use crate::limits;
use crate::names::is_file_name;
use crate::table::{Source, Table, Value, nearest, number};
use std::path::Path;
use toml::de::DeValue;
use windfall_model::{Aero, Coefficient, CoefficientTable, Contribution, Factor, Structure, Term, Variable};

/// Largest size of a parameter's value.
const LARGEST: f64 = 1e9;

/// What `[aero.<name>]` says.
pub(crate) struct DeclaredAero {
    pub(crate) aero: Aero,
    pub(crate) declared: Vec<bool>,
    /// As written in the file.
    pub(crate) structure_file: Option<String>,
    /// C_D of a point mass over Mach number, which its parameter is a factor of.
    pub(crate) drag_over_mach: Option<CoefficientTable>,
}

/// Reads the one table under `[aero]`. In a campaign (`zero_undeclared`) parameters that are not declared are zero.
pub(crate) fn read_aero(file: &Table<'_>, zero_undeclared: bool) -> Option<DeclaredAero> {
    let source = file.source;
    let outer = file.table_named("aero", &keys::AERO)?;
    let mut models = outer.entries();
    let (Some((name, body)), None) = (models.next(), models.next()) else {
        source.fault(
            Some(outer.span.clone()),
            "[aero]",
            "",
            "must hold exactly one model",
            "[aero.axisymmetric], [aero.point_mass], or [aero.<name>] with structure = \"file.toml\"",
        );
        return None;
    };
    let name = name.get_ref().as_ref();
    let Some(table) = body.get_ref().as_table() else {
        source.fault(
            Some(body.span()),
            format!("[aero] {name}"),
            source.snippet(body.span()),
            "must be a table",
            "[aero.axisymmetric]",
        );
        return None;
    };
    let t = Table::new(source, &format!("aero.{name}"), table, body.span(), &keys::AERO);
    let (mut structure, structure_file) = structure_of(&t, name)?;
    let drag = if structure == Structure::point_mass() { crate::point_body::drag_table(&t, zero_undeclared)? } else { None };
    if drag.is_some() {
        structure.parameters = vec!["CD_scale".to_owned()];
    }
    let declared = declared_of(&t, &structure);
    let values = if drag.is_some() { vec![1.0] } else { values_of(&t, &structure, &declared, zero_undeclared) };
    Some(DeclaredAero { aero: Aero::new(structure, values), declared, structure_file, drag_over_mach: drag })
}

fn structure_of(t: &Table<'_>, name: &str) -> Option<(Structure, Option<String>)> {
    let given = t.entries().find(|(k, _)| k.get_ref() == "structure").map(|(_, v)| v);
    match (name, given) {
        (_, Some(v)) => {
            let Some(file) = v.get_ref().as_str() else {
                t.source.fault(
                    Some(v.span()),
                    t.full("structure"),
                    t.source.snippet(v.span()),
                    "must be a file name in quotes",
                    "",
                );
                return None;
            };
            if !is_file_name(name) {
                let what = "must be of letters, digits, - _ . (it becomes a file name)";
                t.source.fault(Some(t.span.clone()), "[aero]", name, what, "[aero.lander]");
                return None;
            }
            let path = limits::beside(t.source, Some(v.span()), &t.full("structure"), file);
            if t.source.has_faults() {
                return None;
            }
            let bundled = t.source.bundled_table(file);
            let read = bundled.map_or_else(|| read_structure_as(&path, name), |text| structure_of_text(&path, text, name));
            match read {
                Ok(structure) => return Some((structure, Some(file.to_owned()))),
                Err(ReadError::Faults(faults)) => t.source.add(&faults),
                Err(e) => t.source.fault(Some(v.span()), t.full("structure"), file, e.to_string(), "a path beside this file"),
            }
            None
        }
        ("axisymmetric", None) => Some((Structure::axisymmetric(), None)),
        ("point_mass", None) => Some((Structure::point_mass(), None)),
        (other, None) => {
            let what = "unknown aerodynamic model; known: axisymmetric, point_mass, or any name with structure = \"file.toml\"";
            let try_ = nearest(other, &["axisymmetric", "point_mass"]).unwrap_or("structure = \"file.toml\"");
            t.source.fault(Some(t.span.clone()), format!("[aero.{other}]"), "", what, try_);
            None
        }
    }
}

fn declared_of(t: &Table<'_>, structure: &Structure) -> Vec<bool> {
    let Some((_, list)) = t.entries().find(|(k, _)| k.get_ref() == "declared") else {
        return vec![true; structure.parameters.len()];
    };
    let mut declared = vec![false; structure.parameters.len()];
    let Some(words) = list.get_ref().as_array() else {
        t.source.fault(
            Some(list.span()),
            t.full("declared"),
            t.source.snippet(list.span()),
            "must be a list of parameter names",
            "[]",
        );
        return declared;
    };
    for word in words {
        match word.get_ref().as_str().and_then(|w| structure.index(w)) {
            Some(i) if declared[i] => {
                let value = t.source.snippet(word.span());
                t.source.fault(Some(word.span()), t.full("declared"), value, "appears twice", "name each parameter once");
            }
            Some(i) => declared[i] = true,
            None => t.source.fault(
                Some(word.span()),
                t.full("declared"),
                t.source.snippet(word.span()),
                format!("is no parameter of this structure; parameters: {}", structure.parameters.join(", ")),
                "one of these, in quotes",
            ),
        }
    }
    declared
}

fn values_of(t: &Table<'_>, structure: &Structure, declared: &[bool], zero_undeclared: bool) -> Vec<f64> {
    let mut allowed: Vec<&str> = structure.parameters.iter().map(String::as_str).collect();
    let fixed = ["declared", "structure"];
    let mut values = vec![None; allowed.len()];
    for (key, value) in t.entries().filter(|(k, _)| !fixed.contains(&k.get_ref().as_ref())) {
        match structure.index(key.get_ref()) {
            None => {
                allowed.extend(fixed);
                t.unknown(key, value, &allowed);
                allowed.truncate(structure.parameters.len());
            }
            Some(i) => values[i] = Some(finite(t, key.get_ref(), value)),
        }
    }
    for (i, name) in structure.parameters.iter().enumerate() {
        if values[i].is_none() && (declared[i] || !zero_undeclared) {
            let what = "is missing (starting value of a declared parameter)";
            t.source.fault(t.at(name), t.full(name), "", what, format!("{name} = ..., or leave it out of `declared`"));
        }
    }
    values.iter().zip(declared).map(|(v, d)| if zero_undeclared && !d { 0.0 } else { v.unwrap_or(0.0) }).collect()
}

fn finite(t: &Table<'_>, name: &str, at: Value<'_>) -> f64 {
    match number(at) {
        Some(x) if x.is_finite() && x.abs() <= LARGEST => x,
        _ => {
            let what = format!("must be a finite number from -{LARGEST:e} to {LARGEST:e}");
            t.source.fault(Some(at.span()), t.full(name), t.source.snippet(at.span()), what, "a number");
            0.0
        }
    }
}

/// Reads a structure file: `parameters = [...]` and `[[term]]` tables with `coefficient`, `parameter`, `scale`, `factors`.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_structure(path: &Path) -> Result<Structure, ReadError> {
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    read_structure_as(path, &name)
}

fn read_structure_as(path: &Path, name: &str) -> Result<Structure, ReadError> {
    structure_of_text(path, &crate::open::text_of(path)?, name)
}

fn structure_of_text(path: &Path, text: &str, name: &str) -> Result<Structure, ReadError> {
    let source = Source::new(path, text);
    let root = source.parse()?;
    let file = Table::new(&source, "", &root, 0..0, &keys::STRUCTURE_FILE);
    let parameters = words(&file, "parameters");
    let contributions: Vec<Contribution> = file.tables(&keys::TERM).iter().filter_map(|t| contribution(t, &parameters)).collect();
    unused(&file, &parameters, &contributions);
    source.finish(Some(Structure { name: name.to_owned(), parameters, contributions }))
}

/// A parameter that no term has moves nothing and can never be identified.
fn unused(file: &Table<'_>, parameters: &[String], contributions: &[Contribution]) {
    if file.source.has_faults() {
        return;
    }
    for (i, name) in parameters.iter().enumerate().filter(|(i, _)| contributions.iter().all(|c| c.parameter != *i)) {
        let what = "is in no [[term]], so that it moves nothing";
        let remedy = format!("remove it, or add a [[term]] with parameter = \"{name}\"");
        file.source.fault(file.at("parameters"), format!("parameters[{i}]"), name, what, remedy);
    }
}

fn words(file: &Table<'_>, name: &str) -> Vec<String> {
    let Some(at) = file.value(name) else { return Vec::new() };
    let mut all: Vec<String> = Vec::new();
    for v in at.get_ref().as_array().into_iter().flatten() {
        match v.get_ref().as_str() {
            Some(w) if !w.is_empty() && !all.iter().any(|a| a == w) && w != "declared" && w != "structure" => {
                all.push(w.to_owned())
            }
            _ => {
                let what = "must be a name in quotes, each once, and not `declared` or `structure`";
                file.source.fault(Some(v.span()), file.full(name), file.source.snippet(v.span()), what, "");
            }
        }
    }
    if all.is_empty() {
        let at_text = file.source.snippet(at.span());
        file.source.fault(Some(at.span()), file.full(name), at_text, "must be a list of one name or more", "[\"CA_0\"]");
    }
    all
}

fn contribution(t: &Table<'_>, parameters: &[String]) -> Option<Contribution> {
    let coefficient = t.choice("coefficient").map(|i| Coefficient::ALL[i]);
    let named = t.text("parameter");
    let parameter = parameters.iter().position(|p| *p == named);
    if parameter.is_none() && !named.is_empty() {
        let list: Vec<&str> = parameters.iter().map(String::as_str).collect();
        let what = format!("is not in `parameters`: {}", list.join(", "));
        t.source.fault(
            t.at("parameter"),
            t.full("parameter"),
            named.clone(),
            what,
            nearest(&named, &list).unwrap_or("add it there"),
        );
    }
    let scale = t.number("scale");
    let list = t.value("factors")?;
    let mut factors = Vec::new();
    match list.get_ref().as_array() {
        Some(all) => {
            for v in all {
                match factor(v.get_ref()) {
                    Some(f) => factors.push(f),
                    None => bad_factor(t, v),
                }
            }
        }
        None => bad_factor(t, list),
    }
    Some(Contribution { coefficient: coefficient?, parameter: parameter?, term: Term { scale, factors } })
}

fn bad_factor(t: &Table<'_>, v: Value<'_>) {
    let names: Vec<&str> = Variable::ALL.iter().map(|v| v.name()).collect();
    t.source.fault(
        Some(v.span()),
        t.full("factors"),
        t.source.snippet(v.span()),
        format!(
            "must be [\"variable\", power 1 to 9], {{ bump = \"variable\", width = above 0 }}, {{ sin_clock = 1 to 99 }} or {{ cos_clock \
             = 1 to 99 }}; variables: {}",
            names.join(", ")
        ),
        "[[\"sin_alpha_T\", 1], [\"cos_phi\", 1]]",
    );
}

fn factor(v: &DeValue<'_>) -> Option<Factor> {
    if let Some(pair) = v.as_array() {
        let (Some(name), Some(power), 2) = (pair.first(), pair.get(1), pair.len()) else { return None };
        return Some(Factor::Power(Variable::from_name(name.get_ref().as_str()?)?, whole(power, 9)?));
    }
    let t = v.as_table()?;
    let only = |names: &[&str]| t.len() == names.len() && names.iter().all(|n| t.contains_key(*n));
    if only(&["sin_clock"]) {
        return Some(Factor::SinClock(whole(t.get("sin_clock")?, 99)?));
    }
    if only(&["cos_clock"]) {
        return Some(Factor::CosClock(whole(t.get("cos_clock")?, 99)?));
    }
    let width_key = ["width", "width_rad"].into_iter().find(|w| only(&["bump", w]))?;
    let width = number(t.get(width_key)?).filter(|w| w.is_finite() && *w > 0.0)?;
    Some(Factor::Bump(Variable::from_name(t.get("bump")?.get_ref().as_str()?)?, width))
}

fn whole(v: Value<'_>, most: u8) -> Option<u8> {
    let i = v.get_ref().as_integer()?;
    u8::from_str_radix(i.as_str(), i.radix()).ok().filter(|n| (1..=most).contains(n))
}
