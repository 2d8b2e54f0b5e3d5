// The page that solves: files, settings, runs of the program in workers, their results.
"use strict";

const fault = (text) => make("p", { class: "fault", text });

// ---- what is packed in this page ----

// What a page made by dea run --live has: files in base64 of a zlib stream, and words of their run.
async function given() {
  const bytes = (element) => Uint8Array.from(atob(element.textContent), (c) => c.charCodeAt(0));
  const files = [], kinds = new Map();
  for (const element of document.querySelectorAll("script.given")) {
    const plain = new Response(new Blob([bytes(element)]).stream().pipeThrough(new DecompressionStream("deflate")));
    files.push(new File([await plain.blob()], element.dataset.name));
    kinds.set(element.dataset.name, element.dataset.kind);
  }
  return { files, kinds, words: files.length ? JSON.parse(new TextDecoder().decode(bytes($("given-words")))) : [] };
}

// portable/page/make_page: gzip, then 13 bits in two characters.
async function unpacked(id) {
  const text = $(id).textContent, bytes = new Uint8Array(Number($(id).dataset.bytes)), digit = (c) => c - (c > 60 ? 33 : 32);
  for (let i = 0, n = 0, bits = 0, held = 0; n < bytes.length; i += 2) {
    held |= (digit(text.charCodeAt(i)) + 94 * digit(text.charCodeAt(i + 1))) << bits;
    for (bits += 13; bits >= 8 && n < bytes.length; bits -= 8, held >>>= 8) bytes[n++] = held & 255;
  }
  $(id).textContent = "";
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}

// ---- the program ----

const Program = (() => {
  let parts = null;
  async function load() {
    const [code, module] = await Promise.all([unpacked("code").then((r) => r.blob()), unpacked("module").then((r) => r.arrayBuffer()).then((b) => WebAssembly.compile(b))]);
    return { url: URL.createObjectURL(new Blob([code], { type: "text/javascript" })), module };
  }
  const kTooLarge = "The model needs more memory than a browser gives a page: 4 GB, or less on a small computer. Take the program dea for it.";
  function worded(text) {
    if (/call stack|stack overflow|recursion/i.test(text)) return `dea ran out of stack: ${text}`;
    const crashed = /out of bounds|unreachable|null function|signature/i.test(text);
    if (!crashed && /memory|OOM|allocation|Array buffer|ArrayBuffer|array length/i.test(text)) return kTooLarge;
    return `dea ended without an answer: ${text}`;
  }
  // `files`: [{ name, file }]; `tell` gets { progress } or { line }. { done: a promise of { code, output, lines, made,
  // seconds }, or of { fault }; stop() }.
  function run(words, files, tell = () => {}) {
    let worker = null, end = null;
    const lines = [];
    const done = new Promise((resolve) => {
      end = (answer) => { if (worker) worker.terminate(); worker = null; resolve({ lines, ...answer }); };
      if (files.reduce((sum, { file }) => sum + file.size, 0) > 2e9) { end({ fault: kTooLarge }); return; }
      parts ??= load();
      parts.then(({ url, module }) => {
        if (!end) return;
        worker = new Worker(url);
        worker.onmessage = ({ data }) => {
          if (data.line !== undefined) lines.push(data.line);
          if (data.fault !== undefined) end({ fault: worded(data.fault) });
          else if (data.code !== undefined) end(data);
          else tell(data);
        };
        worker.onerror = (e) => { e.preventDefault(); end({ fault: worded(e.message || "the worker could not be started") }); };
        worker.postMessage({ module, words, files });
      }).catch((error) => end && end({ fault: `This browser cannot run the program: ${error.message}. Browsers of 2023 or later can.` }));
    });
    return { done, stop() { const stopped = end; end = null; stopped({ stopped: true }); } };
  }
  // A worker that keeps the joints of these files ready: ask({ ask, words, quick }), as often as is wanted.
  function stay(files, answered, failed) {
    let worker = null, ready = false, ended = false;
    const waiting = [];
    parts ??= load();
    parts.then(({ url, module }) => {
      if (ended) return;
      worker = new Worker(url);
      worker.onmessage = ({ data }) => {
        if (data.fault !== undefined) failed(worded(data.fault));
        else if (data.ask !== undefined) answered(data);
        else if (data.ready) { ready = true; for (const q of waiting.splice(0)) worker.postMessage(q); }
      };
      worker.onerror = (e) => { e.preventDefault(); failed(worded(e.message || "the worker could not be started")); };
      worker.postMessage({ module, words: [], files, live: true });
    });
    return {
      ask(question) { if (ready) worker.postMessage(question); else waiting.push(question); },
      end() { ended = true; if (worker) worker.terminate(); }
    };
  }
  return { run, stay };
})();

