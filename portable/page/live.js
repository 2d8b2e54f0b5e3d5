// The joint in the hand: after a solution its bodies, loads and cartilage can be moved by sliders and numbers; the map and
// its numbers follow. Two workers keep the joint: one answers while the hand moves, one once it rests.
"use strict";

const Live = (() => {
  let place = null, hand = null, frame = null, base = [], workers = {}, rows = [], past = [], now = "";
  const number = (x, digits = 4) => (x === null || x === undefined ? "–" : String(Number(x.toPrecision(digits))).replace("-", "−"));

  function end() {
    for (const w of Object.values(workers)) w.end();
    workers = {};
    hand = null;
    if (place) place.remove();
    if (place && frame.contentWindow && frame.contentWindow.hold) frame.contentWindow.hold(null);  // the run's own states
    place = null;
  }
  async function copy() {
    try { await navigator.clipboard.writeText($("hand-line").textContent); } catch { getSelection().selectAllChildren($("hand-line")); document.execCommand("copy"); }
    $("hand-copy").textContent = "Copied";
    setTimeout(() => { if ($("hand-copy")) $("hand-copy").textContent = "Copy as command"; }, 1500);
  }

  // A slider and a number that say the same. `about`: { label, unit, least, most, step, start }.
  function row(about) {
    const id = `hand-${rows.length}`, { label, least, most, step, start } = about;
    const range = make("input", { type: "range", min: least, max: most, step, value: start, "aria-label": label });
    const typed = make("input", { type: "number", step: "any", value: start, id });
    const r = { about, get value() { return Number(typed.value); }, set value(x) { typed.value = range.value = String(x); }, element: null };
    range.addEventListener("input", () => { typed.value = range.value; hand.move(words()); });
    range.addEventListener("change", () => rested());
    typed.addEventListener("change", () => {
      if (typed.value.trim() === "" || !Number.isFinite(Number(typed.value))) r.value = start;
      range.value = typed.value;
      hand.set(words());
      rested();
    });
    r.element = make("div", { class: "handle" }, make("label", { for: id, text: label }), range, typed, make("span", { class: "about", text: about.unit || "" }));
    rows.push(r);
    return r.element;
  }

  // What dea run is told of where the hand is.
  function moved() {
    const out = [], of = (key) => rows.filter((r) => r.about.key === key);
    for (const r of of("turn")) if (r.value !== 0) out.push("--rotate", `${r.about.body}=${r.about.axis.join()},${r.value}`);
    for (const [key, option] of [["move", "--move"], ["force", "--force"]]) {
      const byBody = new Map();
      for (const r of of(key)) {
        if (!byBody.has(r.about.body)) byBody.set(r.about.body, { values: [], changed: false });
        const b = byBody.get(r.about.body);
        b.values.push(r.value);
        b.changed ||= r.value !== r.about.start;
      }
      for (const [body, b] of byBody) if (b.changed) out.push(option, `${body}=${b.values.join()}`);
    }
    for (const r of of("E")) if (r.value !== r.about.start) out.push("--E", `${r.about.surface}=${r.value}`);
    for (const r of of("thick")) if (r.value !== 1) out.push("--thickness-scale", String(r.value));
    return out;
  }
  const words = () => [...base, ...moved(), "--states", "last"];

  // Where the hand rested, to go back to.
  const places = () => JSON.stringify(rows.map((r) => r.value));
  function rested() {
    const at = places();
    if (at === now) return;
    past.push(now);
    now = at;
    $("hand-undo").disabled = false;
  }
  function go(at) {
    JSON.parse(at).forEach((x, i) => { rows[i].value = x; });
    now = at;
    hand.set(words());
  }
  function undo() {
    if (!past.length) return;
    go(past.pop());
    $("hand-undo").disabled = !past.length;
  }
  function reset() {
    rows.forEach((r) => { r.value = r.about.start; });
    rested();
    hand.set(words());
  }

  // `here`: the answer is of where the hand is.
  function show(answer, { quick, here }) {
    const text = answer.text, ok = !!text && text.solved;
    place.dataset.ask = String(answer.ask);
    place.dataset.exact = String(!quick && here);
    $("hand-what").textContent = !text ? "No answer" : !ok ? "No solution here" : quick && text.quick ? "Coarse, while it moves: springs of law linear" : here ? "Exact: what dea run gives" : "Exact, of a moment ago";
    place.classList.toggle("coarse", quick || !here);
    const remarks = text ? [...(ok ? [] : [text.state.message]), ...text.findings.filter((f) => f.severity !== "note").map((f) => f.text)] : answer.lines;
    $("hand-remarks").replaceChildren(...[...new Set(remarks)].filter(Boolean).map((t) => make("li", { text: t })));
    $("hand-seconds").textContent = `${Math.round(1000 * answer.seconds)} ms`;
    const head = ["contact", "p99", "mean", "area", "peak", "force"], body = [];
    if (ok)
      for (const c of text.state.contacts)
        body.push([c.name, ...["p99", "mean", "area", "peak"].map((k) => number(c.headline?.[k])), number(Math.hypot(...c.force))]);
    $("hand-numbers").replaceChildren(make("tr", {}, ...head.map((h) => make("th", { scope: "col", text: h }))),
      ...body.map((r) => make("tr", {}, ...r.map((c, i) => make(i ? "td" : "th", { scope: i ? null : "row", text: c })))));
    $("hand-bodies").textContent = ok ? text.bodies.map((b) => `${b.name}: moved by ${b.center.map((x, i) => number(x - b.reference_center[i], 3)).join(", ")}`).join("; ") : "";
    drawMap(ok ? answer : null, here ? (quick ? ", coarse" : "") : ", a moment ago");
  }

  // Into the page of the run: what is not solved has no map.
  function drawMap(answer, note) {
    const hold = frame && frame.contentWindow && frame.contentWindow.hold;
    if (!hold) return;
    const surfaces = new Map();
    if (answer) for (const s of answer.text.surfaces) surfaces.set(s.name, { values: answer.pressure.subarray(s.begin, s.begin + s.count), edge: s.edge ?? Infinity });
    hold({ note, surfaces });
  }

  // `info`: of dea info --json; `down`: is called once it is put down; `line`: words of the run without its outputs; `page`: the frame of the run's
  // page.
  function start(info, line, files, page, down) {
    end();
    frame = page;
    base = line;
    rows = [];
    past = [];
    const bodies = info.bodies.filter((b) => !b.ground), last = info.steps.at(-1), loads = last ? last.bodies : {};
    const contacts = info.contacts, reach = Math.max(...contacts.flatMap((c) => [c.primary, c.secondary]).map((s) => Math.sqrt(s.area)), 1);
    const groups = make("div", { class: "handles" });
    place = make("section", { id: "hand", "aria-label": "The joint in the hand" }, make("h2", { text: "In the hand" }),
      make("p", { class: "about", text: "Move a body, change its load or the cartilage: the map below follows. Coarse while a slider moves, exact once it rests: the numbers of the command line that stands below." }),
      groups);
    for (const b of bodies) {
      const of = make("details", { open: bodies.indexOf(b) === 0 }, make("summary", { text: b.name }));
      ["x", "y", "z"].forEach((axis, i) => of.append(row({ key: "turn", body: b.name, axis: [0, 1, 2].map((k) => (k === i ? 1 : 0)), label: `turn about ${axis}`, unit: "°", least: -15, most: 15, step: 0.1, start: 0 })));
      ["x", "y", "z"].forEach((axis) => of.append(row({ key: "move", body: b.name, label: `move along ${axis}`, unit: info.unit_names?.length || "", least: -0.05 * reach, most: 0.05 * reach, step: reach / 2000, start: 0 })));
      const force = loads[b.name] && loads[b.name].force;
      if (force && force.some((x) => x !== 0)) {
        const most = 2 * Math.hypot(...force);
        ["x", "y", "z"].forEach((axis, i) => of.append(row({ key: "force", body: b.name, label: `force along ${axis}`, unit: info.unit_names?.force || "", least: -most, most, step: most / 400, start: force[i] })));
      }
      groups.append(of);
    }
    const cartilage = make("details", {}, make("summary", { text: "Cartilage" }));
    const surfaces = new Set();
    for (const c of contacts)
      for (const s of [c.primary, c.secondary])
        if (s && !s.rigid && s.E > 0 && !s.part && !surfaces.has(s.surface)) {
          surfaces.add(s.surface);
          cartilage.append(row({ key: "E", surface: s.surface, label: `E of ${s.surface}`, unit: info.unit_names?.pressure || "", least: s.E / 4, most: 4 * s.E, step: s.E / 100, start: s.E }));
        }
    if (surfaces.size) {
      cartilage.append(row({ key: "thick", label: "thickness, times", least: 0.3, most: 2, step: 0.01, start: 1 }));
      groups.append(cartilage);
    }
    const command = make("pre", { id: "hand-line" });
    place.append(make("div", { class: "controls" }, make("button", { id: "hand-undo", text: "Undo", disabled: true, onclick: undo }), make("button", { id: "hand-reset", text: "Reset", onclick: reset }),
      make("button", { id: "hand-copy", text: "Copy as command", onclick: copy }), make("button", { id: "hand-down", text: "Put it down", onclick: () => { end(); down(); } }),
      make("b", { id: "hand-what", role: "status" }), make("span", { class: "about", id: "hand-seconds" })),
      make("ul", { id: "hand-remarks" }), make("div", { class: "wide" }, make("table", { id: "hand-numbers" })), make("p", { class: "about", id: "hand-bodies" }), command);
    frame.before(place);
    const failed = (text) => { $("hand-what").textContent = text; drawMap(null, ""); };
    for (const kind of ["quick", "exact"]) workers[kind] = Program.stay(files, (answer) => hand && hand.answered(answer), failed);
    hand = new Hand((q) => { $("hand-line").textContent = commandLine(words()); workers[q.quick ? "quick" : "exact"].ask(q); }, show);
    now = places();
    hand.set(words());
  }
  return { start, end, get hand() { return hand; }, get rows() { return rows; }, words };
})();
