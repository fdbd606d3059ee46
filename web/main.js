// The page. It passes files and options to a job, and shows the answers.

import { listenForFiles } from "./choice.js";
import { fillForm, readForm } from "./form.js";
import { Cancelled, Job } from "./job.js";
import { clear, save, show } from "./result.js";

const byId = (id) => document.getElementById(id);

/** The library, compiled once for all workers. */
const library = compiled();

/** The current files, and whether they have not been processed yet; the running job, and the last job that has a result. */
let files = [];
let areNew = false;
let running = null;
let finished = null;

async function compiled() {
  const answer = await fetch("remesh.wasm");
  if (!answer.ok) throw new Error(`remesh.wasm cannot be loaded: ${answer.status} ${answer.statusText}`);
  return WebAssembly.compile(await answer.arrayBuffer());
}

const told = {
  stage(stage) {
    byId("status").textContent = `${stage} …`;
  },
  progress(done) {
    byId("progress").value = done;
  },
};

async function start() {
  const job = new Job(await library, told);
  const described = await job.ask("describe");
  job.end();
  fillForm(described);
  byId("version").textContent = described.version;
  byId("formats").textContent = `Reads ${described.read.map(({ name }) => name).join(", ")}, also compressed with gzip.`;
  byId("save-format").append(...described.written.map(({ name, ending }) => new Option(name, ending)));
  listenForFiles((given) => {
    [files, areNew] = [given, true];
    byId("remesh").disabled = false;
    run();
  });
  byId("form").addEventListener("submit", (event) => {
    event.preventDefault();
    run();
  });
  byId("cancel").addEventListener("click", () => running?.end());
  byId("save-mesh").addEventListener("click", () => hand({ save: { format: byId("save-format").value } }));
  byId("save-page").addEventListener("click", () => hand("page"));
  byId("save-json").addEventListener("click", () => hand("json"));
  document.documentElement.dataset.page = "ready";
}

/** Remeshes the files. New ones are measured and shown first. */
async function run() {
  if (!byId("form").reportValidity()) return;
  running?.end();
  const form = readForm();
  const job = new Job(await library, told);
  running = job;
  const isFirst = areNew;
  if (isFirst) forget();
  areNew = false;
  begin();
  try {
    const load = { names: files.map((file) => file.name), form };
    const { name, vertices, triangles, is_shown } = await job.ask({ load }, files);
    named(name, `${vertices} vertices, ${triangles ? `${triangles} triangles` : "no triangles"}`);
    // The worker continues while the input is drawn.
    const shown = isFirst && is_shown ? job.ask("measure").then(show) : null;
    const [result] = await Promise.all([job.ask({ remesh: { form } }), shown]);
    finish(job, result);
  } catch (error) {
    job.end();
    if (running === job) fail(error);
  }
}

/** Discards the result of the previous files. */
function forget() {
  finished?.end();
  finished = null;
  byId("save").hidden = true;
  clear();
  named(files[0].name, "");
}

function named(name, counts) {
  byId("file").textContent = name;
  byId("counts").textContent = counts;
}

function begin() {
  document.body.classList.add("has-file");
  byId("choose").textContent = "Choose another file";
  byId("error").hidden = true;
  byId("remesh").disabled = true;
  byId("cancel").hidden = byId("going").hidden = false;
  // Without a value, the bar is indeterminate.
  byId("progress").removeAttribute("value");
  told.stage("start");
  document.documentElement.dataset.page = "busy";
}

function end(said) {
  const isFocused = document.activeElement === byId("cancel");
  byId("remesh").disabled = false;
  byId("cancel").hidden = byId("going").hidden = true;
  if (isFocused) byId("remesh").focus();
  byId("status").textContent = said;
  running = null;
}

function finish(job, { verified, vertices, format, seconds, ...shown }) {
  finished?.end();
  finished = job;
  show(shown);
  byId("save-format").value = format;
  byId("lost").textContent = "";
  byId("save").hidden = false;
  const advice = verified ? "" : " Try another seed, or more vertices.";
  end(`${verified ? "Verified" : "Not verified"}: ${vertices} vertices in ${seconds.toFixed(1)} s.${advice}`);
  document.documentElement.dataset.page = "done";
}

function fail(error) {
  const isCancelled = error instanceof Cancelled;
  end(isCancelled ? "Cancelled." : "");
  if (!isCancelled) tell(error);
  document.documentElement.dataset.page = isCancelled ? "cancelled" : "failed";
}

function tell(error) {
  byId("cause").textContent = cause(error);
  byId("error").hidden = false;
}

/** Returns the text of an error for users. */
function cause({ name, message }) {
  if (name !== "Fault") return message;
  return `The library stopped unexpectedly. The mesh may be too large for the memory of a page; the program \
remesh can use more. Otherwise this is a bug in remesh: please report it with the file and this message.\n${message}`;
}

/** Requests files of the result, and saves them. */
async function hand(request) {
  try {
    const made = await finished.ask(request);
    save(made);
    byId("lost").textContent = made.lost.length ? `Not in the file: ${made.lost.join("; ")}.` : "";
  } catch (error) {
    if (!(error instanceof Cancelled)) tell(error);
  }
}

byId("unable").hidden = true;
// For instance, a model that cannot be fetched.
addEventListener("unhandledrejection", ({ reason }) => tell(reason));
start().catch((error) => {
  tell(error);
  document.documentElement.dataset.page = "failed";
});
