// One run of the program: files in, lines as they come, files out. State is not reset between runs: a worker is for one.
"use strict";
onmessage = async ({ data: { module, words, files } }) => {
  const output = [], begin = performance.now();
  let unfinished = "", why = "";
  // Of standard error: a bar that is written over, and lines.
  function errors(text) {
    const lines = (unfinished + text).split("\n");
    unfinished = lines.pop();
    for (const line of lines) {
      const shown = line.split("\r\x1b[K").pop();
      if (shown) postMessage({ line: shown });
    }
    const bar = unfinished.split("\r\x1b[K");
    if (bar.length < 2) return;
    unfinished = "";
    if (bar.at(-1)) postMessage({ progress: bar.at(-1) });
  }
  try {
    const contents = [];
    for (const { name, file } of files) {
      try {
        contents.push(new Uint8Array(await file.arrayBuffer()));
      } catch (error) {
        throw new Error(`${name}: cannot be read (${error.message}); if it has changed since it was opened, open it again`);
      }
    }
    const setup = {
      preRun: [() => { setup.ENV.TERM = "page"; }],
      thisProgram: "dea",
      noInitialRun: true,
      print: (line) => output.push(line),
      onAbort: (what) => { why = String(what); },
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(module, imports).then((instance) => done(instance, module), (error) => postMessage({ fault: String(error) }));
        return {};
      }
    };
    const dea = await createDea(setup), { FS } = dea, errorStream = FS.streams[2], decoder = new TextDecoder();
    // As a terminal has it: a bar while it works, whole lines for what it has to say.
    errorStream.stream_ops = { ...errorStream.stream_ops, write(stream, bytes, offset, length) {
      errors(decoder.decode(bytes.slice(offset, offset + length), { stream: true }));
      return length;
    } };
    FS.mkdir("/files");
    FS.chdir("/files");
    files.forEach(({ name }, i) => FS.writeFile(name, contents[i], { canOwn: true }));
    contents.length = 0;
    const code = dea.callMain(words);
    if (unfinished) postMessage({ line: unfinished });
    const made = [], given = new Set(files.map((f) => f.name));
    for (const name of FS.readdir("/files"))
      if (!given.has(name) && FS.isFile(FS.stat(name).mode)) made.push({ name, blob: new Blob([FS.readFile(name)]) });
    postMessage({ code, output: output.join("\n"), made, seconds: (performance.now() - begin) / 1000 });
  } catch (error) {
    postMessage({ fault: `${why} ${error && error.message ? error.message : error}`.trim() });
  }
};
