// A job: a worker with one mesh in it. A job that is cancelled or has failed ends with its worker; the next one gets another.

/** Why a job that was ended has no answer. */
export class Cancelled extends Error {}

export class Job {
  #worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  #waiting = null;

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

  /** Asks the library; one request at a time. */
  ask(request, files = []) {
    return new Promise((resolve, reject) => {
      this.#waiting = { resolve, reject };
      this.#worker.postMessage({ request, files });
    });
  }

  end() {
    this.#worker.terminate();
    this.#settle("reject", new Cancelled());
  }

  #settle(how, value) {
    const waiting = this.#waiting;
    this.#waiting = null;
    waiting?.[how](value);
  }
}