// ---- what is typed ----

// So that every shell reads one word: as it is; in double quotes; for the rest as a POSIX shell has it.
function quoted(word) {
  if (/^[\w.,:=\/+@%-]+$/.test(word)) return word;
  return /^[^"$`\\!%]+$/.test(word) ? `"${word}"` : `'${word.replaceAll("'", "'\\''")}'`;
}
const commandLine = (words) => ["dea", ...words].map(quoted).join(" ");

// The words of a line, as a shell splits them; throws where a quote is not closed.
function splitWords(text) {
  const words = [];
  let word = null, quote = "";
  let escaped = false;
  for (const c of text) {
    if (escaped) { word = (word ?? "") + c; escaped = false; }
    else if (c === "\\" && !quote) escaped = true;
    else if (quote) { if (c === quote) quote = ""; else word += c; }
    else if (c === '"' || c === "'") { quote = c; word ??= ""; }
    else if (/\s/.test(c)) { if (word !== null) words.push(word); word = null; }
    else word = (word ?? "") + c;
  }
  if (quote) throw new Error(`More options: a ${quote} is not closed`);
  if (word !== null) words.push(word);
  return words;
}

// Onto the clipboard, as the button says for a moment; where that is not ours, `element` is ready to be copied.
async function copyText(button, text, element) {
  try { await navigator.clipboard.writeText(text); } catch {
    getSelection().selectAllChildren(element);
    document.execCommand("copy");
  }
  const before = button.textContent;
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = before; }, 1500);
}

// ---- files ----

