// The program in a worker: files in, lines as they come, files out. State is not reset between runs of the command line:
// a worker is for one. A worker that is `live` is for one joint: it answers as long as it is asked.
"use strict";
let live = null;  // answers a question
onmessage = async ({ data }) => {
  if (data.ask !== undefined) live(data);
  else await begin(data);
};

async function begin({ module, words, files, live: stays }) {
  const output = [], start = performance.now();
  let unfinished = "", why = "", tell = (line) => postMessage({ line });
  // Of standard error: a bar that is written over, and lines.
  function errors(text) {
    const lines = (unfinished + text).split("\n");
    unfinished = lines.pop();
    for (const line of lines) {
      const shown = line.split("\r\x1b[K").pop();
      if (shown) tell(shown);
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
    if (stays) {
      // `ask`: a number of the asker's own; `from`: bodies of an earlier answer, or null. Answers { ask, code, text,
      // pressure, lines, seconds, memory }; text: of dea.live/1.
      live = ({ ask, words, quick, from }) => {
        const lines = [], asked = performance.now();
        tell = (line) => lines.push(line);
        try {
          const code = dea.ccall("dea_live", "number", ["string", "number", "string"], ["dea\n" + words.map((w) => w + "\n").join(""), quick ? 1 : 0, from ? JSON.stringify(from) : ""]);
          const text = dea.ccall("dea_live_text", "string"), answer = text ? JSON.parse(text) : null;
          const count = answer ? answer.surfaces.reduce((n, s) => Math.max(n, s.begin + s.count), 0) : 0;
          const at = dea.ccall("dea_live_pressure", "number") >>> 2, pressure = dea.HEAPF32.slice(at, at + count);
          postMessage({ ask, code, text: answer, pressure, lines, seconds: (performance.now() - asked) / 1000, memory: dea.HEAPU8.length }, [pressure.buffer]);
        } catch (error) {
          postMessage({ fault: `${why} ${error && error.message ? error.message : error}`.trim() });
        }
      };
      postMessage({ ready: true });
      return;
    }
    const code = dea.callMain(words);
    if (unfinished) postMessage({ line: unfinished });
    const made = [], given = new Set(files.map((f) => f.name));
    for (const name of FS.readdir("/files"))
      if (!given.has(name) && FS.isFile(FS.stat(name).mode)) made.push({ name, blob: new Blob([FS.readFile(name)]) });
    postMessage({ code, output: output.join("\n"), made, seconds: (performance.now() - start) / 1000 });
  } catch (error) {
    postMessage({ fault: `${why} ${error && error.message ? error.message : error}`.trim() });
  }
}
