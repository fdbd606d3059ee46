// Runs the library in its own thread. It receives the compiled module first, then requests, which it answers in order.

import { startLibrary } from "./library.js";

/** Last percent of progress sent: it is sent once for each percent. */
let percent = 0;

const told = {
  stage(stage) {
    percent = 0;
    postMessage({ stage });
  },
  progress(done) {
    if (Math.floor(100 * done) === percent) return;
    percent = Math.floor(100 * done);
    postMessage({ done });
  },
};

let library;

onmessage = async ({ data: { module, request, files } }) => {
  if (module) {
    library = startLibrary(module, told);
    return;
  }
  try {
    const ask = await library;
    const contents = await Promise.all(files.map(async (file) => new Uint8Array(await file.arrayBuffer())));
    const from = performance.now();
    const answer = ask(request, contents);
    const seconds = (performance.now() - from) / 1000;
    postMessage({ answer: { ...answer, seconds } }, answer.files.map((file) => file.buffer));
  } catch (error) {
    postMessage({ error: { name: error.name, message: error.message } });
  }
};