const Files = (() => {
  const all = new Map();  // name -> { file, kind, number }
  let count = 0;
  const kinds = { feb: "model", xml: "settings", xplt: "result" };
  const words = { model: "the model", settings: "settings file, below what is set here", result: "to compare with", table: "a table: choose it in the settings", part: "a part of the model" };
  const kindOf = (name) => kinds[name.split(".").pop().toLowerCase()] || "table";
  const names = (kind) => [...all.keys()].filter((n) => all.get(n).kind === kind);
  // `kinds`: of those whose names do not tell.
  function add(list, kinds = new Map()) {
    const kindIs = (name) => kinds.get(name) || kindOf(name), models = list.filter((f) => kindIs(f.name) === "model"), said = [];
    // a new model is a new start
    if (models.length && names("model").length) { all.clear(); Form.clear(); }
    for (const file of list) {
      const kind = kindIs(file.name);
      if (kind === "model" && file !== models[0]) { said.push(`One model at a time: ${models[0].name} is opened, ${file.name} is not.`); continue; }
      if (kind === "settings") names("settings").forEach((n) => all.delete(n));
      all.delete(file.name);
      all.set(file.name, { file, kind, number: ++count });
    }
    return said;
  }
  // The one to be recognised: a model, or for want of one what dea has to say of another file.
  function model() { return names("model")[0] || (names("result").length > 1 ? "" : [...all.keys()][0] || ""); }
  function size(bytes) { return bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`; }
  function show() {
    $("files").replaceChildren(...[...all].map(([name, { file, kind }]) => make("li", {},
      make("span", { class: "name", text: name }), make("span", { class: "about", text: `${size(file.size)}, ${words[kind]}` }),
      make("button", { class: "plain", text: "take away", "aria-label": `Take away ${name}`, onclick: () => { all.delete(name); tell("files", []); changed(true); } }))));
  }
  // A name that none of them has.
  function free(stem, ending) {
    let name = stem + ending;
    for (let n = 2; all.has(name); ++n) name = `${stem}_${n}${ending}`;
    return name;
  }
  return {
    add, show, model, names, free,
    get list() { return [...all].map(([name, { file }]) => ({ name, file })); },
    get marks() { return [...all].map(([name, { number }]) => [name, number]); }
  };
})();

// ---- settings ----

const Form = (() => {
  // What the page sets itself, or has no use for here.
  const own = ["--help", "-o", "--live", "--json", "--csv", "--report", "--no-xplt", "--overwrite", "--quiet", "--verbose", "--details", "--compress",
    "--vtu", "--threads", "--settings", "--error-on", "--compartments-csv", "--facets-csv"];
  const rows = [];  // { option, words(): what is typed, clear(), tables(names) }
  let infoOptions = new Set(), runOptions = infoOptions;

  function build(tree) {
    const options = (name) => tree.commands.find((c) => c.name === name).options.map((o) => ({ ...o, name: o.names.at(-1) }));
    infoOptions = new Set(options("info").map((o) => o.name));
    runOptions = new Set(options("run").map((o) => o.name));
    const wanted = options("run").filter((o) => !o.names.some((n) => own.includes(n))), all = new Set(wanted.map((o) => o.name));
    const groups = new Map();
    for (const o of wanted) {
      const off = "--no-" + o.name.slice(2);
      if (o.name.startsWith("--no-") && all.has("--" + o.name.slice(5))) continue;
      if (!groups.has(o.group)) groups.set(o.group, []);
      groups.get(o.group).push(field(o, all.has(off) ? wanted.find((x) => x.name === off) : null));
    }
    // what changes results first, outputs last
    const order = [...groups.keys()].sort((a, b) => (a === "Output") - (b === "Output"));
    const titles = { Output: "States and output", "Placing, in the order of the line": "Placing: turns, then moves" };
    for (const group of order)
      $("form").append(make("details", { "data-group": group }, make("summary", {}, titles[group] || group, " ", make("span", {})), make("div", { class: "fields" }, ...groups.get(group))));
    $("form").append(more());
    $("form").append(make("p", { class: "controls" }, make("button", { type: "button", id: "clear", text: "Clear all settings", onclick: () => { clear(); changed(); } })),
      ...["BODY", "SURFACE", "NAME", "MATERIAL", "NAME.PARAMETER"].map((kind) => make("datalist", { id: "names-" + kind })));
    $("form").addEventListener("input", () => changed());
    $("form").addEventListener("submit", (e) => e.preventDefault());
    clear();
  }

  const listOf = (kind) => (["BODY", "SURFACE", "NAME", "MATERIAL", "NAME.PARAMETER"].includes(kind) ? "names-" + kind : null);
  // For one value: words to choose from, a file that was opened, or a text.
  function control(o, form, label) {
    const choices = o.words.length && o.words.length === form.split("|").length ? o.words : null;
    if (!choices && !o.file) return make("input", { type: "text", placeholder: form, list: listOf(form), "aria-label": label, spellcheck: "false" });
    return make("select", { "aria-label": label, "data-file": o.file, "data-kind": form.split(".").pop() }, make("option", { value: "", text: o.file ? "no file" : "" }), ...(choices || []).map((w) => make("option", { value: w, text: w })));
  }

  function field(o, off) {
    const id = "set" + o.name, help = make("p", { class: "help", id: id + "-help", text: o.help });
    const several = o.repeats, equals = o.value.indexOf("="), keyed = equals >= 0 && several;
    const box = make("div", { class: "field" }), pairs = [];
    let place = null;
    function pair() {
      const row = make("div", { class: "pair" }), parts = [];
      if (keyed) {
        const key = o.value.slice(0, equals).replace("[", ""), optional = o.value.startsWith("[");
        parts.push(make("input", { type: "text", placeholder: optional ? "all" : key, list: listOf(key), "aria-label": `${o.name}: ${key}`, spellcheck: "false" }));
      }
      parts.push(off ? make("select", {}, make("option", { value: "", text: "" }), make("option", { value: o.name, text: "yes" }), make("option", { value: off.name, text: "no" }))
        : control(o, keyed ? o.value.slice(equals + 1).replace("]", "") : o.value, keyed ? `${o.name}: value` : null));
      parts.forEach((p, i) => { p.setAttribute("aria-describedby", help.id); if (!keyed && !pairs.length) p.id = id; if (keyed && i) p.before("="); });
      if (keyed) row.append(parts[0], "=", parts[1]); else row.append(parts[0]);
      pairs.push({ row, parts });
      place.append(row);
    }
    place = make("div", {});
    const another = several ? make("button", { type: "button", class: "plain", text: "another one", "aria-label": `${o.name}: another one`, onclick: () => { pair(); Form.tables(); pairs.at(-1).parts[0].focus(); } }) : null;
    box.append(keyed ? make("span", { class: "label", text: o.name }) : make("label", { for: id, text: o.name }), place, ...(another ? [another] : []), help);
    if (keyed) { box.setAttribute("role", "group"); box.setAttribute("aria-label", o.name); }
    pair();
    rows.push({
      o, box, get parts() { return pairs.flatMap((p) => p.parts); },
      words() {
        const out = [];
        for (const { parts } of pairs) {
          const value = parts.at(-1).value.trim(), key = keyed ? parts[0].value.trim() : "";
          if (off) { if (value) out.push(value); }
          else if (value || key) out.push(o.name, key ? `${key}=${value}` : keyed && !o.value.startsWith("[") ? `=${value}` : value);
        }
        return out;
      },
      clear() { while (pairs.length > 1) pairs.pop().row.remove(); for (const p of pairs[0].parts) p.value = ""; }
    });
    return box;
  }

  function more() {
    const input = make("input", { type: "text", id: "more", spellcheck: "false", "aria-describedby": "more-help", placeholder: "--details --facets-csv facets.csv" });
    const box = make("div", { class: "field" }, make("label", { for: "more", text: "More options" }), make("div", { class: "pair" }, input),
      make("p", { class: "help", id: "more-help", text: "As on the command line, behind those above: other outputs, moves in an order of their own. Names with spaces in quotes." }));
    rows.push({ o: { name: "more", group: "" }, box, parts: [input], more: true, words: () => splitWords(input.value), clear() { input.value = ""; } });
    return box;
  }

  // Typed for a command; dea info has no settings of outputs.
  function words(command) {
    const out = [], isSkipped = (name) => command === "info" && runOptions.has(name) && !infoOptions.has(name);
    for (const r of rows) {
      let skipped = !r.more && isSkipped(r.o.name);
      for (const word of r.words()) {
        if (r.more && /^-[^\d.]/.test(word)) skipped = /^-[^-]/.test(word) ? command === "info" : isSkipped(word.split("=")[0]);
        if (!skipped) out.push(word);
      }
    }
    return out;
  }
  // Behind all that is set.
  function say(words) { rows.find((r) => r.more).parts[0].value = words.map(quoted).join(" "); }
  const set = () => rows.some((r) => r.parts.some((p) => p.value.trim()));
  function clear() { rows.forEach((r) => r.clear()); mark(""); }

  // Names of the model, as suggestions.
  function suggest(info) {
    const surfaces = info.contacts.flatMap((c) => [c.primary?.surface, c.secondary?.surface]), bodies = info.bodies.map((b) => b.name);
    const lists = {
      BODY: [...bodies, "ground"], SURFACE: surfaces, NAME: info.contacts.map((c) => c.name),
      MATERIAL: info.contacts.flatMap((c) => [c.primary?.material, c.secondary?.material]),
      "NAME.PARAMETER": [...info.ligaments.flatMap((l) => [`${l.name}.stiffness`, `${l.name}.slack-length`]), ...info.cables.flatMap((c) => [`${c.name}.force`])]
    };
    for (const [kind, list] of Object.entries(lists))
      $("names-" + kind).replaceChildren(...[...new Set(list)].filter(Boolean).map((value) => make("option", { value })));
  }

  // Files that were opened, for settings that take one.
  function tables() {
    const known = [...Files.names("table"), ...Files.names("result")].filter((n) => n !== Files.model());
    for (const select of document.querySelectorAll("#form select[data-file]")) {
      const wanted = known.filter((n) => /\.xplt$/i.test(n) === (select.dataset.kind === "xplt")), value = select.value;
      select.replaceChildren(make("option", { value: "", text: wanted.length ? "" : "no file is open" }), ...wanted.map((n) => make("option", { value: n, text: n })));
      select.value = wanted.includes(value) ? value : "";
    }
  }

  // Which are set, and the one that a fault names.
  function mark(line) {
    const named = /^dea: (--[\w-]+)/.exec(line);
    const counts = new Map();
    for (const r of rows) {
      let set = false;
      try { set = r.words().length > 0; } catch { set = true; }
      r.box.classList.toggle("set", set);
      if (set) counts.set(r.o.group, (counts.get(r.o.group) || 0) + 1);
      const wrong = !!named && named[1] === r.o.name;
      for (const p of r.parts) if (wrong) p.setAttribute("aria-invalid", "true"); else p.removeAttribute("aria-invalid");
      if (wrong) r.box.closest("details").open = true;
    }
    for (const d of document.querySelectorAll("#form details")) {
      const n = counts.get(d.dataset.group);
      d.querySelector("summary span").textContent = n ? `${n} set` : "";
    }
  }
  return { build, words, say, set, clear, suggest, tables, mark };
})();

// ---- recognise, solve, compare ----

let recognising = null, solving = null, solved = null, waiting = 0, refused = false;
let recognised = null;  // { info: of dea info --json, key: what it is of }
const told = { files: [], info: [], run: [] };  // what is wrong, by who said it

// What a run depends on.
function asked() {
  let words;
  try { words = JSON.stringify(Form.words("run")); } catch (error) { words = error.message; }
  return JSON.stringify([Files.model(), Files.marks, words]);
}
const settingsFile = () => Files.names("settings").flatMap((n) => ["--settings", n]);
const typedName = (name) => (name.startsWith("-") ? "./" + name : name);
const comparing = () => !Files.model() && Files.names("result").length > 1;

function tell(who, lines) {
  told[who] = lines.filter(Boolean);
  $("faults").replaceChildren(...[...new Set([...told.files, ...told.info, ...told.run])].map(fault));
}
function say(text) { if ($("status").textContent !== text) $("status").textContent = text; }

// After every change of files or settings.
function changed(files = false) {
  if (files) {
    if (solving) stop("The files have changed: the run was stopped.");
    Files.show();
    Form.tables();
  }
  $("work").hidden = !Files.list.length;
  $("solve").textContent = comparing() ? "Compare" : "Solve";
  Form.mark("");
  showAge();
  clearTimeout(waiting);
  if (recognising) recognising.stop();
  recognising = null;
  tell("info", []);
  tell("run", []);
  refused = false;
  if (!Files.list.length || comparing()) { $("model").hidden = true; buttons(); return; }
  buttons();
  waiting = setTimeout(recognise, files ? 0 : 350);
}

function buttons() {
  $("solve").disabled = !!solving || refused || !Files.list.length;
  $("stop").hidden = !solving;
  $("progress").hidden = !solving;
}

const kLooking = "looking at the model …";

async function recognise() {
  const model = Files.model(), json = Files.free("info", ".json");
  let typed;
  try { typed = Form.words("info"); } catch (error) { tell("info", [error.message]); return; }
  const words = ["info", typedName(model), ...typed, ...settingsFile(), "--json", json];
  const run = Program.run(words, Files.list.filter((f) => !/\.xplt$/i.test(f.name) || f.name === model)), key = asked();
  recognising = run;
  if (!solving) $("activity").textContent = kLooking;
  const answer = await run.done;
  if (recognising !== run) return;
  recognising = null;
  if ($("activity").textContent === kLooking) $("activity").textContent = "";
  refused = !!answer.fault || answer.code !== 0;
  tell("info", [answer.fault, ...answer.lines]);
  Form.mark(answer.lines?.find((l) => /^dea: --/.test(l)) || "");
  if (answer.output) {
    $("model").hidden = false;
    $("info").textContent = answer.output;
    const made = answer.made.find((m) => m.name === json);
    if (made) {
      recognised = { info: JSON.parse(await made.blob.text()), key };
      Form.suggest(recognised.info);
      if (solved && solved.key === key && !solving && !$("take")) await takeInHand($("result"));  // it was solved sooner
    }
  } else {
    // a setting may be what is wrong: it stays in reach
    $("model").hidden = !Form.set();
    $("info").textContent = "Nothing: see the line above.";
  }
  say(refused ? "" : `${model} is recognised.`);
  buttons();
}

function show(message) {
  if (message.progress === undefined) return;
  const text = message.progress.replace(/^\[[#.]*\] /, ""), [, at, of] = /(\d+) of (\d+)/.exec(text) || [];
  $("activity").textContent = text;
  if (of) $("progress").value = (Number(at) - (/of \d+:/.test(text) ? 1 : 0)) / Number(of);
  const step = text.split(/[:,(]/)[0].trim();
  if (performance.now() - show.last > 4000) { show.last = performance.now(); say(step); }
}
show.last = 0;

// `handed`: once it is solved, it is taken in the hand.
async function solve(handed = false) {
  if (solving || refused || !Files.list.length) return;
  let words;
  try { words = Form.words("run"); } catch (error) { tell("run", [error.message]); return; }
  if (words.some((w) => /^--vtu(=|$)/.test(w))) { tell("run", ["--vtu writes a folder, which a page cannot save: take the program dea for it."]); return; }
  const model = Files.model(), compare = comparing(), key = asked(), files = Files.list, marks = JSON.stringify(Files.marks), results = Files.names("result");
  const stem = (model || results[0]).replace(/\.[^.]*$/, ""), out = (kind, ending) => typedName(Files.free(`${stem}_${kind}`, ending));
  const runWords = ["run", typedName(model), ...words, ...settingsFile(), "-o", out("dea", ".xplt"), "--json", out("dea", ".json"), "--csv", out("dea", ".csv"), "--report", out("dea", ".html")];
  const compareWords = (list) => ["compare", ...list.map(typedName), "--json", out("compare", ".json"), "--csv", out("compare", ".csv"), "--report", out("compare", ".html")];
  $("progress").removeAttribute("value");
  $("activity").textContent = "starting …";
  say(compare ? "Comparing." : "Solving.");
  show.last = performance.now();
  tell("run", []);
  const parts = [];
  const step = async (title, list, given) => {
    solving = Program.run(list, given, show);
    buttons();
    const answer = await solving.done;
    if (answer.stopped) return null;
    parts.push({ title, words: list, ...answer });
    return answer;
  };
  const run = compare ? await step("Comparison", compareWords(results), files) : await step("Result", runWords, files);
  if (!run) return;
  let cut = false;  // what is solved stays
  const plot = run.made?.find((m) => m.name === runWords[runWords.indexOf("-o") + 1].replace(/^\.\//, ""));
  if (!compare && plot && results.length && run.code < 2) {
    $("activity").textContent = "comparing …";
    $("progress").removeAttribute("value");
    const beside = [{ name: plot.name, file: plot.blob }, ...files.filter((f) => results.includes(f.name))];
    cut = !(await step("Comparison", compareWords([plot.name, ...results]), beside));
    if (cut && JSON.stringify(Files.marks) !== marks) return;
  }
  solving = null;
  const unlike = parts.length > 1 && (parts[1].fault || parts[1].code > 1);
  $("activity").textContent = cut ? "The comparison was stopped." : unlike ? "Solved; the comparison below was refused." : "";
  buttons();
  // what refused says why; what was shown before stays, marked as what it is
  if (run.fault || run.code > 1) {
    tell("run", [run.fault, ...run.lines]);
    say("No result.");
    showAge();
    return;
  }
  solved = { key, parts, line: compare ? null : ["run", typedName(model), ...words, ...settingsFile()], files, take: handed };
  await showResult();
}

function stop(why = "Stopped: no result.") {
  if (!solving) return;
  solving.stop();
  solving = null;
  $("activity").textContent = why;
  say(why);
  buttons();
}

// ---- results ----

function save(name, blob) {
  const link = make("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

function showAge() {
  const old = !!solved && solved.key !== asked();
  $("result").classList.toggle("old", old);
  if ($("age")) $("age").hidden = !old;
  if (old) Live.end();
  if ($("take")) $("take").hidden = old || Live.on;
}

async function showResult() {
  const { parts } = solved, place = $("result");
  Live.end();
  place.replaceChildren(make("p", { class: "fault", id: "age", hidden: true, text: "Settings or files have changed since: below is still the result of the command line that stands there. Solve again for the new one." }));
  for (const part of parts) place.append(await partElement(part));
  place.hidden = false;
  await takeInHand(place);
  showAge();
  place.focus({ preventScroll: true });
  place.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
  say(parts.some((p) => p.code === 1) ? "Solved, but not all results are solutions." : "Solved.");
}

// A run that has a page, of the model's own times.
async function takeInHand(place) {
  const frame = place.querySelector("iframe"), { line, files, parts } = solved, info = recognised && recognised.key === solved.key ? recognised.info : null;
  if (!line || !frame || !info || parts[0].code > 1 || line.some((w) => /^--times-from(=|$)/.test(w))) return;
  const json = parts[0].made.find((m) => m.name === parts[0].words[parts[0].words.indexOf("--json") + 1].replace(/^\.\//, ""));
  const times = JSON.parse(await json.blob.text()).states.map((s) => s.time);
  if ($("take")) return;
  const take = () => {
    button.hidden = true;
    Live.start(info, line, files, times, frame, () => { button.hidden = false; button.focus(); });
  };
  const button = make("button", { id: "take", text: "Take it in the hand", title: "Move bodies, loads and cartilage: the map follows", onclick: take });
  frame.before(make("p", {}, button));
  if (!solved.take) return;
  document.documentElement.dataset.live = "taken";
  if (frame.contentWindow && frame.contentWindow.hold) take();
  else frame.addEventListener("load", take, { once: true });
}

async function partElement({ title, words, code, fault: broken, lines, output, made = [] }) {
  const section = make("section", {}, make("h2", { text: title })), line = commandLine(words);
  const copy = make("button", { text: "Copy", "aria-label": "Copy the command line", onclick: () => copyText(copy, line, command) });
  const command = make("pre", { class: "line", text: line });
  section.append(make("div", { class: "command" }, command, copy));
  if (broken || code > 1) { section.append(fault(broken || lines.join("\n"))); return section; }
  const warned = lines.filter((l) => l.startsWith("warning"));
  if (warned.length) section.append(make("div", { class: "warnings" }, make("ul", {}, ...warned.map((l) => make("li", { text: l })))));
  const wanted = words[words.indexOf("--report") + 1].replace(/^\.\//, ""), page = made.find((m) => m.name === wanted);
  const html = page && new Blob([page.blob], { type: "text/html" });
  section.append(make("div", { class: "controls" }, make("span", { class: "about", text: "Save" }),
    ...made.map((m) => make("button", { text: words.some((w, i) => /^(-o|--json|--csv|--report)$/.test(words[i - 1]) && w.replace(/^\.\//, "") === m.name) ? m.name.slice(m.name.lastIndexOf(".")) : m.name, title: m.name, "aria-label": `Save ${m.name}`, onclick: () => save(m.name, m.blob) })),
    html ? make("button", { text: "Open by itself", title: "The page below in a tab of its own", onclick: () => window.open(URL.createObjectURL(html)) }) : null));
  section.append(make("details", {}, make("summary", { text: `What dea ${words[0]} prints` }), make("pre", { class: "printed", tabindex: "0", "aria-label": `What dea ${words[0]} prints`, text: [output, ...lines].join("\n").trim() })));
  if (page) {
    const frame = make("iframe", { title: `${title}: the page of dea ${words[0]} --report` });
    frame.srcdoc = await page.blob.text();
    // as high as what is in it: one page to scroll
    frame.addEventListener("load", () => {
      const body = frame.contentDocument.body, fit = () => { frame.style.height = `${Math.ceil(body.getBoundingClientRect().height) + 2}px`; };
      frame.contentDocument.documentElement.style.overflow = "hidden";
      new ResizeObserver(fit).observe(body);
      fit();
      followTheme(frame);
    });
    section.append(frame);
  }
  return section;
}

// ---- the page ----

function open(list, kinds) {
  const said = Files.add(list, kinds);
  tell("files", said);
  changed(true);
}

// The pages of results follow.
function followTheme(frame) {
  const inside = frame.contentDocument;
  if (inside.documentElement.dataset.theme !== document.documentElement.dataset.theme) inside.getElementById("theme")?.click();
}
function theme() {
  const dark = matchMedia("(prefers-color-scheme: dark)"), set = (name) => {
    document.documentElement.dataset.theme = name;
    $("theme").textContent = name === "dark" ? "Light" : "Dark";
    document.querySelectorAll("iframe").forEach(followTheme);
  };
  set(dark.matches ? "dark" : "light");
  dark.addEventListener("change", (e) => set(e.matches ? "dark" : "light"));
  $("theme").addEventListener("click", () => set(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
}

let sample = null;
async function openSample() {
  sample ??= unpacked("sample-model").then((r) => r.blob());
  open([new File([await sample], $("sample-model").dataset.name)]);
  await solve();
}

async function start() {
  theme();
  $("choose").addEventListener("click", () => $("input").click());
  $("input").addEventListener("change", () => { const list = [...$("input").files]; $("input").value = ""; if (list.length) open(list); });
  $("sample").addEventListener("click", openSample);
  $("solve").addEventListener("click", () => solve());
  $("stop").addEventListener("click", () => stop());
  for (const name of ["dragenter", "dragover"]) document.addEventListener(name, (e) => { e.preventDefault(); $("drop").classList.add("over"); });
  document.addEventListener("dragleave", (e) => { if (!e.relatedTarget) $("drop").classList.remove("over"); });
  document.addEventListener("drop", (e) => {
    e.preventDefault();
    $("drop").classList.remove("over");
    const list = [...e.dataTransfer.files];
    if (list.length) open(list);
  });
  $("licences").closest("details").addEventListener("toggle", async () => { if (!$("licences").textContent) $("licences").textContent = await (await unpacked("licence-texts")).text(); });
  const tree = await Program.run(["completion", "json"], []).done;
  if (tree.code !== 0) { tell("run", [tree.fault, ...tree.lines]); return; }
  Form.build(JSON.parse(tree.output));
  document.documentElement.dataset.ready = "true";
  const version = await Program.run(["--version"], []).done;
  $("version").textContent = (version.output || "").trim().split("\n").join("; ");
  const { files, kinds, words } = await given();
  if (!files.length) return;
  $("sample").remove();
  document.documentElement.dataset.live = "true";
  $("head").querySelector(".sub").before(make("p", {}, make("button", { id: "all", text: "Show files and settings, too", onclick: () => { delete document.documentElement.dataset.live; $("all").remove(); } })));
  document.title = `${files[0].name.replace(/\.[^.]*$/, "")} in the hand`;
  Form.say(words);
  open(files, kinds);
  clearTimeout(waiting);
  await recognise();
  await solve(true);
}
start();
