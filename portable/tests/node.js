// dea.js in node, as the page has it: node node.js DEA.js WORD... The files of the current folder are there; what comes new is
// written beside them.
"use strict";
const fs = require("fs"), path = require("path");
const [program, ...words] = process.argv.slice(2);
const createDea = require(path.resolve(program));
createDea({
  thisProgram: "dea", noInitialRun: true,
  wasmBinary: fs.readFileSync(program.replace(/\.js$/, ".wasm")),
  print: (line) => process.stdout.write(line + "\n"),
  printErr: (line) => process.stderr.write(line + "\n")
}).then((dea) => {
  const { FS } = dea, given = fs.readdirSync(".").filter((name) => fs.statSync(name).isFile());
  FS.mkdir("/files");
  FS.chdir("/files");
  for (const name of given) FS.writeFile(name, fs.readFileSync(name));
  process.exitCode = dea.callMain(words);
  for (const name of FS.readdir("/files"))
    if (!given.includes(name) && FS.isFile(FS.stat(name).mode)) fs.writeFileSync(name, FS.readFile(name));
});
