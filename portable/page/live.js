// The joint in the hand: after a solution its bodies, loads and cartilage can be moved by sliders, numbers and handles on
// the map; the map and its numbers follow. Two workers keep the joint: one answers while the hand moves, one once it rests.
"use strict";

const Live = (() => {
  let place = null, hand = null, frame = null, base = [], workers = {}, rows = [], past = [], now = "", about = null;
  let shown = null;   // what is drawn: { answer, words, quick, here }
  let kept = null;    // beside it: { answer, words }
  let names = null;   // of units
  let ends = [];      // times of the run's states
  let sides = [], reach = 1;  // of all contacts, and how large the largest is
  let fail = null;    // what is done when a worker has ended
  const number = (x, digits = 4) => (x === null || x === undefined ? "–" : String(Number(x.toPrecision(digits))).replace("-", "−"));
  const kQuantities = ["p99", "mean", "area", "peak"];

  function end() {
    Plan.end();
    for (const w of Object.values(workers)) w.end();
    workers = {};
    if (hand) hand.stop();
    hand = shown = kept = null;
    if (place) { place.parentElement.classList.remove("holding"); place.remove(); }
    if (place && frame.contentWindow && frame.contentWindow.hold) frame.contentWindow.hold(null);  // the run's own states
    place = null;
  }

  // ---- rows: what the hand can change, each { about, value, element } ----

  // A slider and a number that say the same. `what`: { key, label, unit, least, most, step, start }, and whose it is.
  function row(what) {
    const id = `hand-${rows.length}`, { label, least, most, step, start } = what;
    // the model's own value is one of the slider's steps
    const below = Math.ceil((start - least) / step - 1e-9), above = Math.ceil((most - start) / step - 1e-9), round = (x) => Number(x.toPrecision(7));
    const range = make("input", { type: "range", min: -below, max: above, step: 1, value: 0, "aria-label": what.whose ? `${what.whose}: ${label}` : label });
    const typed = make("input", { type: "number", step: "any", value: start, id, "aria-label": range.getAttribute("aria-label") });
    const place = (x) => { range.value = String(Math.round((x - start) / step)); range.setAttribute("aria-valuetext", `${number(x)} ${what.unit || ""}`.trim()); };
    const r = { about: what, get value() { return Number(typed.value); }, set value(x) { typed.value = String(x); place(x); }, element: null };
    place(start);
    range.addEventListener("input", () => { r.value = range.value === "0" ? start : round(start + Number(range.value) * step); follow(r); moved(); });
    range.addEventListener("change", () => rested());
    typed.addEventListener("change", () => {
      const empty = typed.value.trim() === "" || !Number.isFinite(Number(typed.value));
      r.value = empty ? start : what.key === "size" ? Math.max(0, r.value) : r.value;
      if (empty && what.key === "size") of("force", what.whose).forEach((p) => { p.value = p.about.start; }); else follow(r);
      moved(true);
      rested();
    });
    r.element = make("div", { class: "handle" }, make("label", { for: id, text: label }), range, typed, make("span", { class: "about", text: what.unit || "" }));
    rows.push(r);
    return r.element;
  }
  // A word of several. `what`: { key, label, words: [[value, text]], start, like: what else may be typed }.
  function choice(what) {
    const id = `hand-${rows.length}`, options = what.words.map(([value, text]) => make("option", { value, text }));
    const control = what.like ? make("input", { type: "text", id, list: id + "-list", spellcheck: "false" }) : make("select", { id }, ...options);
    control.value = what.start;
    const r = { about: what, get value() { return control.value; }, set value(x) { control.value = x; }, element: null };
    control.addEventListener("change", () => {
      if (what.like) control.value = control.value.replaceAll(" ", "");
      const wrong = what.like && !what.like.test(control.value) ? control.value : "";
      if (wrong) control.value = what.start;
      moved(true);
      rested();
      if (wrong) $("hand-other").textContent = `${what.label}: found "${wrong}", expected sphere-center, com or a point x,y,z`;
    });
    r.element = make("div", { class: "handle" }, make("label", { for: id, text: what.label }), control, what.like ? make("datalist", { id: id + "-list" }, ...options) : null);
    rows.push(r);
    return r.element;
  }
  const of = (key, whose) => rows.filter((r) => r.about.key === key && (whose === undefined || r.about.whose === whose));
  const one = (key, whose) => of(key, whose)[0];
  const length = (body) => Math.hypot(...of("force", body).map((r) => r.value));
  const along = (force) => { const l = Math.hypot(...force); return force.map((x) => x / l); };
  const modelForce = (body) => of("force", body).map((r) => r.about.start);
  // Of the force on a body; of the model's where there is none.
  const direction = (body) => along(length(body) > 0 ? of("force", body).map((r) => r.value) : modelForce(body));
  // A force of this size; the model's own to its last digit.
  function sized(body, size) {
    const now = direction(body), model = modelForce(body), own = along(model);
    if (size === one("size", body).about.start && now.every((x, i) => Math.abs(x - own[i]) < 1e-6)) return model;
    return now.map((x) => Number((size * x).toPrecision(6)));
  }

  // A force has three numbers and a size: one follows the other.
  function follow(r) {
    const body = r.about.whose;
    if (r.about.key === "size") {
      const force = sized(body, r.value);
      of("force", body).forEach((p, i) => { p.value = force[i]; });
    } else if (r.about.key === "time") {
      r.value = Math.min(r.about.most, Math.max(0, Math.round(r.value)));
      r.element.lastChild.textContent = `time ${number(r.about.times[r.value])}`;
    } else if (r.about.key === "force") {
      one("size", body).value = Number(length(body).toPrecision(6));
    }
  }

  // ---- words ----

  // Those of the run without what the hand says in their place.
  function without(list, option, key) {
    const out = [];
    for (let i = 0; i < list.length; ++i) {
      const split = list[i] === option, whole = list[i].startsWith(option + "=");
      const value = split ? list[i + 1] ?? "" : list[i].slice(option.length + 1);
      if ((split || whole) && (key === null || value.startsWith(key + "="))) { i += split ? 1 : 0; continue; }
      out.push(list[i]);
    }
    return out;
  }
  const axesOf = () => { const r = one("axes"); return r ? r.value : ""; };
  const text = (x) => String(Number(x));

  // Which state: of a run of all states "last" is as good, and tells more.
  function stateWord(index) {
    const all = !base.some((w) => /^--(states|settings)(=|$)/.test(w));
    return index === ends.length - 1 && all ? "last" : text(ends[index]);
  }

  // What dea run is told of where the hand is; `instead`: values of rows that are not theirs.
  function words(instead = new Map()) {
    const at = (r) => (instead.has(r) ? instead.get(r) : r.value), framed = axesOf() ? `frame:${axesOf()},` : "";
    let line = base, said = [];
    const say = (option, key, value) => { line = without(line, option, key); said.push(option, key === null ? value : `${key}=${value}`); };
    for (const body of new Set(of("turn").map((r) => r.about.whose))) {
      const turns = of("turn", body).filter((r) => at(r) !== 0), about = one("about", body);
      if (about.value !== about.about.said) say("--rotate-about", body, about.value);
      for (const r of turns) said.push("--rotate", `${body}=${framed}${r.about.axis.join()},${text(at(r))}`);
      const moves = of("move", body);
      if (moves.some((r) => at(r) !== 0)) said.push("--move", `${body}=${framed}${moves.map((r) => text(at(r))).join()}`);
      const size = one("size", body), force = instead.has(size) ? sized(body, instead.get(size)) : of("force", body).map(at);
      if (force.some((x, i) => x !== of("force", body)[i].about.start)) say("--force", body, force.map(text).join());
    }
    for (const option of ["E", "nu", "thickness-scale"]) for (const r of of(option)) if (at(r) !== r.about.start) say(`--${option}`, r.about.surface, text(at(r)));
    for (const r of of("law")) if (r.value !== r.about.start) say("--law", null, r.value);
    const time = one("time");
    return [...without(line, "--states", null), ...said, "--states", stateWord(time ? at(time) : ends.length - 1)];
  }

  // All that two rows leave as it is; of a force that one of them changes, the direction or nothing.
  function elsewhere(a, b) {
    const kin = (r, key) => [a, b].some((x) => x.about.key === key && x.about.whose === r.about.whose);
    return JSON.stringify(rows.map((r) => {
      if (r === a || r === b || (r.about.key === "size" && kin(r, "force"))) return null;
      if (r.about.key === "force" && kin(r, "size")) return direction(r.about.whose).map((x) => x.toFixed(4));
      return r.value;
    }));
  }

  // The hand has moved: what is drawn is of a place before. `rests`: it stays here.
  function moved(rests = false) {
    if (!hand) return;
    const line = words();
    $("hand-line").textContent = commandLine(line);
    if (shown) wasThere();
    if (rests) hand.set(line); else hand.move(line);
  }
  function wasThere() {
    shown.here = false;
    place.dataset.exact = "false";
    place.classList.add("coarse");
    $("hand-what").textContent = "Of a moment ago";
    $("hand-other").textContent = "";
    $("hand-keep").disabled = !kept;
    const hold = frame.contentWindow && frame.contentWindow.hold, now = handles(), drawn = JSON.stringify([now.map((h) => [h.at, h.axis, h.size, h.text]), noteOf(shown)]);
    if (hold && drawn !== wasThere.drawn) hold.handles(now, noteOf(shown));
    wasThere.drawn = drawn;
    Plan.follow();
  }
  const noteOf = (s) => (!s ? "" : s.here ? (s.quick ? ", coarse" : "") : ", a moment ago");

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
    of("time").forEach(follow);
    now = at;
    moved(true);
  }
  function undo() {
    if (!past.length) return;
    go(past.pop());
    $("hand-undo").disabled = !past.length;
  }
  function reset() {
    rows.forEach((r) => { r.value = r.about.start; });
    of("time").forEach(follow);
    rested();
    moved(true);
  }

  // ---- handles on the map ----

  const unit = (k) => [0, 1, 2].map((i) => (i === k ? 1 : 0));
  // Axes x, y, z in global directions.
  function axes() {
    const rowsOf = axesOf() && about.settings.frame && about.settings.frame[axesOf()];
    return rowsOf ? String(rowsOf).split("/").map((axis) => axis.split(",").map(Number)) : [0, 1, 2].map(unit);
  }
  // Where a body is turned about, as it is shown.
  function center(body) {
    const how = one("about", body).value, side = sides.find((s) => s.body === body);
    if (how === "sphere-center" && side) return side.sphere.center;
    const mass = about.bodies.find((b) => b.name === body).center_of_mass;
    return how.includes(",") ? how.split(",").map(Number) : mass;
  }
  // Does the force of the last step act at the time that is shown? Rows of a table come after it.
  function forceActs() {
    const time = one("time"), last = about.steps.at(-1);
    return !time || base.some((w) => /^--(loads|motion)(=|$)/.test(w)) || ends[time.value] > last.start;
  }
  const handleText = (key, axis, r) => (key === "move" ? axis : "") + (r.value === 0 ? "" : ` ${r.value > 0 ? "+" : ""}${number(r.value, 3)}${key === "turn" ? "°" : ""}`);
  function handles() {
    const body = $("hand-body").value;
    if (!body || !hand) return [];
    const at = center(body), xyz = axes(), out = [];
    for (const key of ["turn", "move"])
      xyz.forEach((axis, i) => out.push({ key: `${key} ${i}`, kind: key, body, row: of(key, body)[i], at, axis, colour: [1, 2, 0][i], text: handleText(key, "xyz"[i], of(key, body)[i]) }));
    const force = of("force", body).map((r) => r.value), l = length(body);
    if (l > 0 && forceActs()) out.push({ key: "load", kind: "load", body, at, axis: force.map((x) => x / l), size: Math.min(1, l / one("size", body).about.most), colour: null, text: `${number(l, 3)}${names?.force ? " " + names.force : ""}` });
    return out;
  }
  // Kept to steps that can be read.
  const stepped = (r, x) => { const step = r.about.step / 10; return Number((Math.round(x / step) * step).toPrecision(8)); };
  function dragged(handle, change, ended) {
    if (ended) { rested(); return; }
    if (handle.kind === "load") {
      const l = length(handle.body);
      of("force", handle.body).forEach((r, i) => { r.value = Number((l * change[i]).toPrecision(6)); });
    } else {
      // what is too small for a step is not lost
      const turn = handle.kind === "turn" ? 180 / Math.PI : 1, r = handle.row;
      if (dragged.row !== r || r.value !== dragged.value) dragged.exact = r.value;
      dragged.row = r;
      dragged.exact += change * turn;
      r.value = stepped(r, dragged.exact);
      dragged.value = r.value;
    }
    moved();
  }

  // ---- what is shown ----

  const surfacesOf = (answer) => new Map(answer && answer.text && answer.text.solved ? answer.text.surfaces.map((s) => [s.name, { values: answer.pressure.subarray(s.begin, s.begin + s.count), edge: s.edge ?? Infinity }]) : []);
  const rowsOf = (answer) => (answer && answer.text && answer.text.solved ? answer.text.state.contacts.map((c) => ({ name: c.name, values: [...kQuantities.map((k) => c.headline?.[k] ?? null), Math.hypot(...c.force)] })) : []);

  const settledWell = () => !!shown && !!hand && hand.settled && shown.here && !shown.quick && !!shown.answer.text && shown.answer.text.solved;

  // `here`: the answer is of where the hand is.
  function show(answer, { words, quick, here }) {
    const text = answer.text, ok = !!text && text.solved;
    shown = { answer, words, quick, here };
    place.dataset.ask = String(answer.ask);
    place.dataset.exact = String(!quick && here);
    $("hand-what").textContent = !text ? "No answer" : !ok ? (quick ? "No coarse solution here" : "No solution here") : quick ? "Coarse, while it moves" : here ? "Exact: what dea run gives" : "Exact, of a moment ago";
    place.classList.toggle("coarse", quick || !here);
    $("hand-keep").disabled = !kept && !settledWell();
    const found = text ? text.findings.filter((f) => f.severity !== "note").map((f) => f.text) : answer.lines;
    const remarks = [...(ok || !text || found.some((t) => t.includes(text.state.message)) ? [] : [text.state.message]), ...found];
    $("hand-remarks").replaceChildren(...[...new Set(remarks)].filter(Boolean).map((t) => make("li", { text: t })));
    if (quick || here) $("hand-other").textContent = "";
    $("hand-seconds").textContent = `${Math.round(1000 * answer.seconds)} ms`;
    numbers();
    $("hand-bodies").textContent = ok ? text.bodies.filter((b) => b.center.some((x, i) => x !== b.reference_center[i])).map((b) => `${b.name}: moved by ${b.center.map((x, i) => number(x - b.reference_center[i], 3)).join(", ")}`).join("; ") : "";
    // one sentence for those who hear the page, once the hand rests
    if (!quick && here) $("hand-said").textContent = ok ? rowsOf(answer).map((r) => `${r.name}: ${kQuantities.map((k, i) => `${k} ${number(r.values[i])}`).join(", ")}`).join("; ") : $("hand-what").textContent + ": " + remarks.join(" ");
    draw();
    Plan.follow();
  }
  function numbers() {
    const head = ["contact", ...kQuantities, "force"], body = [], rows = rowsOf(shown.answer), beside = kept ? rowsOf(kept.answer) : [];
    const put = (name, list, show = number) => body.push([name, ...list.map((x) => show(x))]);
    for (const r of rows) put(r.name, r.values, shown.quick ? (x) => (x === null ? "–" : "≈ " + number(x, 3)) : number);
    for (const r of beside) {
      put(beside.length > 1 ? `kept: ${r.name}` : "kept", r.values);
      const mine = rows.find((x) => x.name === r.name);
      if (mine) put("change", mine.values.map((x, i) => (x === null || !r.values[i] ? null : 100 * (x / r.values[i] - 1))), (x) => (x === null ? "–" : `${x > 0.05 ? "+" : ""}${(Math.abs(x) < 0.05 ? 0 : x).toFixed(1).replace("-", "−")} %`));
    }
    $("hand-numbers").replaceChildren(make("tr", {}, ...head.map((h) => make("th", { scope: "col", text: h }))),
      ...body.map((r) => make("tr", {}, ...r.map((c, i) => make(i ? "td" : "th", { scope: i ? null : "row", text: c })))));
  }
  // Into the page of the run: what is not solved has no map.
  function draw() {
    const hold = frame && frame.contentWindow && frame.contentWindow.hold;
    if (!hold) return;
    wasThere.drawn = "";
    hold({ note: noteOf(shown), surfaces: surfacesOf(shown && shown.answer), beside: kept ? surfacesOf(kept.answer) : null, handles: handles(), onhandle: dragged });
  }
  // Searched once more from where the hand left the bodies.
  function again(answer, exact) {
    const a = answer.text, b = exact.text;
    if (!a || !b) return;
    let words = "";
    if (a.solved && !b.solved) words = "Coming from where the hand was there is a balance here; dea run, which starts from the model, finds none.";
    if (a.solved && b.solved) {
      for (const body of a.bodies) {
        const other = b.bodies.find((o) => o.name === body.name), shift = Math.hypot(...body.center.map((x, i) => x - other.center[i]));
        const turn = Math.max(...body.rotation.flatMap((r, i) => r.map((x, j) => Math.abs(x - other.rotation[i][j]))));
        if (shift > 1e-3 * reach || turn > 1e-3) words = `Two balances: coming from where the hand was, ${body.name} would rest ${number(shift, 3)}${names?.length ? " " + names.length : ""} and ${number(turn * 180 / Math.PI, 3)}° from where dea run, which starts from the model, finds it. Shown is what dea run finds.`;
      }
    }
    $("hand-other").textContent = words;
    place.dataset.again = String(answer.ask);
  }

  // ---- beside, and as a file ----

  function keep() {
    if (!kept && !settledWell()) return;
    kept = kept ? null : { answer: shown.answer, words: shown.words };
    $("hand-keep").textContent = kept ? "Put the kept one away" : "Keep this beside";
    $("hand-kept").textContent = kept ? "Kept: " + commandLine(kept.words) : "";
    $("hand-keep").disabled = !kept && !settledWell();
    if (shown) numbers();
    draw();
  }
  async function saveCase(model, files) {
    const stem = model.replace(/\.[^.]*$/, ""), name = `${stem}_hand.feb`, list = without(words(), "--states", null);
    const answer = await Program.run(["convert", ...list.slice(1), "-o", name], files).done, made = answer.made && answer.made.find((m) => m.name === name);
    if (!place) return;
    $("hand-other").textContent = made ? answer.output.split("\n").filter(Boolean).at(-1) || "" : [answer.fault, ...answer.lines, "Copy as command gives a line that does the same with dea run."].filter(Boolean).join(" ");
    if (made) save(name, made.blob);
  }

  // `info`: of dea info --json; `line`: words of the run without its outputs; `times`: of its states; `page`: the frame of the run's page;
  // `down`: is called once it is put down.
  function start(info, line, files, times, page, down) {
    end();
    frame = page;
    about = info;
    names = info.unit_names;
    ends = times;
    base = line;
    rows = [];
    past = [];
    const bodies = info.bodies.filter((b) => !b.ground), last = info.steps.at(-1), loads = last ? last.bodies : {};
    const contacts = info.contacts;
    sides = contacts.flatMap((c) => [c.primary, c.secondary]).filter(Boolean);
    reach = Math.sqrt(Math.max(0, ...sides.map((s) => s.area))) || 1;
    const groups = make("div", { class: "handles" }), frames = Object.keys(info.settings.frame || {});
    const general = make("details", { open: times.length > 1 }, make("summary", { text: times.length > 1 ? "Time, law and axes" : "Law and axes" }));
    if (times.length > 1) general.append(row({ key: "time", label: "state", unit: "", least: 0, most: times.length - 1, step: 1, start: times.length - 1, times }));
    const law = contacts[0].law;
    general.append(choice({ key: "law", label: "law", words: ["layer", "linear", "logarithmic", "neo-Hookean"].map((w) => [w, w]), start: law }));
    if (frames.length) general.append(choice({ key: "axes", label: "axes of turns and moves", words: [["", "global"], ...frames.map((f) => [f, f])], start: "" }));
    place = make("section", { id: "hand", "aria-label": "The joint in the hand" }, make("h2", { text: "In the hand" }),
      make("p", { class: "about", text: "Turn, move and load a body by its handles on the map or by the sliders, or change the cartilage: the map follows. Coarse while it moves, exact once it rests: the numbers of the command line that stands below." }));
    const loaded = bodies.find((b) => loads[b.name]?.force?.some((x) => x !== 0)) || bodies[0];
    for (const b of bodies) {
      const box = make("details", { open: b === loaded }, make("summary", { text: b.name })), whose = b.name;
      ["x", "y", "z"].forEach((axis, i) => box.append(row({ key: "turn", whose, axis: unit(i), label: `turn about ${axis}`, unit: "°", least: -15, most: 15, step: 0.1, start: 0 })));
      ["x", "y", "z"].forEach((axis) => box.append(row({ key: "move", whose, label: `move along ${axis}`, unit: names?.length || "", least: -0.05 * reach, most: 0.05 * reach, step: Number((reach / 2000).toPrecision(1)), start: 0 })));
      // of a body with several surfaces each has a sphere of its own
      const own = [...new Map(sides.filter((s) => s.body === b.name).map((s) => [s.surface, s])).values()], of = (s) => s.sphere.center.map((x) => Number(x.toPrecision(6))).join();
      const points = [...(own.length === 1 ? [["sphere-center", `centre of the sphere of ${own[0].surface}`]] : own.map((s) => [of(s), `centre of the sphere of ${s.surface}`])), ["com", "centre of mass"]];
      const set = info.settings.rotate_about?.[b.name], said = set ? String(set) : "sphere-center";
      box.append(choice({ key: "about", whose, label: "turn about", words: points, said, start: set || own.length === 1 ? said : "com", like: /^(sphere-center|com|(-?[\d.]+(e-?\d+)?,){2}-?[\d.]+(e-?\d+)?)$/ }));
      const dofs = last ? last.bodies[b.name]?.dofs : null, free = dofs ? ["x", "y", "z", "Ru", "Rv", "Rw"].filter((d) => dofs[d] === "free") : [];
      if (free.length) box.append(make("p", { class: "about", text: `Free in ${free.join(", ")}: there the balance finds its place, and a turn or move says where the search begins.` }));
      const force = loads[b.name] && loads[b.name].force;
      const byTable = info.settings.load_body === b.name && info.settings.loads;
      if (!byTable && force && force.some((x) => x !== 0)) {
        const size = Math.hypot(...force), most = 2 * size, step = Number((most / 400).toPrecision(1));
        box.append(row({ key: "size", whose, label: "size of the force", unit: names?.force || "", least: 0, most, step, start: Number(size.toPrecision(6)) }));
        ["x", "y", "z"].forEach((axis, i) => box.append(row({ key: "force", whose, label: `force along ${axis}`, unit: names?.force || "", least: -most, most, step, start: force[i] })));
      }
      groups.append(box);
    }
    const cartilage = make("details", {}, make("summary", { text: "Cartilage" }));
    const surfaces = new Map(sides.filter((s) => !s.rigid && s.E > 0 && !s.part).map((s) => [s.surface, s]));
    for (const [surface, s] of surfaces) {
      cartilage.append(row({ key: "E", surface, label: `E of ${surface}`, unit: names?.pressure || "", least: s.E / 4, most: 4 * s.E, step: Number((s.E / 100).toPrecision(1)), start: s.E }));
      if (s.nu > 0) cartilage.append(row({ key: "nu", surface, label: `nu of ${surface}`, least: 0, most: 0.49, step: 0.01, start: s.nu }));
      cartilage.append(row({ key: "thickness-scale", surface, label: `thickness of ${surface}, times`, least: 0.3, most: 2, step: 0.01, start: s.thickness_scale }));
    }
    if (surfaces.size) groups.append(cartilage);
    groups.prepend(general);
    of("time").forEach(follow);
    const grip = make("select", { id: "hand-body", onchange: draw }, ...bodies.map((b) => make("option", { value: b.name, text: b.name })), make("option", { value: "", text: "none" }));
    grip.value = loaded.name;
    const button = (id, text, onclick, more = {}) => make("button", { id, text, onclick, ...more });
    place.append(make("p", { class: "now" }, make("b", { id: "hand-what" }), " ", make("span", { class: "about", id: "hand-seconds" })),
      make("p", { id: "hand-other", role: "status" }), make("p", { id: "hand-said", role: "status", class: "unseen" }),
      make("ul", { id: "hand-remarks" }), make("div", { class: "wide" }, make("table", { id: "hand-numbers" })), make("p", { class: "about", id: "hand-bodies" }),
      make("div", { class: "controls" }, button("hand-undo", "Undo", undo, { disabled: true }), button("hand-reset", "Reset", reset), button("hand-keep", "Keep this beside", keep, { disabled: true }),
        button("hand-down", "Put it down", () => { end(); down(); }), make("label", {}, "Handles of ", grip)),
      make("p", { class: "about", id: "hand-kept" }), groups,
      make("div", { class: "controls" }, button("hand-copy", "Copy as command", () => copyText($("hand-copy"), $("hand-line").textContent, $("hand-line"))),
        button("hand-save", "Save case as .feb", () => saveCase(line[1], files), { title: "As dea convert does: for FEBio with the plugin" })),
      make("pre", { id: "hand-line" }), Plan.element());
    frame.before(place);
    place.parentElement.classList.add("holding");
    // a worker that has ended answers no more, and the joint with it
    fail = (text) => {
      if (!hand) return;
      for (const w of Object.values(workers)) w.end();
      hand.stop();
      hand = shown = kept = null;
      for (const e of place.querySelectorAll(".handles input, .handles select, button:not(#hand-down), #hand-body")) e.disabled = true;
      place.dataset.exact = "false";
      $("hand-what").textContent = "No answer";
      for (const id of ["hand-numbers", "hand-remarks"]) $(id).replaceChildren();
      for (const id of ["hand-bodies", "hand-seconds", "hand-kept"]) $(id).textContent = "";
      $("hand-other").textContent = `${text} Put it down, and take it in the hand again.`;
      draw();
    };
    for (const kind of ["quick", "exact"]) workers[kind] = Program.stay(files, (answer) => hand && hand.answered(answer), fail);
    hand = new Hand((q) => workers[q.quick ? "quick" : "exact"].ask(q), show, { again });
    Plan.start({
      rows: rows.filter((r) => typeof r.value === "number" && r.about.key !== "time"), words, files, contacts: contacts.map((c) => c.name), number, names,
      tools: () => frame.contentWindow && frame.contentWindow.hold,
      move(values) { for (const [r, x] of values) { r.value = stepped(r, x); follow(r); } moved(); }, rested, elsewhere
    });
    now = places();
    moved(true);
  }
  return { start, end, words, get on() { return !!place; }, get fail() { return fail; }, get hand() { return hand; }, get rows() { return rows; }, get shown() { return shown; } };
})();
