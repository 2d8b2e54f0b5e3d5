// The joint in the hand in node, as the page's worker has it: node live.js DEA.js < QUESTIONS. A line of standard input is
// a question: {"words": [...], "quick": false, "follow": false}; a line of standard output its answer: {code, text, pressure, seconds}; `follow`: from the bodies of the answer before. The
// files of the current folder are there.
"use strict";
const fs = require("fs"), path = require("path");
const [program] = process.argv.slice(2);
const questions = fs.readFileSync(0, "utf8").split("\n").filter(Boolean).map((line) => JSON.parse(line));
const createDea = require(path.resolve(program));
createDea({
  thisProgram: "dea", noInitialRun: true,
  wasmBinary: fs.readFileSync(program.replace(/\.js$/, ".wasm")),
  print: (line) => process.stderr.write(line + "\n"),
  printErr: (line) => process.stderr.write(line + "\n")
}).then((dea) => {
  const { FS } = dea;
  FS.mkdir("/files");
  FS.chdir("/files");
  for (const name of fs.readdirSync(".").filter((name) => fs.statSync(name).isFile())) FS.writeFile(name, fs.readFileSync(name));
  let from = "";
  for (const { words, quick, follow } of questions) {
    const begin = process.hrtime.bigint();
    const code = dea.ccall("dea_live", "number", ["string", "number", "string"], ["dea\n" + words.map((w) => w + "\n").join(""), quick ? 1 : 0, follow ? from : ""]);
    const text = dea.ccall("dea_live_text", "string"), answer = text ? JSON.parse(text) : null;
    const count = answer ? answer.surfaces.reduce((n, s) => Math.max(n, s.begin + s.count), 0) : 0;
    const at = dea.ccall("dea_live_pressure", "number") >>> 2, pressure = Array.from(dea.HEAPF32.slice(at, at + count));
    if (answer && answer.solved) from = JSON.stringify(answer.bodies);
    const seconds = Number(process.hrtime.bigint() - begin) / 1e9;
    console.log(JSON.stringify({ code, text: answer, pressure, seconds, memory: dea.HEAPU8.length }));
  }
});
