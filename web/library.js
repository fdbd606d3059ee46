// The library as a module of WebAssembly. Requests and answers are bytes, which `src/envelope.rs` describes.

/**
 * Starts the library. `told` has the functions `stage`, which gets a name, and `progress`, which gets a share of 1. Gives a
 * function that asks it: a request, and the contents of files that belong to it, for an answer and its files. That function
 * throws what the library's errors say, and `Fault` for what leaves the library unusable.
 */
export async function startLibrary(module, told) {
  const text = (at, length) => new TextDecoder().decode(bytes(at, length));
  const bytes = (at, length) => new Uint8Array(library.memory.buffer, at >>> 0, length >>> 0);
  const page = {
    stage: (at, length) => told.stage(text(at, length)),
    progress: (done) => told.progress(done),
    panicked: (at, length) => {
      throw new Fault(text(at, length));
    },
  };
  const { exports: library } = await WebAssembly.instantiate(module, { page });

  return function ask(request, files = []) {
    try {
      const letter = new TextEncoder().encode(JSON.stringify({ sizes: files.map((file) => file.length), content: request }));
      const parts = [lengthOf(letter), letter, ...files];
      const size = parts.reduce((sum, part) => sum + part.length, 0);
      let at = library.make_room(size);
      for (const part of parts) {
        bytes(at, part.length).set(part);
        at += part.length;
      }
      return opened(bytes(library.answer(), library.answer_length()));
    } catch (error) {
      throw error instanceof WebAssembly.RuntimeError || error instanceof RangeError ? new Fault(error.message) : error;
    }
  };
}

/** What ends the library: a fault of its own, or a lack of memory. */
export class Fault extends Error {
  name = "Fault";
}

function lengthOf(letter) {
  return new Uint8Array(Uint32Array.of(letter.length).buffer);
}

/** The answer in an envelope: its kind, what it says, and copies of its files. */
function opened(envelope) {
  const length = new DataView(envelope.buffer, envelope.byteOffset).getUint32(0, true);
  const { sizes, content } = JSON.parse(new TextDecoder().decode(envelope.subarray(4, 4 + length)));
  if (content.error !== undefined) throw new Error(content.error);
  let at = 4 + length;
  const files = sizes.map((size) => envelope.slice(at, (at += size)));
  const [[kind, said]] = Object.entries(content);
  return { kind, ...said, files };
}
