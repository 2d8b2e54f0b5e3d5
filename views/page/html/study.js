// The page of a study: what is chosen for all figures, sections, tables, saving.
"use strict";

const Page = (() => {
  const columns = Report.columns, one = Report.study;
  const state = { statistic: 0, place: 0, choice: Math.max(0, Report.choices.length - 1), x: 0, second: -1, third: -1, kind: "map", fixed: [], by: -1, lines: { places: [], values: [] }, dosed: null, theme: "light" };
  const figures = [];
  Report.choices = Report.choices.map((c) => c.replace(/^time (.+)/, (all, time) => Format.at(time)));
  let places = null, ticket = 0;

  // ---- small things ----
  const plural = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  const select = (id, label, options, value, change) => makeSelect(id, label, options, value, (v) => change(Number(v)));
  const shown = (x) => (typeof x === "number" ? Format.short(x, 5) : x === "" ? "–" : String(x));
  function table(t, most = 200) {
    const left = t.headings.map((h, i) => (t.rows.some((r) => typeof r[i] === "string" && r[i] !== "") ? "l" : "r"));
    const out = makeTable({ headings: t.headings, left, rows: t.rows.slice(0, most).map((r) => r.map(shown)) });
    return t.rows.length > most ? make("div", {}, out, make("p", { class: "count", text: `The first ${most} of ${t.rows.length} rows; CSV has all.` })) : out;
  }
  const placeOf = (number) => { if (!places) places = new Map([...Study.numbers].map((n, i) => [n, i])); return places.get(number) ?? -1; };

  // ---- head: failures first, then what the study is ----
  function head() {
    const units = Report.units.length ? `Units: ${[Report.units.length, Report.units.force, Report.units.pressure].join(", ")}.` : "No units are known: neither --units nor the model, where it is still beside the study, names them.";
    makeHead(`A study of ${plural(one.there, "case")} with ${plural(one.states, "state")}${one.models.length > 1 ? ` of ${one.models.length} models` : ""}, by discrete element analysis. ${units}`);
    failures();
  }
  function reasons(list) {
    return make("ul", {}, ...list.slice(0, 8).map((r) => make("li", { text: `${plural(r.cases, "case")} (${r.which}): ${r.text}` })), list.length > 8 ? make("li", { text: `and ${list.length - 8} more kinds` }) : null);
  }
  function failures() {
    const f = Report.failures, lines = [], missing = one.planned - one.there;
    if (missing > 0) lines.push(make("p", { text: `${missing} of ${one.planned} cases are not solved yet: this page is of the others.` }));
    if (f.cases > 0) {
      lines.push(make("p", { text: `${f.cases} of ${plural(one.there, "case")} ${f.cases === 1 ? "is" : "are"} no solution: ${one.failed} failed, ${one.refused} refused. Their numbers are left out everywhere below, and counted.` }), reasons(f.reasons));
      if (f.states > 0) lines.push(make("p", { text: `States that are no solution: ${f.states}.` }), reasons(f.outcomes));
      const t = { headings: f.headings, rows: f.rows };
      lines.push(make("details", {}, make("summary", { text: "Which cases" }), save(t, "failed"), table(t, 100)));
    }
    const warned = f.warnings.reduce((n, w) => n + w.count, 0);
    if (warned > 0) lines.push(make("p", { text: `${plural(warned, "warning")} of ${plural(f.warnings.length, "kind")}:` }), reasons(f.warnings));
    for (const note of Report.notes) lines.push(make("p", { text: note.charAt(0).toUpperCase() + note.slice(1) + "." }));
    $("head").append(lines.length ? make("div", { class: "warnings", id: "failures" }, ...lines) : make("div", { class: "good", id: "failures" }, make("p", { text: `All ${plural(one.there, "case")} are solutions, without a warning.` })));
  }
  const save = (t, id) => make("p", { class: "save" }, make("button", { text: "CSV", "data-save": "csv", onclick: () => saveCsv(t, id) }));
  function facts() {
    const rows = [];
    const add = (name, text) => rows.push(make("dt", { text: name }), make("dd", { text }));
    add("File", `${one.file}, made by dea ${one.version}${one.shard[1] > 1 ? `; shard ${one.shard[0]} of ${one.shard[1]} of ${one.whole} cases` : ""}`);
    add("Cases", `${one.there} of ${one.planned}: ${one.solved} solved, ${one.failed} failed, ${one.refused} refused; ${Format.short(one.seconds, 3)} s of computing`);
    add(one.models.length > 1 ? "Models" : "Model", one.models.slice(0, 12).join(", ") + (one.models.length > 12 ? ` and ${one.models.length - 12} more` : ""));
    for (const f of one.factors) {
      const c = columns.find((x) => x.name === f.name), fixed = Report.constant.find((x) => x.name === f.name);
      const values = c ? (c.levels.length > 14 ? `${c.levels.length} values from ${c.levels[0]} to ${c.levels.at(-1)}` : c.levels.join(", ")) : fixed ? `always ${fixed.value}` : "";
      add(`Factor ${f.name}`, `--${f.option} ${f.text}${f.spread ? `, drawn ${f.spread}` : ""}: ${values}`);
    }
    add("States", one.same_times && one.times.length ? `${one.states}: ${Format.at(one.times.length > 14 ? `${one.times[0]} to ${one.times.at(-1)}` : one.times.join(", "))}` : `up to ${one.states}; their times differ from case to case`);
    add("Options", one.options.join("  "));
    const told = columns.filter((c) => c.of).map((c) => `${c.name} (${c.levels.length > 6 ? `${c.levels.length} values` : c.levels.join(", ")})`);
    if (Report.subjects) add("Subjects", `${Report.subjects}, ${told.length ? `a row per ${columns.find((c) => c.of).of}: ${told.join("; ")}` : "of which nothing differs from case to case"}`);
    if (Report.contacts.length) add(Report.contacts.length > 1 ? "Contacts" : "Contact", Report.contacts.slice(0, 8).map(([name, source, target]) => `${name} (source ${source}, target ${target})`).join("; ") + (Report.contacts.length > 8 ? ` and ${Report.contacts.length - 8} more` : ""));
    add("Numbers", Report.headline + `. p99: 99th percentile. Force: size of the contact's force.${Report.statistics.some((s, i) => StudyFigures.isInside(i)) ? " Inside the cartilage: p99 over what is pressed, weighted by area; of the third principal strain, which is below 0, the first percentile; source and target as above. Largest of all states: of the third principal strain the least." : ""}`);
    makeSection("study", "The study", make("dl", { class: "facts" }, ...rows), one.inputs.length === 0 ? null : make("details", {}, make("summary", { text: plural(one.inputs.length, "input file") }), table({ headings: ["file", "CRC-32 and size"], rows: one.inputs })));
  }

  // ---- what is chosen for all figures ----
  function choose() {
    const controls = make("div", { class: "controls" }, select("statistic", "Number", Report.statistics.map((s, i) => [i, s.title]), state.statistic, (v) => { state.statistic = v; choosePlace(); changed(); }));
    if (Report.places.length > 1) controls.append(make("span", { id: "place-host" }));
    if (Report.choices.length > 1) controls.append(select("choice", "State", Report.choices.map((c, i) => [i, c]), state.choice, (v) => { state.choice = v; changed(); }));
    $("main").append(make("div", { class: "choose" }, controls));
    choosePlace();
  }
  // Those that have the number.
  function choosePlace() {
    const host = $("place-host"), there = Report.places.map((p, i) => [i, p.title]).filter(([i]) => StudyFigures.hasPlace(state.statistic, i));
    if (!host) return;
    if (!there.some(([i]) => i === state.place)) {
      const near = there.find(([i]) => Report.places[i].contact === Report.places[state.place].contact) || there[0];
      if (near) state.place = near[0];
    }
    host.replaceChildren(select("place", "Contact or region", there, state.place, (v) => { state.place = v; changed(); }));
  }
  function headlineTable() {
    const unit = (s) => (Format.unit(s.dimension) ? ` [${Format.unit(s.dimension)}]` : "");
    return { headings: ["", ...StudyFigures.boxHeadings], rows: Report.statistics.map((s, i) => [i, s]).filter(([i]) => StudyFigures.hasPlace(i, state.place)).map(([i, s]) => [s.quantity + unit(s), ...StudyFigures.boxCells(Report.summary[i][state.place][state.choice])]) };
  }
  function drawHeadlines() {
    $("headlines-about").textContent = `${StudyFigures.where(state)}. Left out: cases without a solution or without contact. sd: standard deviation over the cases.`;
    $("headlines-table").replaceChildren(table(headlineTable()), save(headlineTable(), "all cases"));
  }

  // ---- figures ----
  function figureElement(f) {
    const rows = make("details", { class: "numbers", ontoggle: () => f.drawn() }, make("summary", { text: "Table" }));
    f.drawn = () => { if (rows.open) rows.replaceChildren(rows.firstChild, table(f.table(state), 60)); };
    figures.push(f);
    Figures.element(f, state).append(rows);
    // a mark of a case: the maps turn to it
    f.plot.addEventListener("click", (e) => {
      const said = e.target.querySelector && e.target.querySelector("title"), found = said && /^case (\d+)\b/.exec(said.textContent);
      if (found && Report.maps && StudyMaps.showCase(Number(found[1]))) $("maps").scrollIntoView({ behavior: "smooth" });
    });
    return f.element;
  }
  const figureRow = (...list) => make("div", { class: "figures" }, ...list.map(figureElement));
  function drawFigures() {
    for (const s of sections()) s.hidden = false;  // or its figures have no width
    Figures.drawAll(figures, state, 60, hideEmptySections);
  }
  // A section of which nothing is shown but its heading.
  function hideEmptySections() {
    const empty = (e) => e.hidden || (e.classList.contains("figures") ? [...e.children].every((f) => f.hidden) : !e.hasChildNodes());
    for (const s of sections()) s.hidden = [...s.children].slice(1).every(empty);
  }
  const sections = () => new Set(figures.map((f) => f.element.closest("section")));
  async function changed() {
    const mine = ++ticket;
    await Study.load(state.statistic, state.place);
    if (Report.bands) state.lines = { places: await Data.array(Report.bands.drawn), values: await Data.array(Report.bands.lines[state.statistic][state.place]) };
    if (mine !== ticket) return;
    drawHeadlines();
    if (Report.influence) drawInfluence();
    if (Report.groups) drawGroups();
    if (Report.pairs) drawPairs();
    drawFigures();
  }

  // ---- response ----
  function response() {
    const s = makeSection("response", "Response");
    if (Study.own.length) {
      // numbers with most values first; words are lines and panels
      const rank = Study.own.map((c, k) => k).sort((a, b) => columns[b].numeric - columns[a].numeric || columns[b].levels.length - columns[a].levels.length);
      state.x = rank[0];
      state.second = rank[1] ?? -1;
      const told = columns.map((c, k) => k).filter((k) => columns[k].of);
      if (told.length && rank.length === 1 && !columns[rank[0]].numeric) {
        // each case has a name of its own: what the table of subjects tells of it says more
        state.x = told.find((k) => columns[k].numeric) ?? (Report.groups ? Report.groups.column : told[0]);
        state.second = [Report.groups && Report.groups.column, Report.pairs && Report.pairs.column, ...told].find((k) => k !== null && k !== undefined && k !== state.x && columns[k].levels.length <= 12) ?? -1;
      }
      state.third = Report.grid && rank.length > 2 && columns[rank[2]].levels.length <= 6 ? rank[2] : -1;
      state.fixed = Study.own.map((c) => c.shown[Math.floor((c.shown.length - 1) / 2)]);
      state.kind = StudyFigures.canMap(state) && columns[state.second].levels.length > 2 && columns[state.x].levels.length > 2 ? "map" : "curve";
      const controls = make("div", { class: "controls", id: "response-controls" });
      s.append(controls, figureRow(StudyFigures.responseFigure()));
      responseControls();
    } else s.append(make("p", { class: "about", text: "Nothing differs from case to case." }));
    if (Report.bands) {
      const few = [...new Set(Report.bands.groups.map((g) => g.column))].filter((c) => c >= 0);
      // of a few models each curve has a name
      const named = [Report.groups && Report.groups.column, columns.findIndex((c) => c.name === "model" && c.levels.length <= 6)].find((c) => few.includes(c));
      state.by = named ?? -1;
      if (few.length) s.append(make("div", { class: "controls" }, select("by", "Cycles by", [[-1, "all cases"], ...few.map((c) => [c, columns[c].name])], state.by, (v) => { state.by = v; changed(); })));
      s.append(figureRow(StudyFigures.cycleFigure()));
    }
  }
  function responseControls() {
    const host = $("response-controls"), names = columns.map((c, k) => [k, c.name]), none = [[-1, "–"]], redraw = () => { responseControls(); drawFigures(); };
    host.replaceChildren(select("x", "Over", names, state.x, (v) => { state.x = v; if (state.second === v) state.second = -1; if (state.third === v) state.third = -1; redraw(); }));
    if (columns.length > 1) host.append(select("second", StudyFigures.gridded(state) ? "and" : "Colour", [...none, ...names.filter(([k]) => k !== state.x)], state.second, (v) => { state.second = v; if (state.third === v) state.third = -1; redraw(); }));
    if (!StudyFigures.gridded(state)) return;
    if (StudyFigures.canMap(state))
      host.append(make("span", { class: "group", role: "group" }, ...[["map", "map"], ["curve", "curves"]].map(([kind, text]) => make("button", { id: "kind-" + kind, text, "aria-pressed": String(state.kind === kind), onclick: () => { state.kind = kind; redraw(); } }))));
    const { second, third } = StudyFigures.response(state);
    const own = names.slice(0, Study.own.length);
    if (own.length > 2) host.append(select("third", "panel per value of", [...none, ...own.filter(([k]) => k !== state.x && k !== second)], third, (v) => { state.third = v; redraw(); }));
    Study.own.forEach((c, k) => {
      if ([state.x, second, third].includes(k)) return;
      host.append(select("fixed" + k, `at ${c.name} =`, Study.columns[k].shown.slice(0, 400).map((i) => [i, c.levels[i]]), state.fixed[k], (v) => { state.fixed[k] = v; redraw(); }));
    });
  }

  // ---- what matters, groups, pairs ----
  function influence() {
    const i = Report.influence, words = [i.no_sobol, i.no_slopes].filter(Boolean).join(" ");
    makeSection("influence", "What matters", words ? make("p", { class: "about", text: words }) : null, figureRow(...StudyFigures.influenceFigures()), make("div", { id: "slopes" }));
  }
  // A table below figures, anew.
  function below(id, title, about, t, name) {
    $(id).replaceChildren(make("p", { class: "tabletitle", text: title }), make("p", { class: "about", text: about }), table(t), save(t, name));
  }
  function drawInfluence() {
    const t = StudyFigures.slopeTable(state);
    if (!t.rows.length) return $("slopes").replaceChildren();
    below("slopes", `One at a time, about case ${Report.influence.base}`, `Slope of ${StudyFigures.statistic(state).title.toLowerCase()} by each factor, all others as in this case; from the neighbours on both sides (central) or on one. Last column: percent of the number per percent of the factor.`, t, "slopes");
  }
  function drawGroups() {
    const of = StudyFigures.ofState(Report.groups.numbers, state), c = columns[Report.groups.column], x = StudyFigures.exact;
    const t = { headings: [c.name, `less ${c.levels[0]}`, "95 % from", "95 % to", "Cohen's d", "Hedges' g", "n", `n of ${c.levels[0]}`], rows: of.differences.map((d, l) => [c.levels[l + 1], x(d.mean), ...d.interval.map(x), x(d.d), x(d.g), d.count[0], d.count[1]]) };
    below("group-differences", "Differences of means", "Intervals are Welch's; d and g are over the pooled standard deviation. Intervals take the cases for a random sample of what is asked about, which the cases of a planned study are not; nothing here is a test.", t, "differences of groups");
  }
  function drawPairs() {
    const p = StudyFigures.ofState(Report.pairs.numbers, state), c = columns[Report.pairs.column], x = StudyFigures.exact;
    const t = { headings: ["", "value", "95 % from", "95 % to"], rows: [["mean difference", p.mean, p.interval], ["standard deviation of differences", p.sd], ["median difference", p.median], ["lower limit of agreement", p.limits[0], p.lower_interval],
      ["upper limit of agreement", p.limits[1], p.upper_interval], ["effect size d_z", p.dz], ["the same, corrected for few pairs", p.g]].map(([name, value, interval = [null, null]]) => [name, x(value), ...interval.map(x)]) };
    below("pair-numbers", `${c.levels[Report.pairs.first]} less ${c.levels[Report.pairs.second]}`, `${plural(p.pairs, "pair")}; ${p.left_out} left out, of which a case has no number; ${plural(Report.pairs.alone, "case")} without a partner. Intervals are Student's; nothing here is a test.`, t, "pairs");
  }

  // ---- maps, regions, dose ----
  function maps() {
    const s = makeSection("maps", "Turning the joint");
    if (!Report.maps) s.append(make("p", { class: "about", text: one.solved === 0 ? "No case is a solution, so there is no map." : "The study has no stored pressures: solve it with --keep fields for maps, regions and doses." }));
    return s;
  }
  function mapMoved(number) {
    if (number === state.dosed) return;
    state.dosed = number;
    const f = figures.find((x) => x.id === "dose");
    if (f) Figures.draw(f, state);
  }
  function casesTable() {
    const statistics = Report.places.length ? Report.statistics : [];
    const headings = ["case", "outcome", ...columns.map((c) => c.name), ...statistics.map((s) => s.name)], rows = [];
    for (let i = 0; i < Study.count; ++i)
      rows.push([Study.numbers[i], ["solved", "failed", "refused"][Study.outcomes[i]], ...columns.map((c, k) => Study.level(k, i)), ...statistics.map((s, k) => StudyFigures.exact(Study.value(state, i, state.choice, k)))]);
    return { headings, rows };
  }
  async function cases() {
    const host = make("div", {}), details = make("details", { ontoggle: async () => { if (details.open) host.replaceChildren(table(await loaded(), 100)); } }, make("summary", { text: `Table of ${plural(Study.count, "case")}` }), host);
    const loaded = async () => { for (let k = 0; Report.places.length && k < Report.statistics.length; ++k) await Study.load(k, state.place); return casesTable(); };
    makeSection("cases", "Cases", make("p", { class: "about", text: `${Report.places.length ? "Of the contact or region and the state that are chosen above." : "No case has numbers: all were refused."}${Report.all ? "" : ` ${Study.count} of ${one.there} cases.`} dea study FILE.db --csv writes all numbers of all states.` }),
      make("p", { class: "save" }, make("button", { id: "cases-csv", text: "CSV", "data-save": "csv", onclick: async () => saveCsv(await loaded(), "cases") })), details);
  }
  const foot = () => makeFoot("Statistics were computed from the study's file before; figures draw numbers in single precision, maps hold them in 16 bits.");
  const api = { state, figures, placeOf, mapMoved, changed };
  // Whatever is of the contacts' numbers: no case has any where none was more than refused. Returns the maps' section.
  function numbers() {
    choose();
    makeSection("headlines", "All cases", make("p", { class: "about", id: "headlines-about" }), make("div", { id: "headlines-table" }));
    response();
    const mapSection = maps();
    if (Report.influence) influence();
    if (Report.groups) makeSection("groups", `Groups by ${columns[Report.groups.column].name}`, figureRow(StudyFigures.groupFigure()), make("div", { id: "group-differences" }));
    if (Report.pairs) makeSection("pairs", `Pairs by ${columns[Report.pairs.column].name}`, figureRow(...StudyFigures.pairFigures()), make("div", { id: "pair-numbers" }));
    if (Report.places.length > 1) makeSection("regions", "Regions", figureRow(StudyFigures.placeFigure()));
    if (Report.maps && Report.maps.dose && Report.maps.dose.cases.length) makeSection("dose", "Dose", figureRow(StudyFigures.doseFigure()));
    return mapSection;
  }
  async function start() {
    head();
    await Study.start();
    facts();
    const mapSection = Report.places.length ? numbers() : null;
    await cases();
    foot();
    followReader(state, () => { if (Report.maps) StudyMaps.setTheme(state.theme); drawFigures(); },
      () => { figures.forEach((f) => Figures.draw(f, state)); if (Report.maps) StudyMaps.maps.forEach((m) => m && m.draw(true)); });
    if (Report.places.length) await changed();
    if (Report.maps && mapSection) {
      const whole = Report.places.map((p, i) => i).filter((i) => !Report.places[i].part);
      for (const p of whole) for (let k = 0; k < Report.statistics.length; ++k) await Study.load(k, p);
      await StudyMaps.start(mapSection, api);
      StudyMaps.setTheme(state.theme);
    }
    document.documentElement.dataset.ready = "true";
  }
  startPage(start);
  return api;
})();
