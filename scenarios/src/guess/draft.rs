//! scenarios: the text of a first campaign. In: what is read of each file. Out: TOML with a comment beside every guess.

use super::sheet::Found;
use super::{Attitude, Draft, DraftKind, Reading};
use crate::formats::stem;
use crate::run_columns::RUN_COLUMNS;
use std::fmt::Write as _;
use std::path::Path;

/// Longest line of comments.
const WIDE: usize = 120;

/// Name and content of the structure that a body in free flight begins with: drag, normal force, static moment and damping of a body of
/// revolution, and what a wing adds.
const STRUCTURE: (&str, &str) = (
    "body.toml",
    "# Terms of the coefficients of a body in free flight: take away what it has not, add what it has (docs/reference/keys.md).\n\
     parameters = [\"CA_0\", \"CN_a\", \"Cl_p\", \"Cm_a\", \"Cm_q\"]\n\n\
     [[term]]\ncoefficient = \"CA\"\nparameter = \"CA_0\"\nscale = 1.0\nfactors = [[\"cos_alpha_T\", 1]]\n\n\
     [[term]]\ncoefficient = \"CN\"\nparameter = \"CN_a\"\nscale = 1.0\nfactors = [[\"sin_alpha_T\", 1], [\"cos_phi\", 1]]\n\n\
     [[term]]\ncoefficient = \"CY\"\nparameter = \"CN_a\"\nscale = -1.0\nfactors = [[\"sin_alpha_T\", 1], [\"sin_phi\", 1]]\n\n\
     [[term]]\ncoefficient = \"Cl\"\nparameter = \"Cl_p\"\nscale = 1.0\nfactors = [[\"p_hat\", 1]]\n\n\
     [[term]]\ncoefficient = \"Cm\"\nparameter = \"Cm_a\"\nscale = 1.0\nfactors = [[\"sin_alpha_T\", 1], [\"cos_phi\", 1]]\n\n\
     [[term]]\ncoefficient = \"Cn\"\nparameter = \"Cm_a\"\nscale = -1.0\nfactors = [[\"sin_alpha_T\", 1], [\"sin_phi\", 1]]\n\n\
     [[term]]\ncoefficient = \"Cm\"\nparameter = \"Cm_q\"\nscale = 1.0\nfactors = [[\"q_hat\", 1]]\n\n\
     [[term]]\ncoefficient = \"Cn\"\nparameter = \"Cm_q\"\nscale = 1.0\nfactors = [[\"r_hat\", 1]]\n",
);

/// What no record of a model in a tunnel tells, and what must therefore agree.
const NOT_TOLD: &str = "\
# NOT TOLD by any record, and no fit notices it: where the roll of the body begins (which of its axes is y and which z), and whether the
# room is mirrored (left-handed axes). Give inertia_kg_m2, center_of_mass_m and places on the body along the very axes that [columns.axes]
# names: with y and z exchanged a wrong inertia or centre of mass would be found in their place.
";

/// The campaign of all readings, of which the first is in most of its tables.
pub(super) fn draft(kind: DraftKind, why: &str, all: &[Reading], not_read: &[String]) -> Draft {
    let Some(first) = all.first() else { return Draft { campaign: String::new(), structure: None } };
    let name = stem(&first.file).unwrap_or_else(|| "run".to_owned());
    let files = all.iter().map(|r| r.file.display().to_string()).collect::<Vec<_>>().join(", ");
    let mut out = comment("", &format!("A first campaign, made from {files}."));
    out += "# GUESS: read from the record, to be confirmed. FILL IN: no record tells it; nan is refused.\n";
    let _ = writeln!(out, "# Kind: {} ({why}).", kind.name());
    not_read.iter().for_each(|n| out += &comment("Left out: ", n));
    let whose = if all.len() > 1 { "the first file" } else { "the file" };
    first.notes.iter().for_each(|n| out += &comment(&format!("Of {whose}: "), n));
    let _ = write!(out, "\n[campaign]\nname = \"{}\"\nnote = \"made by windfall init\"\n\n", file_name(&name));
    match kind {
        DraftKind::Tunnel => tunnel(&mut out),
        DraftKind::FreeFlight => free_flight(&mut out),
        DraftKind::Point => point(&mut out, first),
        DraftKind::Pivot => pivot(&mut out),
    }
    columns(&mut out, kind, "columns", first, first);
    left_out(&mut out, whose, first);
    runs(&mut out, kind, all);
    let structure = (kind == DraftKind::FreeFlight).then(|| (STRUCTURE.0, STRUCTURE.1.to_owned()));
    Draft { campaign: out, structure }
}

