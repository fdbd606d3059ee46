// A job: a worker that holds one mesh. A job that is cancelled or fails ends with its worker. The next job gets a new one.

/** The rejection of requests to a job that was ended. */
export class Cancelled extends Error {}

export class Job {
  #worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  /** Pending requests. Answers arrive in the order of the requests. */
  #waiting = [];

  /** `told` has the functions `stage` and `progress`. */
  constructor(module, told) {
    this.#worker.onmessage = ({ data: { stage, done, answer, error } }) => {
      if (stage !== undefined) told.stage(stage);
      else if (done !== undefined) told.progress(done);
      else if (answer) this.#settle("resolve", answer);
      else this.#settle("reject", Object.assign(new Error(error.message), { name: error.name }));
    };
    this.#worker.onerror = (event) => this.#settle("reject", new Error(event.message ?? "the worker cannot be loaded"));
    this.#worker.postMessage({ module });
  }

  /** Sends a request to the library. */
  ask(request, files = []) {
    return new Promise((resolve, reject) => {
      this.#waiting.push({ resolve, reject });
      this.#worker.postMessage({ request, files });
    });
  }

  end() {
    this.#worker.terminate();
    while (this.#waiting.length) this.#settle("reject", new Cancelled());
  }

  #settle(how, value) {
    this.#waiting.shift()?.[how](value);
  }
}
