//! Calls of the page: JSON in, JSON out.

use super::http::Response;
use super::session::{MovedGauge, PlanTexts, Session, ShownLayout};
use crate::estimate::NORMAL_95;
use crate::host::context::{Disk, Files};
use crate::host::fault::Faults;
use crate::job::Job;
use crate::report::gauge_table::gauges_text;
use crate::report::live::page_content;
use crate::units::{half_width, number};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::time::Instant;

/// Calls that read, and calls that act.
const GET: [&str; 2] = ["/job", "/alive"];
const POST: [&str; 6] = ["/place", "/move", "/cancel", "/save", "/report", "/reload"];

/// Returns whether the server has this call.
pub(super) fn is_call(target: &str) -> bool {
    GET.contains(&target) || POST.contains(&target)
}

/// A plan with gauges at other places.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Moved {
    picks: String,
    gauges: String,
    /// Table that was sent when the layout was chosen.
    #[serde(default)]
    placed: Option<String>,
    moved: Vec<MovedGauge>,
}

/// Answers a call.
pub(super) fn answer(session: &Session, method: &str, target: &str, body: &[u8]) -> Response {
    let expected = if GET.contains(&target) { "GET" } else { "POST" };
    if method != expected {
        return Response::refusal(405, &format!("the call is {expected}"));
    }
    let began = Instant::now();
    let answered = match target {
        "/job" => Ok(job_value(&session.job())),
        "/alive" => {
            Ok(json!({ "changed": session.seen.list_changed(), "working": session.is_working() }))
        }
        "/place" => with_body(body, |texts: PlanTexts| {
            let shown = session.place(&texts)?;
            layout_value(&shown, began, true)
        }),
        "/move" => with_body(body, |m: Moved| {
            let gauges = Some(m.gauges);
            let texts = PlanTexts {
                picks: m.picks,
                gauges,
            };
            layout_value(
                &session.move_gauges(&texts, m.placed, &m.moved)?,
                began,
                false,
            )
        }),
        "/save" => with_body(body, |texts: PlanTexts| {
            let saved = session.save(&texts)?;
            let faults = saved.faults.map(Faults::into_list);
            Ok(json!({ "files": saved.files, "advice": saved.advice, "faults": faults }))
        }),
        "/report" => Ok(session.report().map(|(folder, summary)| {
            let report = folder.join("report.html").display().to_string();
            json!({ "report": report, "summary": summary })
        }))
        .and_then(in_faults),
        "/reload" => session
            .reload()
            .map(|()| job_value(&session.job()))
            .map_err(faults_value),
        _ => {
            session.cancel();
            Ok(json!({}))
        }
    };
    match answered {
        Ok(value) => Response::json(200, &value),
        Err((status, value)) => Response::json(status, &value),
    }
}

/// A refusal: status and JSON value.
type Refused = (u16, Value);

fn faults_value(faults: Faults) -> Refused {
    (422, json!({ "faults": faults.into_list() }))
}

fn in_faults(result: Result<Value, Faults>) -> Result<Value, Refused> {
    result.map_err(faults_value)
}

fn with_body<T: DeserializeOwned>(
    body: &[u8],
    act: impl FnOnce(T) -> Result<Value, Faults>,
) -> Result<Value, Refused> {
    let read = serde_json::from_slice(body);
    let read = read.map_err(|e| {
        (
            400,
            json!({ "refused": format!("the body is malformed: {e}") }),
        )
    })?;
    in_faults(act(read))
}

/// Describes the job and the files of its plan.
fn job_value(job: &Job) -> Value {
    let text = |name: &str| {
        let bytes = Disk.load(&job.folder.join(name)).ok()?;
        Some(String::from_utf8_lossy(&bytes).into_owned())
    };
    let (picked, gauges) = (job.picked_file(), job.gauges_file());
    let is_picked = job.candidates.file.as_ref().is_some_and(|f| f.is_toml());
    let is_gauges = job.gauge_file.is_some();
    json!({
        "job": job.file,
        "title": job.title,
        "picked": { "name": picked, "named": is_picked, "text": text(picked).filter(|_| is_picked) },
        "gauges": { "name": gauges, "named": is_gauges, "text": text(gauges).filter(|_| is_gauges) },
        "count": job.placement.gauges.unwrap_or(2 * job.loads.len()),
        "loads": job.loads.len(),
        "command": format!("strainbridge place {}", quote_path(&job.file)),
    })
}

/// Returns a path as a shell takes it.
fn quote_path(path: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-:+".contains(c);
    match path.chars().all(is_plain) {
        true => path.to_owned(),
        false => format!("\"{path}\""),
    }
}

/// Describes a layout, with its page if that is wanted.
fn layout_value(shown: &ShownLayout, began: Instant, with_page: bool) -> Result<Value, Faults> {
    let layout = &shown.layout;
    let loads = layout.load_sigma.iter().map(|l| {
        let half = NORMAL_95 * l.sigma();
        let share = layout.share_of_expected(l).map(|s| format!("{} %", number(100.0 * s)));
        json!({ "name": l.name, "half": half, "text": half_width(half), "unit": l.unit, "share": share })
    });
    let findings = layout.findings.iter().map(|f| {
        json!({ "severity": f.severity, "code": f.code, "subject": f.subject, "message": f.message })
    });
    let names: Vec<&str> = layout.gauges.iter().map(|g| &*g.name).collect();
    let mut value = json!({
        "gauges": gauges_text(layout)?,
        "names": names,
        "kept": shown.kept,
        "loads": loads.collect::<Vec<_>>(),
        "summary": layout.summary(),
        "efficiency": layout.efficiency_bound,
        "findings": findings.collect::<Vec<_>>(),
    });
    if let (true, Some(fields)) = (with_page, value.as_object_mut()) {
        fields.insert("page".to_owned(), json!(page_content(layout)));
    }
    if let Some(fields) = value.as_object_mut() {
        fields.insert("seconds".to_owned(), json!(began.elapsed().as_secs_f64()));
    }
    Ok(value)
}