/// Words as comments of at most [`WIDE`] characters.
fn comment(lead: &str, words: &str) -> String {
    let mut out = String::new();
    let mut line = format!("# {lead}");
    for word in words.split_whitespace() {
        if line.chars().count() + word.chars().count() >= WIDE && line.trim_end() != "#" {
            let _ = writeln!(out, "{}", line.trim_end());
            line = "#   ".to_owned();
        }
        line += word;
        line.push(' ');
    }
    let _ = writeln!(out, "{}", line.trim_end());
    out
}

/// A name that a campaign may have, of one that a file has.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' }).collect()
}

fn tunnel(out: &mut String) {
    *out += "# A body with attitude in a vertical wind tunnel. Body x out of the nose.\n";
    *out += NOT_TOLD;
    *out += "[vehicle]\nmass_kg = nan                                                              # FILL IN\ninertia_kg_m2 = { xx = nan, yy \
             = nan, zz = nan, xy = 0.0, xz = 0.0, yz = 0.0 }   # FILL IN; about the centre of mass\ncenter_of_mass_m = [0.0, 0.0, 0.0]   # \
             GUESS: at the tracked origin\nreference_diameter_m = nan          # FILL IN\n\n# Take the table out where the model flies \
             without a line.\n[tether]\nattachment_m = [nan, nan, nan]      # FILL IN; body axes, from the tracked origin\nring_m = [nan, \
             nan, nan]            # FILL IN; tunnel axes, X down\ndrag_area_m2 = nan                  # FILL IN\neffective_weight_n = nan  \
             \u{20}         # FILL IN\n\n[environment]\ngravity_m_s2 = 9.80665\ngas_constant_j_kg_k = 287.05287     # GUESS: dry \
             air\n\n[sensors]              # GUESS: thesis Table A.3; noise is learnt from the record\nposition_std_m = \
             7.5e-4\nroll_std_deg = 0.0623\npitch_yaw_std_deg = 0.110\nwind_std_m_s = 2.57e-3\n\n[aero.axisymmetric]    # GUESS: the \
             thesis' structure and starting points\nCA_T0 = 6.6\nCN_sin = 3.4\nCN_sin3 = -1.5\nCl_0 = 0.01\nCl_p = -5.0\nCm_sin = \
             -2.0\nCm_sin3 = 2.0\nCm_1 = -3.0\nCm_2 = -150.0\nCn_1 = -3.0\nCn_2 = -150.0\n";
}

fn free_flight(out: &mut String) {
    *out += "# A rigid body in free flight through air at rest. Body x out of the nose, z downward in level flight.\n";
    *out += NOT_TOLD;
    let _ = write!(
        out,
        "[vehicle]\nmass_kg = nan                       # FILL IN\ninertia_kg_m2 = {{ xx = nan, yy = nan, zz = nan, xy = 0.0, xz = 0.0, yz \
         = 0.0 }}   # FILL IN; about the centre of mass\ncenter_of_mass_m = [0.0, 0.0, 0.0]  # GUESS: at the tracked \
         origin\nreference_diameter_m = nan          # FILL IN; length that moments are of: chord, diameter\n\n[free_flight]\n\
         reference_area_m2 = nan             # FILL IN; area that coefficients are of\ncoefficient_axes = \"body\"           # or \
         wind\ncoefficients = \"fitted\"             # or held\nbuoyancy_kg = 0.0                   # GUESS: much heavier than \
         air\ncenter_of_buoyancy_m = [0.0, 0.0, 0.0]\nrate_damping_n_m_s = [0.0, 0.0, 0.0]\n\n[environment]\ngravity_m_s2 = \
         9.80665\nair_density_kg_m3 = 1.2             # GUESS: a room at 20 degC\n\n[sensors]                           # GUESS: noise is \
         learnt from the record\nposition_std_m = 5e-4\nroll_std_deg = 0.1\npitch_yaw_std_deg = 0.1\n\n[aero.body]                    \
         \u{20}    # GUESS: a body of revolution; {0} has its terms\nstructure = \"{0}\"\nCA_0 = 0.5\nCN_a = 2.0\nCl_p = -0.5\nCm_a = \
         -0.5\nCm_q = -5.0\n",
        STRUCTURE.0
    );
}

