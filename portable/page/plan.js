// Planning: a number of the map over two of the hand's rows, each place solved as dea run does, in workers of its own,
// coarse to fine. Where the hand is is a dot that can be dragged; the least is marked; what has no solution has no colour.
"use strict";

const Plan = (() => {
  const kQuantities = ["p99", "mean", "area", "peak", "force"];
  let of = null;     // what Live gives: rows, words, files, contacts, tools, move, rested
  let place = null, grid = null, workers = [], dragging = false;

  const end = () => { stop(); grid = null; of = null; place = null; };
  function stop() {
    for (const w of workers) w.end();
    workers = [];
  }
  const label = (r) => (r.about.whose ? `${r.about.whose}: ${r.about.label}` : r.about.label);
  const titled = (r) => `${label(r)}${r.about.unit ? ", " + r.about.unit : ""}`;
  const pick = (id, text, list) => make("label", {}, text, make("select", { id }, ...list.map(([value, t]) => make("option", { value, text: t }))));

  function element() {
    place = make("details", { id: "plan" }, make("summary", { text: "Plan: a number over two of these" }));
    return place;
  }
  function start(about) {
    of = about;
    const list = of.rows.map((r, i) => [String(i), label(r)]);
    const ends = (axis) => ["least", "most"].map((e) => make("input", { id: `plan-${axis}-${e}`, type: "number", step: "any", "aria-label": `${axis === "a" ? "across" : "up"}, ${e}` }));
    place.append(make("p", { class: "about", text: "Each place of the grid is solved exactly, with all else as it is in the hand. Drag the dot, or press the arrow keys on the grid, to take the hand there." }),
      make("div", { class: "controls" }, pick("plan-a", "across ", list), ...ends("a"), pick("plan-b", "up ", list), ...ends("b"),
        pick("plan-count", "places ", [["6", "6 × 6"], ["11", "11 × 11"], ["21", "21 × 21"], ["41", "41 × 41"]]), make("button", { id: "plan-go", text: "Work it out", onclick: () => (workers.length ? halt() : go()) })),
      make("div", { class: "controls", id: "plan-shown", hidden: true }, pick("plan-what", "Show ", kQuantities.map((k) => [k, k])), pick("plan-contact", "of ", of.contacts.map((c, i) => [String(i), c])),
        make("button", { id: "plan-study", text: "Copy as dea study", onclick: copyStudy }), make("span", { class: "about", id: "plan-progress" })),
      make("p", { class: "fault", id: "plan-fault", hidden: true }),
      make("canvas", { id: "plan-map", width: 0, height: 0, hidden: true, tabindex: "0", role: "application", "aria-roledescription": "map of two settings" }), make("canvas", { id: "plan-bar", hidden: true }), make("p", { id: "plan-text", role: "status" }));
    $("plan-count").value = "21";
    $("plan-b").value = String(Math.min(1, list.length - 1));
    for (const axis of ["a", "b"]) {
      const range = () => { const r = of.rows[Number($(`plan-${axis}`).value)].about; $(`plan-${axis}-least`).value = String(rounded(r.least)); $(`plan-${axis}-most`).value = String(rounded(r.most)); };
      $(`plan-${axis}`).addEventListener("change", range);
      range();
    }
    for (const id of ["plan-what", "plan-contact"]) $(id).addEventListener("change", draw);
    const map = $("plan-map");
    map.addEventListener("pointerdown", (e) => { if (!live()) return; dragging = true; map.setPointerCapture(e.pointerId); drag(e); });
    map.addEventListener("pointermove", (e) => (dragging ? drag(e) : tell(cellAt(e))));
    for (const type of ["pointerup", "pointercancel"]) map.addEventListener(type, () => { if (dragging) { dragging = false; of.rested(); } });
    map.addEventListener("pointerleave", () => tell(null));
    map.addEventListener("keydown", keys);
    place.addEventListener("toggle", draw);
  }
  const rounded = (x) => Number(x.toPrecision(6));

  // Places from coarse to fine: each with the width of what it stands for until finer ones are there.
  function order(n) {
    const out = [], seen = new Set();
    for (let step = n - 1; step >= 1; step = step === 1 ? 0 : Math.max(1, Math.floor(step / 2)))
      for (let j = 0; j < n; j += step)
        for (let i = 0; i < n; i += step)
          if (!seen.has(j * n + i)) { seen.add(j * n + i); out.push({ i, j, step }); }
    return out;
  }
  // Is the grid that of where the hand is? Another value of anything else is another grid.
  const live = () => !!grid && of.elsewhere(grid.a.row, grid.b.row) === grid.rest;

  function axis(name) {
    const row = of.rows[Number($(`plan-${name}`).value)], least = Number($(`plan-${name}-least`).value), most = Number($(`plan-${name}-most`).value);
    return { row, least, most, at: (k, n) => rounded(least + k * (most - least) / (n - 1)) };
  }
  function fault(text, gone = false) {
    if (gone) {  // another grid was asked for
      stop();
      grid = null;
      for (const id of ["plan-shown", "plan-map", "plan-bar"]) $(id).hidden = true;
      $("plan-text").textContent = "";
      $("plan-go").textContent = "Work it out";
    }
    $("plan-fault").textContent = text;
    $("plan-fault").hidden = !text;
  }
  function go() {
    const a = axis("a"), b = axis("b"), n = Number($("plan-count").value), forces = [a, b].filter((x) => x.row.about.key === "size" || x.row.about.key === "force");
    fault("");
    if (a.row === b.row) { fault("Across and up are the same: choose two.", true); return; }
    if (forces.length === 2 && forces.some((x) => x.row.about.key === "size") && a.row.about.whose === b.row.about.whose) { fault("The size of a force and one of its parts change each other: choose two others.", true); return; }
    if (![a, b].every((x) => Number.isFinite(x.least) && x.least < x.most)) { fault("A range has to end above its beginning.", true); return; }
    stop();
    grid = { a, b, n, cells: new Array(n * n).fill(null), done: 0, began: performance.now(), seconds: 0 };
    grid.rest = of.elsewhere(a.row, b.row);
    const mine = grid, waiting = order(n), all = waiting.length;
    for (const cell of waiting) cell.words = of.words(new Map([[a.row, a.at(cell.i, n)], [b.row, b.at(cell.j, n)]]));
    $("plan-go").textContent = "Stop";
    for (const id of ["plan-shown", "plan-map", "plan-bar"]) $(id).hidden = false;
    let next = 0, broken = "";
    const asked = new Map();
    const count = Math.min(8, all, Math.max(1, navigator.hardwareConcurrency || 1));
    for (let k = 0; k < count; ++k) {
      const ask = () => {
        if (next >= all) { if (mine.done === all) halt(); return; }
        asked.set(next, waiting[next]);
        worker.ask({ ask: next, words: waiting[next].words, quick: false, from: null });
        ++next;
      };
      const worker = Program.stay(of.files, (answer) => {
        if (grid !== mine || !workers.includes(worker)) return;
        const { i, j, step } = asked.get(answer.ask), ok = !!answer.text && answer.text.solved;
        mine.cells[j * n + i] = { step, values: ok ? answer.text.state.contacts.map((c) => ({ ...c.headline, force: Math.hypot(...c.force) })) : null, why: ok ? "" : answer.text ? answer.text.state.message : answer.lines.join(" ") };
        if (!answer.text) broken ||= answer.lines.join(" ");
        fault(broken);
        ++mine.done;
        ask();
        later();
      }, (text) => { broken = text; fault(text); halt(); });
      workers.push(worker);
      ask();
    }
    draw();
  }
  function halt() {
    stop();
    if (grid) grid.seconds = (performance.now() - grid.began) / 1000;
    $("plan-go").textContent = "Work it out";
    draw();
  }

  let pending = 0;
  function later() { pending ||= requestAnimationFrame(() => { pending = 0; draw(); }); }
  // The hand has moved.
  function follow() { if (grid && place && place.open) later(); }

  const valueOf = (cell) => (cell && cell.values ? cell.values[Number($("plan-contact").value)]?.[$("plan-what").value] ?? null : null);
  const kPad = { left: 64, right: 14, top: 10, bottom: 46 };
  function frameOf() {
    const map = $("plan-map"), size = Math.min(520, map.parentElement.clientWidth - 4);
    return { size, x: kPad.left, y: kPad.top, w: size - kPad.left - kPad.right, h: size - kPad.top - kPad.bottom };
  }
  // In CSS pixels of the canvas; a place is in the middle of its cell.
  const across = (f, k) => f.x + (k + 0.5) * f.w / grid.n, up = (f, k) => f.y + f.h - (k + 0.5) * f.h / grid.n;
  const index = (axis, x) => (x - axis.least) / (axis.most - axis.least) * (grid.n - 1);

  function draw() {
    if (!place || !grid || !place.open) return;
    const map = $("plan-map"), c = map.getContext("2d"), f = frameOf(), k = Math.min(2, window.devicePixelRatio || 1), tools = of.tools(), { n, cells, a, b } = grid;
    const style = getComputedStyle(document.body), ink = style.color, paper = style.backgroundColor;
    map.width = map.height = Math.round(f.size * k);
    map.style.width = map.style.height = `${f.size}px`;
    const values = cells.map(valueOf), known = values.filter((x) => x !== null), least = Math.min(...known), most = Math.max(...known);
    c.scale(k, k);
    c.clearRect(0, 0, f.size, f.size);
    c.font = `13px ${style.fontFamily}`;
    const w = f.w / n, h = f.h / n;
    if (tools) {
      // coarse ones first: finer ones cover them
      const drawn = cells.map((cell, at) => ({ cell, at })).filter((x) => x.cell).sort((p, q) => q.cell.step - p.cell.step);
      for (const { cell, at } of drawn) {
        const x = valueOf(cell), i = at % n, j = (at - i) / n, half = grid.done === n * n ? 0.5 : cell.step / 2;
        const left = Math.max(f.x, across(f, i) - half * w), top = Math.max(f.y, up(f, j) - half * h);
        const right = Math.min(f.x + f.w, across(f, i) + half * w), bottom = Math.min(f.y + f.h, up(f, j) + half * h);
        c.fillStyle = x === null ? paper : tools.css("sequential", most > least ? (x - least) / (most - least) : 0.5);
        c.fillRect(left, top, right - left + 0.5, bottom - top + 0.5);
        if (x === null) { c.strokeStyle = ink; c.globalAlpha = 0.4; c.lineWidth = 1; c.beginPath(); c.moveTo(left, bottom); c.lineTo(right, top); c.stroke(); c.globalAlpha = 1; }
      }
    }
    c.strokeStyle = ink; c.fillStyle = ink; c.lineWidth = 1;
    c.strokeRect(f.x, f.y, f.w, f.h);
    const marks = (axis, put) => { for (const k of new Set([0, 0.25, 0.5, 0.75, 1].map((part) => Math.round(part * (n - 1))))) put(k, of.number(axis.at(k, n), 3)); };
    c.textAlign = "center"; c.textBaseline = "top";
    marks(a, (i, t) => c.fillText(t, across(f, i), f.y + f.h + 6));
    c.fillText(titled(a.row), f.x + f.w / 2, f.y + f.h + 25, f.w);
    c.textAlign = "right"; c.textBaseline = "middle";
    marks(b, (j, t) => c.fillText(t, f.x - 6, up(f, j)));
    c.save(); c.translate(10, f.y + f.h / 2); c.rotate(-Math.PI / 2); c.textAlign = "center";
    c.fillText(titled(b.row), 0, 0, f.h); c.restore();
    const ring = (x, y, r, full) => { for (const [s, wide] of [[paper, 5], [ink, 2]]) { c.strokeStyle = s; c.lineWidth = wide; c.beginPath(); c.arc(x, y, r, 0, 2 * Math.PI); c.stroke(); } if (full) { c.fillStyle = ink; c.fill(); } };
    const best = known.length ? values.indexOf(least) : -1, at = live() ? [index(a, a.row.value), index(b, b.row.value)] : null;
    if (best >= 0) {
      const x = across(f, best % n), y = up(f, Math.floor(best / n));
      ring(x, y, 8, false);
      c.textAlign = x > f.x + f.w / 2 ? "right" : "left"; c.textBaseline = "middle"; c.lineWidth = 4; c.strokeStyle = paper; c.fillStyle = ink;
      const t = `least ${of.number(least)}`, tx = x + (x > f.x + f.w / 2 ? -14 : 14);
      c.strokeText(t, tx, y); c.fillText(t, tx, y);
    }
    const inside = at && at.every((x) => x >= -0.5 && x <= n - 0.5);
    if (inside) ring(across(f, at[0]), up(f, at[1]), 5, true);
    map.style.opacity = live() ? "1" : "0.45";
    map.style.touchAction = live() ? "none" : "auto";
    $("plan-progress").textContent = grid.done < n * n ? `${grid.done} of ${n * n}` : `${n * n} places in ${of.number(grid.seconds || (performance.now() - grid.began) / 1000, 3)} s`;
    const unit = { p99: "pressure", mean: "pressure", peak: "pressure", area: "area", force: "force" }[$("plan-what").value], named = of.names?.[unit] ? ` ${of.names[unit]}` : "";
    const none = cells.filter((x) => x && !x.values).length, spelled = (i, j) => `${label(a.row)} ${of.number(a.at(i, n), 3)}, ${label(b.row)} ${of.number(b.at(j, n), 3)}`;
    const said = !known.length ? "" : `${$("plan-what").value} from ${of.number(least)} at ${spelled(best % n, Math.floor(best / n))} to ${of.number(most)}${named}.` + (none ? ` ${none} without a solution: crossed out${none === 1 ? "" : ", the first"}: ${cells.find((x) => x && !x.values).why}.` : "") + (live() ? (inside ? "" : " The hand is beyond this grid.") : " The hand has changed something else since: work it out again.");
    if (!dragging && grid.done === n * n) { if ($("plan-text").textContent !== said) $("plan-text").textContent = said; }
    map.setAttribute("aria-label", `${$("plan-what").value} over two settings; arrow keys move the hand. ${said}`);
    if (tools && known.length) {
      const step = tools.step(least, most > least ? most : least + 1);
      tools.bar($("plan-bar"), { map: "sequential", least, most: most > least ? most : least + 1, level: step, title: `${$("plan-what").value} of ${of.contacts[Number($("plan-contact").value)]}${named}`, noneText: "", lowest: least, highest: most }, tools.theme(), false);
    }
  }

  const bounded = (x) => Math.min(grid.n - 1, Math.max(0, x));
  function spot(e) {
    const f = frameOf();
    return [(e.offsetX - f.x) / f.w * grid.n - 0.5, (f.y + f.h - e.offsetY) / f.h * grid.n - 0.5];
  }
  function cellAt(e) {
    if (!grid) return null;
    const [i, j] = spot(e).map(Math.round);
    return i >= 0 && j >= 0 && i < grid.n && j < grid.n ? { i, j } : null;
  }
  // What is under the pointer.
  function tell(at) {
    if (!grid) return;
    const cell = at && grid.cells[at.j * grid.n + at.i], x = valueOf(cell);
    $("plan-map").title = !cell ? "" : x === null ? `no solution: ${cell.why}` : `${$("plan-what").value} ${of.number(x)} at ${of.number(grid.a.at(at.i, grid.n), 3)}, ${of.number(grid.b.at(at.j, grid.n), 3)}`;
  }
  const take = (i, j) => of.move([[grid.a.row, grid.a.least + bounded(i) * (grid.a.most - grid.a.least) / (grid.n - 1)], [grid.b.row, grid.b.least + bounded(j) * (grid.b.most - grid.b.least) / (grid.n - 1)]]);
  function drag(e) {
    take(...spot(e));
    later();
  }
  function keys(e) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key];
    if (!step || !live()) return;
    e.preventDefault();
    take(Math.round(index(grid.a, grid.a.row.value)) + step[0], Math.round(index(grid.b, grid.b.row.value)) + step[1]);
    of.rested();
    later();
  }

  // The same grid as a line of dea study: what stands for a row in a line of dea run, once with its range.
  function studyLine() {
    const { a, b, n } = grid, mark = (k) => 987001 + k;  // a number that nothing else has
    const line = of.words(new Map([[a.row, mark(0)], [b.row, mark(1)]])), out = ["study", line[1]], factors = [];
    for (let i = 2; i < line.length; ++i) {
      const hits = [a, b].map((x, k) => [x, String(mark(k))]).filter(([, m]) => line[i].includes(m));
      if (hits.length > 1) return null;
      if (!hits.length) { out.push(line[i]); continue; }
      const [x, m] = hits[0], option = out.pop();
      factors.push("--vary", `${x === a ? "across" : "up"}: ${option} ${line[i].replace(m, `{${rounded(x.least)}:${rounded(x.most)}:${Number(((x.most - x.least) / (n - 1)).toPrecision(12))}}`)}`);
    }
    if (factors.length !== 4) return null;  // a size is three numbers
    return commandLine([...out, ...factors, "-o", "plan.db"]);
  }
  function copyStudy() {
    const line = grid && studyLine();
    if (!line) { fault("Two numbers of one option cannot be two factors of a study: choose others, or take --cases with a table."); return; }
    $("plan-text").textContent = line;
    copyText($("plan-study"), line, $("plan-text"));
  }
  return { element, start, end, follow, studyLine: () => (grid ? studyLine() : null), get grid() { return grid; } };
})();
