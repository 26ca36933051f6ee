//! Exchanged labels of two runs. The fit is a compromise between both runs, so each run hides the fault of the other, and the scatter seems random.

use super::held_out::{REFUSE, SUSPECT, chance, recover_left_out};
use super::start::is_known;
use super::state::State;
use super::types::{LeftOut, Task};
use crate::finding::{Finding, Severity};
use crate::linalg::precision::Precision;
use crate::linalg::spd;

/// Smallest reduction factor of the residual for which runs are named as exchanged. A false exchange needs runs of different loads with similar
/// strain, hence gauges that hardly separate the loads. The residual then hardly falls.
const FEWER: f64 = 4.0;
/// Largest ratio between the residuals of two indistinguishable exchanges.
const AS_GOOD: f64 = 1.5;
/// Smallest share of the residual that an exchange must explain.
const WORTH_A_LOOK: f64 = 0.1;

/// Two runs whose labels are exchanged.
pub(super) struct LabelExchange {
    /// Numbers of the runs.
    pub runs: [usize; 2],
    /// Residual sum of squares of the runs before the exchange of the two labels, divided by the sum after the exchange.
    pub fewer: f64,
    /// Whether each run, recovered from all other runs, certainly contradicts its own label and agrees with the other label.
    pub certain: bool,
    /// Two other runs whose exchange explains the residual equally well.
    pub or: Option<[usize; 2]>,
}

/// Two used runs, by index among the used runs, and the residual of all runs after the exchange of their labels.
struct Pair {
    at: [usize; 2],
    left: f64,
}

/// Returns the exchange that explains most of the residual, if it explains enough.
pub(super) fn find(task: &Task, state: &State) -> Option<LabelExchange> {
    let (before, pairs) = left_by_pair(task, state)?;
    let best = pairs.iter().min_by(|a, b| a.left.total_cmp(&b.left))?;
    if before - best.left < WORTH_A_LOOK * before {
        return None;
    }
    let disjoint = |p: &&Pair| !p.at.iter().any(|i| best.at.contains(i));
    let second = pairs.iter().filter(disjoint);
    let second = second.min_by(|a, b| a.left.total_cmp(&b.left));
    let or = second.filter(|p| p.left < AS_GOOD * best.left);
    let numbers = |p: &Pair| p.at.map(|i| state.used[i]);
    let fewer = before / best.left.max(f64::MIN_POSITIVE);
    let certain = or.is_none() && is_certain(task, state, best.at, pairs.len());
    (certain || fewer > FEWER).then(|| LabelExchange {
        runs: numbers(best),
        fewer,
        certain,
        or: or.filter(|_| fewer > FEWER).map(numbers),
    })
}

/// Returns whether both runs, recovered from the other runs alone, are far from their own label and not from each other's.
fn is_certain(task: &Task, state: &State, at: [usize; 2], tried: usize) -> bool {
    let loads = at.map(|i| &task.runs[state.used[i]].loads);
    let far = |l: &LeftOut| chance(l, 1.0);
    let mut own = 1.0;
    for (me, other) in [(0, 1), (1, 0)] {
        let without = [at[other]];
        let stated = recover_left_out(task, state, at[me], &without, loads[me]);
        let exchanged = recover_left_out(task, state, at[me], &without, loads[other]);
        let (Some(stated), Some(exchanged)) = (stated, exchanged) else {
            return false;
        };
        if far(&exchanged) < SUSPECT {
            return false;
        }
        own *= far(&stated);
    }
    own * (tried as f64) < REFUSE
}

