// The library as a WebAssembly module. Requests and answers are bytes in the format described in `src/envelope.rs`.

/**
 * Starts the library. `told` has the functions `stage`, called with a name, and `progress`, called with a share from 0 to 1.
 * Returns a function that sends the library a request with the contents of its files, and returns the answer with its files.
 * That function throws an `Error` with the library's message, or a `Fault` if the library has become unusable.
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

/** A failure that ends the library: a panic, a trap, or a lack of memory. */
export class Fault extends Error {
  name = "Fault";
}

function lengthOf(letter) {
  return new Uint8Array(Uint32Array.of(letter.length).buffer);
}

/** Returns the answer in an envelope: its kind, its members, and copies of its files. */
function opened(envelope) {
  const length = new DataView(envelope.buffer, envelope.byteOffset).getUint32(0, true);
  const { sizes, content } = JSON.parse(new TextDecoder().decode(envelope.subarray(4, 4 + length)));
  if (content.error !== undefined) throw new Error(content.error);
  let at = 4 + length;
  const files = sizes.map((size) => envelope.slice(at, (at += size)));
  const [[kind, said]] = Object.entries(content);
  return { kind, ...said, files };
}
