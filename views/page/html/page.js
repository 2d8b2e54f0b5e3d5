// The page: puts controls, maps, figures and tables together, and holds what is being looked at.
"use strict";

const Page = (() => {
  const compared = Report.kind === "compare", results = Report.results, last = results.length - 1;
  const state = { surface: null, beside: null, frame: Report.frame, region: 0, quantity: "pressure", smooth: true, pair: null, range: "all", most: null, poses: true, theme: "light" };
  const maps = new Maps();
  const quantities = {
    pressure: { head: "Pressure", title: "contact pressure", dimension: "pressure", noneText: "no contact", shown: (x) => x > 0 },
    space: { head: "Joint space", title: "joint space", dimension: "length", noneText: "", shown: () => true },
    thickness: { head: "Cartilage thickness", title: "cartilage thickness", dimension: "length", noneText: "", shown: () => true },
    gap: { head: "Penetration", title: "penetration (contact gap)", dimension: "length", noneText: "none", shown: (x) => x > 0 }
  };
  let panels = [], figures = Figures.list(), busy = 0;

  // ---- frame of the page ----
  function build() {
    const units = Report.units.name ? (Report.units.length ? `Units: ${[Report.units.length, Report.units.force, Report.units.pressure].join(", ")}.` : `Units: ${Report.units.name}.`) : "The files name no units.";
    const files = results.length === 1 ? results[0].file : results.map((r) => r.file).join(", ");
    makeHead(compared ? `Contact pressure of ${results.length} results, ${results[last].label} as the reference. ${units}` : `Contact pressure by discrete element analysis, ${files}. ${units}`);
    warnings();
    const main = $("main");
    if (Report.surfaces.length) {
      main.append(make("section", { id: "maps" }));
      buildMaps($("maps"));
    } else {
      main.append(make("p", { class: "fault", text: "There is no contact surface to show." }));
    }
    for (const [key, title] of [["now", "Pressure at this state"], ["time", "Over time"]]) {
      if (!figures[key].length) continue;
      const place = make("div", { class: "figures" });
      main.append(make("section", {}, make("h2", { text: title }), key === "now" || !compared ? regionControl(key) : null, place));
      for (const f of figures[key]) place.append(Figures.element(f, state));
    }
    tables(main);
    foot();
  }

  function warnings() {
    const lines = Report.warnings;
    if (!lines.length) return;
    const list = make("ul", {}, ...lines.map((l) => make("li", { text: l })));
    $("head").append(make("div", { class: "warnings" }, lines.length > 4 ? make("details", {}, make("summary", { text: `${lines.length} notes and warnings` }), list) : list));
  }

  function regionControl(key) {
    if (!Report.surfaces.some((s) => s.regions.length > 1) || key !== "now") return null;
    const names = Report.surfaces.find((s) => s.regions.length > 1).regions;
    return make("div", { class: "controls" }, makeSelect("region", "Region", names.map((n, i) => [String(i), n || "whole surface"]), "0", (v) => { state.region = Number(v); drawFigures(); }));
  }

  // ---- maps ----
  function available() {
    return Object.keys(quantities).filter((q) => Report.surfaces.some((s) => s.fields[q].some(Boolean)));
  }
  function buildMaps(section) {
    const controls = make("div", { class: "controls" });
    controls.append(makeSelect("surface", "Surface", Report.surfaces.map((s, i) => [String(i), s.title + (s.note ? ` (${s.note})` : "")]), "0", (v) => setSurface(Number(v), state.beside ? state.beside.index : -1)));
    if (Report.surfaces.length === 1) controls.lastChild.querySelector("select").disabled = true;
    else if (!compared) controls.append(makeSelect("beside", "beside it", [["-1", "none"], ...Report.surfaces.map((s, i) => [String(i), s.title])], "-1", (v) => setSurface(state.surface.index, Number(v))));
    if (compared) controls.append(makeSelect("quantity", "Show", available().map((q) => [q, quantities[q].head.toLowerCase()]), "pressure", (v) => { state.quantity = v; layPanels(); }));
    controls.append(make("span", { class: "group", role: "group" },
      make("button", { id: "smooth", text: "smooth", title: "Area-weighted averages at the nodes", "aria-pressed": "true", onclick: () => setSmooth(true) }),
      make("button", { id: "facets", text: "facets", title: "The facets' own values", "aria-pressed": "false", onclick: () => setSmooth(false) })));
    controls.append(make("span", { class: "group", role: "group" },
      makeToggle("contours", "contours", true, (on) => { maps.options.contours = on; update(); }),
      makeToggle("marks", "marks", true, (on) => { maps.options.marks = on; maps.request(); }),
      makeToggle("lines", "mesh", false, (on) => { maps.options.lines = on; maps.request(); }),
      Report.context ? makeToggle("veil", "rest of the model", true, (on) => { maps.options.veil = on; maps.request(); }) : null,
      Report.context && Report.context.parts_move.length ? makeToggle("poses", "in its pose", true, (on) => { state.poses = on; update(); }) : null));
    controls.append(makeSelect("range", "Scale", [["all", "all states"], ["state", "this state"]], "all", (v) => { state.range = v; update(); }),
      make("label", {}, "up to", make("input", { id: "most", type: "number", min: "0", step: "any", placeholder: "auto", onchange: (e) => { const x = Number(e.target.value); state.most = x > 0 ? x : null; update(); } })),
      make("button", { id: "reset", text: "reset view", onclick: resetView }),
      make("button", { id: "save-maps", text: "save PNG", title: "All maps with their titles, numbers, time and colours, on white", onclick: saveMaps }));
    section.append(controls);
    if (maps.fault) section.append(make("p", { class: "fault", id: "nowebgl", text: maps.fault }));
    section.append(make("div", { class: "panels", id: "panels" }), make("div", { class: "bars", id: "bars" }));
    section.append(makeTimeBar(["play", "slider", "now"], "Play (space)", Report.frames.length, state.frame, () => player.play(!player.on), setFrame, "time"));
    if (Report.frames.length < 2) $("time").style.position = "static";
    section.append(make("p", { class: "keys", text: "Drag turns all maps, Shift + drag shifts, Ctrl + wheel or a pinch enlarges, a double click resets; ← → step through the states, space plays. Surfaces are shown in the reference configuration" + (Report.context && Report.context.parts_move.length ? ", the rest of the model as it stands to them in each state" : "") + ". Ring: peak; cross: centre of pressure." }));
    section.append(make("p", { class: "keys", id: "kinds", text: Report.headline + ", with smooth maps or without: below the maps, in curves, and first in the tables. Springs are where dea run works out the pressure; a facet has the force of all its springs over its whole area (on the surface without springs: pressure carried over), and a node the average of the facets around it: peaks fall and contact areas grow from springs to facets to nodes. With “smooth” the edge of contact encloses as much area as the facets with pressure do." }));
    if (Report.context_note) section.append(make("p", { class: "keys", text: Report.context_note }));
  }

  function pairs(s) {
    const out = [];
    for (let i = 0; i <= last; ++i)
      for (let j = i + 1; j <= last; ++j)
        if (j === last || s.about.meshes[i] === s.about.meshes[j]) out.push([i, j]);
    out.sort((a, b) => b[1] - a[1] || a[0] - b[0]);
    return out;
  }

  // Panels: compare: a result each and a difference; run: a quantity each.
  function layPanels() {
    const host = $("panels"), s = state.surface;
    const of = (surface) => (state.held ? heldPanels(surface) : available().filter((q) => surface.fields[q][0]).map((q) => ({ result: 0, quantity: q, surface })));
    const wanted = compared ? results.map((r, i) => ({ result: i, quantity: state.quantity, surface: s })) : shown().flatMap(of);
    if (compared) wanted.push({ difference: true, quantity: state.quantity, surface: s });
    const count = state.beside ? Math.max(...shown().map((x) => of(x).length)) : wanted.length;  // a surface below the other
    state.columns = state.beside ? count : 0;
    host.style.setProperty("--least", count > 4 ? "250px" : count === 4 ? "285px" : "300px");
    host.style.setProperty("--count", String(Math.min(4, count)));  // on paper
    host.classList.toggle("rows", Boolean(state.beside));
    host.replaceChildren();
    panels = wanted.map((w, i) => {
      const p = { ...w, canvas: makeMapCanvas("map" + i), readout: make("div", { class: "readout", id: "readout" + i }), marks: [] };
      const name = [];
      if (w.difference) {
        const all = pairs(s);
        if (!state.pair || !all.some(([a, b]) => a === state.pair[0] && b === state.pair[1])) state.pair = all[0];
        const chooser = make("select", { id: "pair", title: "Difference of which two results", "aria-label": "Difference", onchange: (e) => { state.pair = e.target.value.split(",").map(Number); update(); } });
        for (const [a, b] of all) chooser.append(make("option", { value: `${a},${b}`, text: `${results[a].label} − ${results[b].label}`, selected: a === state.pair[0] && b === state.pair[1] }));
        name.push(chooser);
        p.title = () => `${results[state.pair[0]].label} − ${results[state.pair[1]].label}`;
      } else {
        const what = { beside: "Kept", difference: "In the hand − kept" }[w.held] || (state.held ? "In the hand" : quantities[w.quantity].head);
        const title = compared ? results[w.result].label : what + (state.beside ? `, ${w.surface.about.title}` : "");
        name.push(make("h3", { text: title }));
        if (compared && w.result === last) name.push(make("span", { class: "role", text: "reference" }));
        p.title = () => title;
      }
      const from = s.about.view.center, to = w.surface.about.view.center;
      p.offset = w.surface === s || maps.fault ? null : new THREE.Vector3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
      if (maps.fault) p.canvas.hidden = true;
      const element = makePanel(name, p.canvas, p.readout);
      if (i > 0 && w.surface !== wanted[i - 1].surface) element.style.gridColumnStart = "1";  // the first may have fewer
      host.append(element);
      return p;
    });
    maps.setPanels(panels);
    update();
  }

  const shown = () => (state.beside ? [state.surface, state.beside] : [state.surface]);
  // A page around this one may put a pressure of its own in place of all these states: { note, surfaces: by their names
  // { values: per facet, edge }; beside: surfaces of another one, or null; handles, onhandle: see Maps }; null: none.
  // Nothing of this page's own states is shown then.
  function hold(held) {
    const kind = (h) => (h ? (h.beside ? 2 : 1) : 0), other = kind(held) !== kind(state.held);
    state.held = held;
    if (held) document.documentElement.dataset.held = "true";
    else delete document.documentElement.dataset.held;
    maps.handles = (held && held.handles) || [];
    maps.onhandle = held ? held.onhandle : null;
    nodalCache.clear();
    if (other && state.surface) layPanels(); else update();
  }
  // Meanwhile, until there is a new one: its handles have moved.
  function moveHandles(handles, note) {
    if (!state.held) return;
    state.held.handles = maps.handles = handles;
    state.held.note = note;
    $("now").textContent = heldName();
    maps.request();
  }
  const heldName = () => `in the hand${state.held.note}`;
  const heldPanels = (surface) => (state.held.beside ? ["now", "beside", "difference"] : ["now"]).map((held) => ({ result: 0, quantity: "pressure", surface, held }));
  const heldOf = (q, s, which) => {
    const surfaces = which === "beside" ? state.held.beside : state.held.surfaces;
    return (q === "pressure" && surfaces && surfaces.get(s.about.names[0])) || { values: null, edge: null };
  };
  // `which`: of what is held, "beside", or what is there now.
  const values = (q, i, s = state.surface, which = "now") => {
    if (state.held) return heldOf(q, s, which).values;
    const f = s.fields[q][i];
    return f ? f.state(Report.frames[state.frame].states[i]) : null;
  };
  const edge = (q, i, s = state.surface, which = "now") => {
    if (state.held) return heldOf(q, s, which).edge;
    const f = s.fields[q][i]; return f ? f.edge(Report.frames[state.frame].states[i]) : null;
  };
  const nodalCache = new Map();
  function nodal(q, i, s = state.surface, which = "now") {
    const key = [s.index, q, i, which, Report.frames[state.frame].states[i]].join();
    if (!nodalCache.has(key)) {
      if (nodalCache.size > 40) nodalCache.clear();
      const v = values(q, i, s, which);
      nodalCache.set(key, v ? Data.nodalAverage(s.meshes[i], v) : null);
    }
    return nodalCache.get(key);
  }
  const unsolved = (i) => !state.held && Report.frames[state.frame].unsolved.includes(i);
  function measures(i, s = state.surface) {
    const k = state.held ? -1 : Report.frames[state.frame].states[i], m = k < 0 ? null : s.about.measures[i][k];
    return m ? m[0] : null;
  }

  // Ends and lines come from the program, by the rule that `dea plot` draws with (views/map/map_scale.h); only what "up
  // to" says is worked out here. `of`: the surface's scales or differences.
  function scaleFrom(of, about) {
    const scales = of && of[state.smooth ? "nodes" : "facets"];
    return { ...scaleOfNumbers(scales && (state.range === "all" ? scales.all : scales.frames[state.frame])), noneText: about.noneText };
  }
  const said = (q) => (state.most !== null && q === (compared ? state.quantity : "pressure") ? state.most : null);
  // One scale per quantity, for all its panels: of two surfaces it covers both.
  function scaleOf(q) {
    const about = quantities[q], all = shown().map((s) => s.about.scales.find((x) => x.field === q)).filter(Boolean);
    const each = all.map((x) => scaleFrom(x, about)), scale = each[0] || scaleFrom(null, about);
    if (each.length > 1) {
      for (const k of ["least", "lowest"]) scale[k] = Math.min(...each.map((x) => x[k]));
      // of joint spaces that of the narrower one, which is looked at: far from contact a head's gaps are large
      scale.most = (q === "space" ? Math.min : Math.max)(...each.map((x) => x.most));
      scale.highest = Math.max(...each.map((x) => x.highest));
      scale.level = scaleStep(scale.least, scale.most);
    }
    scale.title = Format.axis(about.title, about.dimension) + (q === "space" && scale.least < 0 ? ", below 0: overlap" : "");
    if (state.held && q === "pressure")
      for (const s of shown())
        for (const which of ["now", "beside"])
          for (const x of values(q, 0, s, which) || []) if (x > scale.most) { scale.most = scale.highest = x; scale.level = scaleStep(scale.least, x); }
    const most = said(q);
    if (most !== null && most > scale.least) { scale.most = most; scale.level = scaleStep(scale.least, most); }
    scale.zero = scale.least < 0;  // a line at 0
    return withEnds(scale);
  }

  function differenceOf(q) {
    const s = state.surface, [i, j] = state.pair, about = quantities[q], same = s.about.meshes[i] === s.about.meshes[j];
    const a = values(q, i), b = values(q, j);
    if (!a || !b) {
      const lacking = [[i, a], [j, b]].filter((x) => !x[1]).map((x) => results[x[0]].label);
      return noDifference(s.meshes[j], `${lacking.join(" and ")}: no values`);
    }
    const nodes = same ? nodal(q, i) : Data.carried(s, i, nodal(q, i));
    return difference(s.meshes[j], q, { facets: same ? a : null, nodes, edge: edge(q, i) }, { facets: b, nodes: nodal(q, j), edge: edge(q, j) });
  }
  const noDifference = (mesh, message) => ({ mesh, facets: null, vertices: null, message, shown: () => true });
  // As maps are painted. `a`, less `b`: { facets: values of these, null where they are another mesh's; nodes: of this mesh; edge }.
  function difference(mesh, q, a, b) {
    const out = noDifference(mesh, ""), pressure = q === "pressure";
    if (a.facets && !state.smooth) {
      out.facets = a.facets.map((x, k) => x - b.facets[k]);
      out.lines = a.nodes.map((x, k) => (pressure && !(x > 0 || b.nodes[k] > 0) ? NaN : x - b.nodes[k]));
      if (pressure) out.shown = (x, k) => a.facets[k] > 0 || b.facets[k] > 0;
    } else {
      out.vertices = a.nodes.map((x, k) => x - b.nodes[k]);
      if (pressure) out.over = [Data.above(a.nodes, a.edge), Data.above(b.nodes, b.edge)];
    }
    return out;
  }

  function differenceScale(q) {
    const [i, j] = state.pair, about = quantities[q];
    const scale = scaleFrom(state.surface.about.differences.find((x) => x.field === q && x.pair[0] === i && x.pair[1] === j), about);
    if (scale.least >= 0) scale.least = -scale.most;
    return withEnds({ ...scale, map: "diverging", noneText: q === "pressure" ? "no contact" : "", title: Format.axis(`difference of ${about.title}`, about.dimension) });
  }

  // What is in the hand, less what is beside it.
  function heldDifference(s) {
    const of = (which) => ({ facets: values("pressure", 0, s, which), nodes: nodal("pressure", 0, s, which), edge: edge("pressure", 0, s, which) });
    const now = of("now"), kept = of("beside");
    return now.facets && kept.facets ? difference(s.meshes[0], "pressure", now, kept) : noDifference(s.meshes[0], "no difference: one of them has no solution");
  }
  const largest = (what) => (what.facets || what.vertices || []).reduce((most, x) => Math.max(most, Math.abs(x)), 0);
  function heldDifferenceScale(most) {
    const end = most > 0 ? most : 1;
    return withEnds({ ...scaleOfNumbers([-end, end, scaleStep(0, end), -end, end]), map: "diverging", noneText: "no contact", title: Format.axis("in the hand − kept", "pressure") });
  }

  // What the panels show at this state.
  function update() {
    if (!state.surface) return;
    const scales = new Map(), moves = motions();
    const differences = new Map(panels.filter((p) => p.held === "difference").map((p) => [p, heldDifference(p.surface)]));
    const mostOfAll = Math.max(0, ...[...differences.values()].map(largest));
    for (const p of panels) {
      const s = p.surface;
      p.message = "";
      p.marks = [];
      p.motions = moves && [...moves.parts, moves.surfaces[s.index]];
      let what, scale;
      if (p.difference) {
        what = differenceOf(p.quantity);
        scale = differenceScale(p.quantity);
        p.message = what.message;
        scales.set("difference", scale);
      } else if (p.held === "difference") {
        what = differences.get(p);
        p.message = what.message;
        scale = heldDifferenceScale(mostOfAll);
        scales.set("difference", scale);
      } else {
        if (!scales.has(p.quantity)) scales.set(p.quantity, scaleOf(p.quantity));
        scale = scales.get(p.quantity);
        const v = values(p.quantity, p.result, s, p.held), q = quantities[p.quantity];
        what = { mesh: s.meshes[p.result], facets: null, vertices: null, shown: q.shown };
        if (!v && state.held) p.message = "no solution here";
        else if (!v) p.message = Report.frames[state.frame].states[p.result] < 0 ? "no state at this time" : `no ${q.title} in this file`;
        else {
          const averages = nodal(p.quantity, p.result, s, p.held);
          what.from = edge(p.quantity, p.result, s, p.held);
          if (!state.smooth) Object.assign(what, { facets: v, lines: averages });
          else Object.assign(what, { vertices: averages }, what.from === null ? {} : { over: [Data.above(averages, what.from)] });
        }
        if (v && p.quantity === "pressure") {
          const m = measures(p.result, s), peak = peakPlace(what);
          if (m && m.center && m.center[0] !== null) p.marks.push({ kind: "center", at: m.center });
          if (peak) p.marks.push({ kind: "peak", at: peak });
        }
      }
      what.scale = scale;
      maps.paint(p, what);
      p.canvas.setAttribute("aria-label", `${p.title()}: ${scale.title}`);
    }
    bars(scales);
    readouts();
    const frame = Report.frames[state.frame];
    $("slider").value = String(state.frame);
    $("now").textContent = state.held ? heldName() : frame.time === null ? "compared states, at different times" : Format.at(frame.time) + (Report.frames.length > 1 ? ` (${state.frame + 1} of ${Report.frames.length})` : "");
    drawFigures();
  }

  // How the rest of the model and the surfaces stand in this state, by the first result.
  function motions() {
    const c = Report.context, at = state.held ? -1 : Report.frames[state.frame].states[0];
    return c && c.parts_move.length && state.poses && at >= 0 ? { parts: c.parts_move[at], surfaces: c.surfaces_move[at] } : null;
  }

  function peakPlace(what) {
    const source = what.facets || what.vertices, m = what.mesh;
    let best = -1, most = 0;
    for (let i = 0; i < source.length; ++i) if (source[i] > most) { most = source[i]; best = i; }
    if (best < 0) return null;
    if (what.vertices) return [...m.vertices.subarray(3 * best, 3 * best + 3)];
    const sum = [0, 0, 0];
    let n = 0;
    for (let k = m.begin[best]; k < m.begin[best + 1]; ++k) if (m.corner[k] >= 0) { for (let c = 0; c < 3; ++c) sum[c] += m.vertices[3 * m.corner[k] + c]; ++n; }
    return sum.map((x) => x / n);
  }

  function bars(scales) {
    const host = $("bars");
    if (maps.fault) return;
    while (host.children.length > scales.size) host.lastChild.remove();
    while (host.children.length < scales.size) host.append(make("canvas", {}));
    state.bars = [...scales.values()];
    state.bars.forEach((scale, i) => paintBar(host.children[i], scale, state.theme, maps.options.contours));
  }

  // Below each map: what is under the pointer in all of them, or the numbers of the whole surface.
  function line(...parts) {
    const out = [], shown = parts.filter(Boolean);
    shown.forEach((p, i) => out.push(make("span", {}, p, i + 1 < shown.length ? " ·" : null), " "));
    return out;
  }
  const bold = (text) => make("b", { text });
  function readouts() {
    for (const p of panels) {
      const q = quantities[p.quantity], m = p.what && p.what.mesh;
      if (maps.hover && p.hit && m && !p.message) {
        const hit = p.hit, node = `node ${m.nodes[hit.vertex]}`, facet = `facet ${hit.facet + 1}`, rows = [];
        const facetValue = (quantity, i) => { const v = values(quantity, i, p.surface, p.held); return v ? v[hit.facet] : null; };
        if (p.difference || p.held === "difference") {
          const w = p.what, x = w.facets ? w.facets[hit.facet] : w.vertices[hit.vertex];
          rows.push(line(w.facets ? facet : node, bold(Format.with(x, q.dimension))));
        } else {
          const x = facetValue(p.quantity, p.result), n = nodal(p.quantity, p.result, p.surface, p.held);
          const t = p.quantity === "thickness" ? null : facetValue("thickness", p.result);
          rows.push(line(facet, bold(Format.with(x, q.dimension)), t === null ? null : `thickness ${Format.with(t, "length", 3)}`));
          rows.push([make("br"), ...line(`${node}, average ${Format.with(n[hit.vertex], q.dimension)}`)]);
        }
        p.readout.replaceChildren(...line(...withoutSolution(p).map(bold)), ...rows.flat());
        p.readout.dataset.facet = String(hit.facet + 1);
        continue;
      }
      delete p.readout.dataset.facet;
      p.readout.replaceChildren(...line(...withoutSolution(p).map(bold), ...knownNumbersOf(p)));
    }
  }
  // Of the whole surface, as short texts.
  const numbersOf = (p) => [...withoutSolution(p), ...knownNumbersOf(p)];
  function withoutSolution(p) {
    const of = (p.difference ? state.pair : [p.result]).filter(unsolved);
    if (!of.length || p.quantity === "thickness") return [];
    return [compared ? `no solution in ${of.map((i) => results[i].label).join(" and ")}` : "no solution: do not use its numbers"];
  }
  function knownNumbersOf(p) {
    if (p.quantity !== "pressure" || p.message) return [];
    if (p.difference) {
      const pattern = state.pair[1] === last ? state.surface.about.patterns[state.frame][0][state.pair[0]] : null;
      return pattern ? [`r ${Format.number(pattern.r, 3)}`, `rms ${Format.with(pattern.rms, "pressure", 3)}`, `mean ${Format.with(pattern.mean, "pressure", 2)}`, `largest ${Format.with(pattern.largest, "pressure", 3)}`, "nodes"] : [];
    }
    const d = measures(p.result, p.surface), h = d && d.headline;
    return d ? [`p99 ${Format.printed(h.p99, "pressure")}`, `mean ${Format.printed(h.mean, "pressure")}`, `area ${Format.printed(h.area, "area")}`, `peak ${Format.printed(h.peak, "pressure")}`, `force ${Format.printed(d.force, "force")}`] : [];
  }
  maps.onpick = readouts;
  maps.onreset = resetView;

  // As the first surface is looked at best, and near enough for the larger one.
  function resetView() { maps.setView({ ...state.surface.about.view, radius: Math.max(...shown().map((s) => s.about.view.radius)) }); }

  async function setSurface(index, beside) {
    const ticket = ++busy, surface = await Data.surface(index);
    const other = beside >= 0 && beside !== index ? await Data.surface(beside) : null;
    if (ticket !== busy) return;
    state.surface = surface;
    state.beside = other;
    if ($("beside")) $("beside").value = String(other ? other.index : -1);
    state.region = Math.min(state.region, surface.about.regions.length - 1);
    nodalCache.clear();
    if (!maps.fault) resetView();
    layPanels();
  }

  function setSmooth(on) {
    state.smooth = on;
    $("smooth").setAttribute("aria-pressed", String(on));
    $("facets").setAttribute("aria-pressed", String(!on));
    update();
  }

  function setFrame(frame) {
    if (state.held) return;
    state.frame = Math.min(Report.frames.length - 1, Math.max(0, frame));
    update();
  }

  const player = makePlayer("play", () => {
    maps.hurry();
    setFrame((state.frame + 1) % Report.frames.length);
    return state.frame === Report.frames.length - 1 ? 1100 : 320;
  });

  function drawFigures() {  // those out of sight wait until the states stand still
    if (state.held) return;
    if (state.surface || !Report.surfaces.length) Figures.drawAll([...figures.now, ...figures.time], state, player.on ? 600 : 120);
  }

  // ---- all maps in one picture, on white ----
  function saveMaps() {
    const frame = Report.frames[state.frame], marked = maps.options.marks && panels.some((p) => p.marks.length);
    const when = state.held ? heldName() : frame.time === null ? "compared states, at different times" : Format.at(frame.time);
    const words = { columns: state.columns, head: [Report.title, `${shown().map((s) => s.about.title).join(" and ")}, ${when}`], numbers: numbersOf, foot: (marked ? "Ring: peak; cross: centre of pressure. " : "") + (panels.some((p) => numbersOf(p).length) ? Report.headline + "." : "") };
    Figures.saveCanvas(mapsPicture(maps, panels, state.bars, words), fileName(`${state.surface.about.title} ${state.held ? heldName() : Format.time(frame)}`));
  }

  // ---- tables, texts, provenance ----
  function tables(main) {
    if (!Report.tables.length) return;
    const section = make("section", { id: "tables" }, make("h2", { text: "Numbers" }),
      make("p", { class: "about", text: compared ? `As printed by dea compare, of the compared states; differences are relative to ${results[last].label}.` : "As printed by dea run." }));
    for (const t of Report.tables) {
      if (t.title) section.append(make("p", { class: "tabletitle", text: t.title.charAt(0).toUpperCase() + t.title.slice(1) }));
      if (!t.headings.length) continue;
      if (t.rows.length > 40) section.append(make("details", { open: true }, make("summary", { text: `${t.rows.length} rows` }), makeTable(t)));
      else section.append(makeTable(t));
    }
    main.append(section);
    for (const t of Report.texts)
      main.append(make("section", {}, make("h2", { text: t.title }),
        make("p", { class: "about", text: "What dea info prints: how the model was understood. Each line can be overridden on the command line or in a settings file: dea run --help." }),
        make("pre", { text: t.text })));
  }
  function foot() {
    const rows = results.map((r) => [r.label, r.file, r.software || "–", String(r.times.length), r.times.length ? `${Format.short(r.times[0], 9)} to ${Format.short(r.times[r.times.length - 1], 9)}` : "–"]);
    makeFoot(`${Report.exact ? "Maps hold the files’ own numbers." : "Maps hold numbers in 16 bits: within 1/65534 of the range of the state."} Numbers in figures and tables were computed from the files before.`,
      makeTable({ headings: ["result", "file", "written by", "states", "times"], left: "lllrl", rows }));
  }

  // ---- keys ----
  function keys(e) {
    if (e.ctrlKey || e.metaKey || e.altKey || !Report.surfaces.length) return;
    const tag = e.target.tagName, control = ["SELECT", "TEXTAREA", "SUMMARY"].includes(tag) || (tag === "INPUT" && e.target.type !== "range");
    if (control) return;
    if (e.key === " ") {
      if (tag === "BUTTON") return;
      e.preventDefault();
      if (Report.frames.length > 1) player.play(!player.on);
    } else if (e.key === "ArrowLeft" || e.key === "ArrowRight") {
      e.preventDefault();
      player.play(false);
      setFrame(state.frame + (e.key === "ArrowRight" ? 1 : -1));
    }
  }

  async function start() {
    build();
    followReader(state, () => { maps.theme = state.theme; maps.request(); update(); if (!Report.surfaces.length) drawFigures(); },
      () => { player.play(false); maps.draw(true); [...figures.now, ...figures.time].forEach((f) => Figures.draw(f, state)); });
    document.addEventListener("keydown", keys);
    if (Report.surfaces.length) await setSurface(0, -1);
    else drawFigures();
    document.documentElement.dataset.ready = "true";
    maps.setVeil(Report.context);
  }
  startPage(start);

  window.hold = Object.assign(hold, { css: Colours.css, bar: paintBar, step: scaleStep, handles: moveHandles, theme: () => state.theme });
  return { state, maps, setFrame, setSurface, update, get panels() { return panels; } };
})();