fn point(out: &mut String, first: &Reading) {
    let (down, why) = &first.down;
    let forces = first.columns.iter().any(|f| f.ours.starts_with('f'));
    let sensor = if forces { "specific_force_std_m_s2 = 0.02" } else { "position_std_m = 0.001       " };
    let _ = write!(
        out,
        "# A body without attitude.\n[vehicle]\nmass_kg = nan                 # FILL IN\nreference_diameter_m = nan    # FILL \
         IN\n\n[axes]\ndown = \"{down}\"   # {why}\n\n[environment]\ngravity_m_s2 = 9.80665\nair_density_kg_m3 = 1.2       # GUESS: a room \
         at 20 degC; over more than some hundred metres: atmosphere = \"us-1976\"\n\n[sensors]\n{sensor} # GUESS: noise is learnt from \
         the record\n\n[aero.point_mass]\nCD = 0.47                     # GUESS: a sphere\n"
    );
}

fn pivot(out: &mut String) {
    *out += "# A body on a pivot with a level axis. GUESS: the angle is zero where it hangs down.\n[vehicle]\nmass_kg = nan                 # FILL IN\nreference_diameter_m = nan    # \
             FILL IN\n\n[pivot]\narm_m = nan                   # FILL IN; from the axis to the mass centre\ninertia_kg_m2 = nan           \
             # FILL IN; about the mass centre\nviscous_n_m_s = 0.0           # GUESS: a bearing without friction\n\n[environment]\n\
             gravity_m_s2 = 9.80665\nair_density_kg_m3 = 1.2       # GUESS: a room at 20 degC\n\n[sensors]\nangle_std_deg = 0.01         \
             \u{20}# GUESS: noise is learnt from the record\n\n[aero.point_mass]\nCD = 0.47                     # GUESS: a sphere\n";
}

/// `[columns]` of one file; axes as `told` has them, which may be another file's that tells more.
fn columns(out: &mut String, kind: DraftKind, table: &str, r: &Reading, told: &Reading) {
    let plain = |f: &&Found| f.name == f.ours && f.unit == unit_of_ours(f.ours) && !f.why.contains('?');
    let differ: Vec<&Found> = r.columns.iter().filter(|f| !plain(f)).collect();
    let lacks: Vec<(&str, &str)> = [("VW_m_s", "nan"), ("ps_Pa", "101325.0"), ("Ts_K", "293.15")]
        .into_iter()
        .filter(|(ours, _)| kind == DraftKind::Tunnel && !r.columns.iter().any(|f| f.ours == *ours))
        .collect();
    if !differ.is_empty() || !lacks.is_empty() || table != "columns" {
        let _ = writeln!(out, "\n[{table}]");
    }
    for f in differ {
        let _ = writeln!(out, "{} = {{ name = {:?}, unit = {:?} }}   # {}", f.ours, f.name, f.unit, f.why);
    }
    for (ours, value) in lacks {
        let _ = writeln!(out, "{ours} = {value}   # FILL IN: no such column was seen; a column's name or one number");
    }
    let Some(attitude) = &r.attitude else { return };
    let own = ["x", "y", "z"].map(str::to_owned);
    let (tunnel, body, why) = told.axes.as_ref().map_or_else(
        || (&own, &own, "GUESS: as the file has them; its attitudes do not tell which way is down".to_owned()),
        |g| (&g.tunnel, &g.body, g.why.clone()),
    );
    let _ = write!(
        out,
        "\n[{table}.axes]   # which of the file's axes are tunnel X (down), Y, Z, and body x (nose), y, z\n{}# The body's y and z are a \
         GUESS: no record tells the roll's zero. They must be those of inertia and centre of mass.\ntunnel = {tunnel:?}\nbody = {body:?}\n",
        comment("", &why)
    );
    match attitude {
        Attitude::Quaternion(q) => {
            let (scalar, by) =
                (if q.last { "last" } else { "first" }, if q.told { "by the names" } else { "the names do not tell" });
            let _ = writeln!(
                out,
                "\n[{table}.attitude]\nquaternion = {:?}\nscalar = \"{scalar}\"   # GUESS: {by}\nrotates = \"body-to-world\"   # GUESS; or \
                 world-to-body",
                q.names
            );
        }
        Attitude::Euler(e) if e.names != ["Rx_deg", "Ry_deg", "Rz_deg"] => {
            let _ = writeln!(
                out,
                "\n[{table}.attitude]\neuler = {:?}\nsequence = \"{}\"   # GUESS: by the names; xyz and zyx are the usual ones, and check says how well either closes\nunit = \"{}\"   # {}\nrotates = \"body-to-world\"   # \
                 GUESS; or world-to-body",
                e.names, e.sequence, e.unit, e.why
            );
        }
        Attitude::Euler(_) => {}
    }
}

