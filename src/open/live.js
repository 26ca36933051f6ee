// The live page. Its state is two texts, those of the files that "save" writes: the picks and the table of gauges.
const live = (name) => document.querySelector(`[data-live=${name}]`);
let token = location.hash.slice(1);
// About the job; the plan; plans before it; whether marks changed since the layout.
// `placed` is what the layout was chosen for: lists and table. The lists of the plan are newer while marks wait for "place again".
let job = null, plan = { lists: "", count: 0, keep: [], gauges: "", answer: null, placed: null };
const past = [];
let saved = { picks: "", gauges: "" }, working = 0, last = 0, shownLists = "";
// Why the picture is not the plan that "save" would write; empty if it is.
let waiting = "";

class Refused extends Error {}

async function call(target, body) {
  const options = { headers: { "x-strainbridge-token": token }, cache: "no-store" };
  if (body !== undefined) {
    options.method = "POST";
    options.headers["content-type"] = "application/json";
    options.body = JSON.stringify(body);
  }
  let response;
  try { response = await fetch(target, options); } catch { lose(); throw new Refused("connection lost"); }
  live("lost").hidden = true;
  const answer = await response.json();
  if (response.ok) return answer;
  showFaults(answer.faults || [{ wrong: answer.refused, remedy: "" }]);
  throw new Refused("refused");
}

// Text of the picks: the lists, then number of gauges and gauges that stay.
function picksOf(p) {
  if (!p.lists && p.count === job.count && !p.keep.length) return "";
  const keep = p.keep.length ? `keep = [${p.keep.map((name) => JSON.stringify(name)).join(", ")}]\n` : "";
  return (p.lists ? p.lists.trimEnd() + "\n\n" : "") + `[placement]\ngauges = ${p.count - p.keep.length}\n` + keep;
}
// The reverse, for a file that was saved before.
function readPicks(text, table) {
  const at = text.search(/^\[placement\]/m), lists = (at < 0 ? text : text.slice(0, at)).trim(), rest = at < 0 ? "" : text.slice(at);
  const n = /^gauges *= *(\d+)/m.exec(rest), kept = /^keep *= *(\[.*\]|".*")/m.exec(rest);
  let keep = [];
  try { keep = kept ? [JSON.parse(kept[1])].flat() : []; } catch { say("The list `keep` of the picks could not be read."); }
  // Words of a job: all gauges of its table.
  if (keep.length === 1 && keep[0] === "all") keep = table.trim().split("\n").slice(1).map((row) => row.split(",")[0]);
  return { lists: lists === "[candidates]" ? "" : lists, count: n ? +n[1] + keep.length : job.count, keep };
}
const texts = () => ({ picks: picksOf(plan), gauges: plan.gauges });

const say = (text) => { live("said").textContent = text; };
function lose() {
  const { picks, gauges } = job ? texts() : { picks: "", gauges: "" };
  live("lines").textContent = job ? `# ${job.picked.name}\n${picks}\n# ${job.gauges.name}\n${gauges}` : "";
  live("lost").hidden = false;
}
function showFaults(list) {
  const into = live("faults");
  into.replaceChildren(...list.map((f) => {
    const item = document.createElement("li"), place = [f.file, f.line].filter(Boolean).join(":");
    item.textContent = (place ? place + ": " : "") + (f.field ? f.field + ": " : "") + f.wrong + (f.remedy ? ". Remedy: " + f.remedy : "");
    return item;
  }));
  into.hidden = !list.length;
}

// Marks the picture as one of the plan before.
function setStale(text) { live("page").classList.add("stale"); say(text); }
async function busy(work) {
  working++;
  enable();
  const slow = setTimeout(() => setStale("Working: the picture shows the plan before. `cancel` stops the work."), 1000);
  showFaults([]);
  try { return await work(); } catch (e) {
    if (!(e instanceof Refused)) throw e;
    // The plan before is still the plan, unless marks wait.
    live("page").classList.toggle("stale", Boolean(waiting));
    say(waiting || "The work ended without a result. The picture shows the plan as it was.");
    return null;
  } finally {
    clearTimeout(slow);
    working--;
    enable();
  }
}
function enable() {
  const ready = Boolean(plan.answer) && !working && !waiting, now = job ? texts() : saved;
  // A report depends on the table of gauges only where gauges of it stay.
  const isOld = now.picks !== saved.picks || (plan.keep.length > 0 && now.gauges !== saved.gauges);
  for (const name of ["count", "place"]) live(name).disabled = !job || working > 0;
  live("rest").disabled = !plan.answer || working > 0;
  live("undo").disabled = working > 0 || !past.length;
  live("cancel").disabled = !working;
  live("save").disabled = !ready || (now.picks === saved.picks && now.gauges === saved.gauges);
  live("report").disabled = !ready || isOld;
}

