//! scenarios: what `[columns]` does to a file, in words. In: the table as it was read, the file's columns. Out: lines.

use super::attitude::GivenAttitude;
use super::{ANGLES, Origin, Own, OwnAxes, QUATERNION};
use crate::columns::Columns;
use crate::run_columns::RUN_COLUMNS;

impl Own {
    /// Where each of our columns comes from, in which unit; how axes and attitude are turned; what nothing reads.
    pub(crate) fn told(&self, file: &Columns, is_read: impl Fn(&str) -> bool) -> Vec<String> {
        let taken = RUN_COLUMNS.iter().filter(|c| is_read(c.name));
        let one = |ours: &str, unit: &str| match self.origin(ours) {
            Some(Origin::Constant(value)) => Some(format!("{ours} = {value} {unit} in every row")),
            Some(Origin::Columns { parts, unit: from }) => Some(format!("{ours} from {} in {}", sum(parts), from.word)),
            None => {
                file.get(ours).map(|c| if is_one_number(c) { format!("{ours} ({} in every row)", c[0]) } else { ours.to_owned() })
            }
        };
        let read: Vec<String> = taken.filter_map(|c| one(c.name, c.quantity.ours().word)).collect();
        let mut all = vec![format!("read: {}", read.join(", "))];
        let turned = self.attitude.is_some() || self.axes != OwnAxes::default();
        if turned {
            all.push(self.axes_told());
        }
        if let Some(a) = &self.attitude {
            let way = if a.to_body { "world to body" } else { "body to world" };
            all.push(match &a.given {
                GivenAttitude::Quaternion([w, x, y, z]) => {
                    format!("attitude: quaternion with the real part {w} and the parts {x}, {y}, {z}, {way}")
                }
                GivenAttitude::Euler { angles, axes, unit } => {
                    let sequence: String = axes.iter().map(|k| ["x", "y", "z"][*k]).collect();
                    format!("attitude: angles {} in {}, sequence {sequence}, {way}", angles.join(", "), unit.word)
                }
            });
        }
        let used = self.used();
        let ours = |n: &str| is_read(n) && self.origin(n).is_none();
        let made = |n: &str| self.attitude.is_some() && ANGLES.contains(&n);
        let idle = |n: &&String| !used.contains(&n.as_str()) && (!ours(n) || made(n)) && !QUATERNION.contains(&n.as_str());
        let rest: Vec<&str> = file.names().iter().filter(idle).map(String::as_str).collect();
        if !rest.is_empty() {
            all.push(format!("not read: {}", rest.join(", ")));
        }
        if !file.left_out().is_empty() {
            all.push(format!("no plain numbers, not read: {}", file.left_out().join(", ")));
        }
        all
    }
    fn axes_told(&self) -> String {
        let words = |rows: [[f64; 3]; 3]| {
            let word = |row: [f64; 3]| {
                let k = row.iter().position(|x| x.abs() > 0.5).unwrap_or(0);
                format!("{}{}", if row[k] < 0.0 { "-" } else { "" }, ["x", "y", "z"][k])
            };
            rows.map(word).join(", ")
        };
        format!(
            "axes: tunnel X (down), Y, Z are the room's {}; body x (nose), y, z are the body's {}",
            words(self.axes.room),
            words(self.axes.body)
        )
    }
}

/// The columns of a sum with their weights, or the one column.
fn sum(parts: &[(String, f64)]) -> String {
    match parts {
        [(name, _)] => name.clone(),
        all => all.iter().map(|(name, weight)| format!("{weight:+.4} {name}")).collect::<Vec<_>>().join(" "),
    }
}

/// Whether a column of several rows never changes.
fn is_one_number(c: &[f64]) -> bool {
    c.len() > 1 && c[0].is_finite() && c.windows(2).all(|w| w[0].to_bits() == w[1].to_bits())
}