fn unit_of_ours(ours: &str) -> &'static str {
    RUN_COLUMNS.iter().find(|c| c.name == ours).map_or("", |c| c.quantity.ours().word)
}

/// Every column of a file that nothing reads, with what speaks against it.
fn left_out(out: &mut String, whose: &str, r: &Reading) {
    if r.left_out.is_empty() {
        return;
    }
    let _ = writeln!(out, "\n# Left out of {whose} (nothing reads them):");
    let plain: Vec<&str> = r.left_out.iter().filter(|l| l.why.is_empty()).map(|l| l.name.as_str()).collect();
    if !plain.is_empty() {
        *out += &comment("  ", &plain.join(", "));
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for l in r.left_out.iter().filter(|l| !l.why.is_empty()) {
        match reasons.iter_mut().find(|(why, _)| *why == l.why) {
            Some((_, names)) => names.push(&l.name),
            None => reasons.push((&l.why, vec![&l.name])),
        }
    }
    for (why, names) in reasons {
        *out += &comment("  ", &format!("{}: {why}", names.join(", ")));
    }
}

fn runs(out: &mut String, kind: DraftKind, all: &[Reading]) {
    let Some(first) = all.first() else { return };
    *out += if all.len() == 1 {
        "\n# Give every run its [[run]]; hold one out (use = \"hold-out\"): it alone says how well the model predicts.\n"
    } else {
        "\n# The last run is held out: it alone says how well the model predicts.\n"
    };
    for (i, r) in all.iter().enumerate() {
        let used = if i > 0 && i + 1 == all.len() { "hold-out" } else { "identify" };
        let _ = write!(
            out,
            "{}[[run]]\nfile = {:?}\nkind = \"{}\"   # GUESS: by the file's name\nuse = \"{used}\"   # {:.4} samples a second (GUESS: median \
             step)\n",
            if i > 0 { "\n" } else { "" },
            r.file.display().to_string(),
            kind_of(&r.file, kind),
            r.rate_hz
        );
        if let Some(s) = &r.still {
            let _ = writeln!(
                out,
                "window_s = {:?}   # GUESS: the longest stretch that moves; {} rows are exactly zero, {} repeat the row before",
                s.window_s, s.zero, s.frozen
            );
        }
        if i > 0 && !r.reads_like(first) {
            columns(out, kind, "run.columns", r, r);
            left_out(out, "this file", r);
        }
    }
}

/// The file's name without the number that ends it.
fn kind_of(file: &Path, kind: DraftKind) -> String {
    let name = stem(file).unwrap_or_default();
    let word = name.trim_end_matches(|c: char| c.is_ascii_digit() || "-_. ".contains(c));
    let usual = match kind {
        DraftKind::Tunnel => "perturbed",
        DraftKind::FreeFlight | DraftKind::Point => "launch",
        DraftKind::Pivot => "swing",
    };
    if word.is_empty() || word == "run" { usual.to_owned() } else { word.to_owned() }
}