const scenes = () => [...live("page").querySelectorAll("[data-figure]")].filter((f) => f.scene);
async function show(answer) {
  const before = scenes().map((f) => f.scene.camera), page = live("page");
  // The policy of this page refuses style attributes in a text of HTML, and allows them from its script.
  page.innerHTML = answer.page.replaceAll(' style="', ' data-style="');
  page.querySelectorAll("[data-style]").forEach((e) => { e.style.cssText = e.dataset.style; });
  // The model that is worked on comes first.
  const model = page.querySelector(".scene")?.closest("section");
  if (model) page.prepend(model);
  await all();
  page.classList.remove("stale");
  scenes().forEach((figure, n) => {
    const { camera, request } = figure.scene, old = before[n];
    if (old) { Object.assign(camera, { yaw: old.yaw, pitch: old.pitch, far: old.far, target: old.target }); request(); }
    figure.addEventListener("planned", planned);
    figure.addEventListener("moving", moved);
  });
  shownLists = listsNow();
  waiting = "";
  plan.answer = answer;
  plan.gauges = answer.gauges;
  live("command").textContent = job.command;
  showLoads(answer.loads);
  showKept();
  say(answer.summary);
}
const listsNow = () => { const pre = live("page").querySelector("[data-written=places] pre"); return pre ? pre.textContent : ""; };

function showLoads(loads) {
  const table = document.createElement("table"), best = new Map(plan.answer.loads.map((l) => [l.name, l]));
  const row = (cells, kind) => {
    const tr = document.createElement("tr");
    cells.forEach(([text, name]) => tr.append(Object.assign(document.createElement(kind), { textContent: text, className: name || "" })));
    return tr;
  };
  table.append(row([["load"], ["± 95 %"], ["unit"], ["best layout"], ["change"]], "th"));
  for (const l of loads) {
    const b = best.get(l.name), change = b && b.half > 0 ? 100 * (l.half / b.half - 1) : 0, words = (change > 0 ? "+" : "") + change.toFixed(1) + " %";
    table.append(row([[l.name], [l.text], [l.unit], [b ? b.text : ""], [words, change > 0.05 ? "worse" : change < -0.05 ? "better" : ""]], "td"));
  }
  live("loads").replaceChildren(table);
}
function showKept() {
  const ticked = new Set(plan.keep);
  live("kept").replaceChildren(...plan.answer.names.map((name) => {
    const label = document.createElement("label"), box = Object.assign(document.createElement("input"), { type: "checkbox", checked: ticked.has(name) });
    box.dataset.keep = name;
    label.append(box, " " + name);
    return label;
  }));
}
const tickedGauges = () => [...live("kept").querySelectorAll("input:checked")].map((b) => b.dataset.keep);

// Chooses gauges; `keep` are those that stay.
async function place(keep) {
  const before = { ...plan, lists: plan.placed ? plan.placed.lists : plan.lists }, next = { ...plan, keep, count: +live("count").value };
  if (next.count <= keep.length) return say("All gauges of this number stay: tick fewer gauges, or raise the number.");
  await busy(async () => {
    const table = keep.length ? plan.gauges : null, answer = await call("/place", { picks: picksOf(next), gauges: table });
    next.placed = { lists: next.lists, table };
    if (before.answer) past.push(before);
    plan = next;
    await show(answer);
    last = answer.seconds;
  });
}