/// Returns the residual sum of squares of all runs by least squares, and its value with each pair of different known loads exchanged.
///
/// `X` are the loads by run, `Y` the strain, `G = X'X` and `B = X'Y`. An exchange of rows `i` and `j` of `X` does not change `G` and adds
/// `(x_i - x_j)(y_j - y_i)'` to `B`. The residual is `|Y|^2 - tr(B' G^-1 B)`.
fn left_by_pair(task: &Task, state: &State) -> Option<(f64, Vec<Pair>)> {
    let (n, k) = (state.posterior.n, state.posterior.k);
    let known: Vec<bool> = (state.used.iter())
        .map(|r| is_known(&task.runs[*r], &state.scales))
        .collect();
    let x: Vec<Vec<f64>> = (state.used.iter().zip(&state.equations).zip(&known))
        .map(|((r, e), known)| match known {
            true => {
                let mean = task.runs[*r].loads.mean.iter();
                mean.zip(&state.scales).map(|(f, c)| f / c).collect()
            }
            false => e.phi.clone(),
        })
        .collect();
    // A missing reading is replaced by the prediction of S, so that it does not contribute to the residual.
    let y: Vec<Vec<f64>> = (state.used.iter().zip(&x))
        .map(|(r, x)| {
            let made = state.posterior.predict(x);
            let read = task.runs[*r].strain.iter().zip(made);
            read.map(|(y, p)| if y.is_finite() { *y } else { p })
                .collect()
        })
        .collect();
    let mut gram = vec![0.0; k * k];
    let mut both = vec![0.0; k * n];
    for (x, y) in x.iter().zip(&y) {
        spd::add_outer(&mut gram, x, 1.0);
        for (row, x) in both.chunks_exact_mut(n).zip(x) {
            row.iter_mut().zip(y).for_each(|(b, y)| *b += x * y);
        }
    }
    let values = spd::eigenvalues(&gram, k);
    if *values.first()? <= super::unknown_directions::SPANNED * values.last()? {
        return None;
    }
    let inverse = Precision::from_covariance(&gram, k)?;
    let column = |g: usize| -> Vec<f64> { (0..k).map(|l| both[l * n + g]).collect() };
    let explained = |g: usize| spd::dot(&column(g), &inverse.apply(&column(g)));
    let before = y.iter().map(|y| spd::dot(y, y)).sum::<f64>() - (0..n).map(explained).sum::<f64>();
    let mut pairs = Vec::new();
    for i in (0..x.len()).filter(|i| known[*i]) {
        for j in (0..i).filter(|j| known[*j] && x[*j] != x[i]) {
            let d: Vec<f64> = x[i].iter().zip(&x[j]).map(|(a, b)| a - b).collect();
            let e: Vec<f64> = y[j].iter().zip(&y[i]).map(|(a, b)| a - b).collect();
            let turned = inverse.apply(&d);
            let along: Vec<f64> = both.chunks_exact(n).map(|row| spd::dot(row, &e)).collect();
            let more = 2.0 * spd::dot(&turned, &along) + spd::dot(&turned, &d) * spd::dot(&e, &e);
            pairs.push(Pair {
                at: [j, i],
                left: (before - more).max(0.0),
            });
        }
    }
    Some((before, pairs))
}

/// Returns the finding on an exchange. Neither run is used if the exchange is certain. The finding is an error if two pairs are indistinguishable.
pub(super) fn finding(task: &Task, e: &LabelExchange) -> Finding {
    let names = |runs: [usize; 2]| runs.map(|r| task.runs[r].run.as_str());
    let [a, b] = names(e.runs);
    let subject = format!("{a}, {b}");
    let times = crate::units::number(e.fewer);
    let what = match e.or.map(names) {
        Some([c, d]) => format!(
            "the labels of runs `{a}` and `{b}`, or of `{c}` and `{d}`, are exchanged. With either pair exchanged back, the residual sum \
             of squares is {times} times smaller. The runs do not determine which pair it is, and S is wrong in both cases"
        ),
        None => format!(
            "the labels of runs `{a}` and `{b}` are exchanged: the strain of `{a}` fits the loads of `{b}`, and the strain of `{b}` the \
             loads of `{a}`. With the labels exchanged back, the residual sum of squares is {times} times smaller{}",
            match e.certain {
                true => ". Neither was used",
                false => ". Both were used unchanged, and S contains this error",
            }
        ),
    };
    let severity = match e.certain {
        true => Severity::Warning,
        false => Severity::Error,
    };
    Finding::new(
        severity,
        "runs-exchanged",
        subject,
        what,
        "correct the labels in the runs file, or exclude these runs with `[calibration] runs`",
    )
    .with_numbers(e.fewer, FEWER)
}