// Marks and moves in the picture.
function planned() {
  const lists = listsNow();
  if (lists !== shownLists) {
    plan.lists = lists;
    shownLists = lists;
    waiting = "The marks changed: press `place again`.";
    setStale(waiting);
    enable();
  }
  moved();
}
const REFUSED_MOVE = "This place of the gauge was refused: move it elsewhere, or undo.";
const free = () => { if (waiting === REFUSED_MOVE) { waiting = ""; showFaults([]); } };
let moving = false, again = false, movedBefore = false;
async function moved() {
  if (moving) { again = true; return; }
  const at = scenes().flatMap((f) => f.scene.marks.filter((m) => m.moved).map((m) => ({ name: m.name, at: f.scene.world(m.at), side: m.side, along: m.along })));
  if (!at.length && !movedBefore) return;
  movedBefore = at.length > 0;
  moving = true;
  try {
    if (!at.length) { free(); plan.gauges = plan.answer.gauges; showLoads(plan.answer.loads); say(plan.answer.summary); } else {
      const of = { ...plan, lists: plan.placed.lists }, answer = await call("/move", { picks: picksOf(of), gauges: plan.answer.gauges, placed: plan.placed.table, moved: at });
      free();
      plan.gauges = answer.gauges;
      live("command").textContent = `${job.command}    # "installed" in result.json: the gauges of ${job.gauges.name}`;
      showLoads(answer.loads);
      showFaults(answer.findings.filter((f) => f.severity === "error").map((f) => ({ file: f.subject, wrong: f.message })));
      say(answer.summary);
      for (const box of live("kept").querySelectorAll("input")) if (at.some((m) => m.name === box.dataset.keep)) box.checked = true;
    }
  } catch (e) {
    if (!(e instanceof Refused)) throw e;
    // The picture shows a place for which there is no answer: it must not be saved as if it had one.
    waiting = waiting || REFUSED_MOVE;
    say(waiting);
  } finally {
    moving = false;
    enable();
    if (again) { again = false; moved(); }
  }
}

async function undo() {
  const before = past.pop();
  if (!before) return;
  const answer = before.answer;
  plan = before;
  live("count").value = plan.count;
  live("counted").textContent = plan.count;
  await show(answer);
  enable();
}
async function save() {
  await busy(async () => {
    const sent = texts(), answer = await call("/save", sent);
    saved = sent;
    showFaults(answer.faults || []);
    say(`Saved ${answer.files.join(" and ")}. ` + answer.advice.join(" "));
  });
}
async function report() {
  await busy(async () => {
    const answer = await call("/report", {});
    live("page").classList.toggle("stale", Boolean(waiting));
    say(`Written: ${answer.report}. ${answer.summary}`);
  });
}
function changes(list) {
  live("changes").textContent = `${list.join(", ")} changed on disk. `;
  live("changed").hidden = !list.length;
}
async function read(target, body) {
  await busy(async () => {
    const unsaved = plan.answer && picksOf(plan) !== saved.picks;
    job = await call(target, body);
    changes([]);
    if (plan.answer) waiting = "The job was read again: press `place again`.";
    document.title = `${job.title} · strainbridge`;
    live("command").textContent = job.command;
    // Changes that were not saved stay.
    if (!unsaved) Object.assign(plan, readPicks(job.picked.text || "", job.gauges.text || ""), { gauges: job.gauges.text || "" });
    const slider = live("count");
    slider.max = Math.max(40, 2 * plan.count);
    slider.min = 1;
    slider.value = plan.count;
    live("counted").textContent = plan.count;
    past.length = 0;
    saved = { picks: job.picked.text || "", gauges: job.gauges.text || "" };
    if (!saved.picks.replace("[candidates]", "").trim()) saved.picks = "";
  });
  if (job) await place(plan.keep);
  // Layouts of a model that was replaced are no plans.
  past.length = 0;
  enable();
}
async function beat() {
  try { changes((await call("/alive")).changed); } catch (e) { if (!(e instanceof Refused)) throw e; }
}

live("place").addEventListener("click", () => place([]));
live("rest").addEventListener("click", () => place(tickedGauges()));
live("undo").addEventListener("click", undo);
live("cancel").addEventListener("click", () => call("/cancel", {}).catch(() => {}));
live("save").addEventListener("click", save);
live("report").addEventListener("click", report);
live("reload").addEventListener("click", () => read("/reload", {}));
live("count").addEventListener("input", () => { live("counted").textContent = live("count").value; });
live("count").addEventListener("change", () => {
  if (last < 1) place(plan.keep); else setStale("The number changed: press `place again`, or keep gauges and place the rest.");
});
live("copy").addEventListener("click", async () => {
  const range = document.createRange();
  range.selectNodeContents(live("lines"));
  getSelection().removeAllRanges();
  getSelection().addRange(range);
  try { await navigator.clipboard.writeText(live("lines").textContent); } catch { document.execCommand("copy"); }
});
async function enter() {
  // A browser that the program started has a key that works once.
  if (token.startsWith("once-")) {
    try { token = (await call("/enter", {})).token; } catch (e) { if (e instanceof Refused) return; throw e; }
    history.replaceState(null, "", "#" + token);
  }
  read("/job");
  setInterval(beat, 5000);
}
if (token) enter(); else say("The address lacks its token: open the whole address that the program printed.");
