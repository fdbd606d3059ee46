// Calls the page's library without a browser. It gives the same results as the program.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { startLibrary } from "../library.js";
import { ROOT, data } from "../../viewer/test/browser.mjs";
import { natively } from "./program.mjs";

const MODULE = join(process.env.PAGE ?? join(ROOT, "target/web"), "remesh.wasm");

let module;

before(async () => {
  module = await WebAssembly.compile(readFileSync(MODULE));
});

/** Starts a library. Returns its request function, its default form, and the stages and shares that it reports. */
async function fresh() {
  const stages = [];
  const shares = [];
  const told = { stage: (name) => stages.push(name), progress: (done) => shares.push(done) };
  const ask = await startLibrary(module, told);
  return { ask, form: ask("describe").form, stages, shares };
}

const text = (words) => new TextEncoder().encode(words);

/** Loads files given as pairs of names and contents. */
function load({ ask, form }, files) {
  return ask({ load: { names: files.map(([name]) => name), form } }, files.map(([, content]) => content));
}

const loadModel = (library, name) => load(library, [[name, readFileSync(data(name))]]);

for (const [model, points, options, words] of [
  ["blob.obj", 1500, { adapt: 0.5 }, "--adapt 0.5"],
  ["bracket.stl", 1500, {}, ""],
  ["terrain.ply", null, { edge_length: 3, features: "none" }, "--edge-length 3 --features none"],
  ["noisy.ply", 1000, { smooth: 4, seed: 7 }, "--smooth 4 --seed 7"],
  ["shell.off", 800, { max_error: "4%", attributes: false }, "--max-error 4% --no-attributes"],
]) {
  test(`${model} becomes the same bytes as by the program`, async () => {
    const library = await fresh();
    loadModel(library, model);
    const form = { ...library.form, points: points && String(points), ...options };
    const made = library.ask({ remesh: { form } });
    const endings = model === "blob.obj" ? ["obj", "ply", "stl", "off", "gltf", "glb", "3mf", "vtp"] : ["obj", "ply"];
    const expected = natively(model, [points && `--points ${points}`, words].filter(Boolean).join(" "), endings);
    assert.equal(made.verified, true);
    for (const ending of endings) {
      const { names, files } = library.ask({ save: { format: ending } });
      assert.deepEqual(names, [`${model.split(".")[0]}-remeshed.${ending}`]);
      assert.ok(expected[ending].equals(files[0]), `${ending} differs`);
    }
    assert.ok(library.stages.includes("relax") && library.stages[0] === "read", String(library.stages));
    assert.ok(library.shares.at(-1) === 1 && library.shares.every((x, i, all) => i === 0 || x >= all[i - 1]));
  });
}

test("the report is the page that the program writes", async () => {
  const library = await fresh();
  loadModel(library, "bracket.stl");
  library.ask({ remesh: { form: { ...library.form, points: "1000" } } });
  const { html } = natively("bracket.stl", "--points 1000", ["stl", "html"]);
  const { names, files } = library.ask("page");
  assert.deepEqual(names, ["bracket-remeshed.html"]);
  assert.ok(html.equals(files[0]));
  const report = JSON.parse(Buffer.from(library.ask("json").files[0]));
  assert.equal(report.verified, true);
  assert.equal(report.output.topology.vertices, 1000);
});

test("a library and an image that are dropped with an OBJ come along", async () => {
  const library = await fresh();
  const corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  const obj = text(`mtllib a.mtl\n${corners}usemtl red\nf 1/1 2/2 3/3 4/4\n`);
  const png = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 1, 2, 3);
  const mtl = text("newmtl red\nKd 1 0 0\nmap_Kd wood.png\n");
  const { name, triangles } = load(library, [["wood.png", png], ["a.mtl", mtl], ["a.obj", obj]]);
  assert.deepEqual([name, triangles], ["a.obj", 2]);
  library.ask({ remesh: { form: { ...library.form, points: "30" } } });
  const { names, files } = library.ask({ save: { format: "obj" } });
  assert.deepEqual(names, ["a-remeshed.obj", "a-remeshed-0.png", "a-remeshed.mtl"]);
  assert.deepEqual(files[1], png);
  assert.match(Buffer.from(files[2]).toString(), /newmtl red\nKd 1 0 0\nmap_Kd a-remeshed-0\.png/);
  assert.deepEqual(library.ask({ save: { format: "stl" } }).lost.map((line) => line.split(":")[0]), ["texture coordinates", "materials"]);

  load(library, [["a.obj", obj]]);
  const { main } = library.ask("measure");
  assert.match(main, /the file (&#39;|')a\.mtl(&#39;|') was not dropped: drop both files together/);
});

test("what cannot be done is said in the words of the page", async () => {
  const library = await fresh();
  const refused = (content, name = "a.obj") => () => load(library, [[name, text(content)]]);
  assert.throws(refused("v 0 0 nan"), /^Error: a\.obj:1: the coordinate 'nan' is not finite; /);
  assert.throws(refused("<COLLADA>", "a.dae"), /it is a COLLADA file, which is not supported; convert it/);
  assert.throws(refused("OFF\n1 0 0\n0 0 0\n"), /rename the file or give off as its format/);
  loadModel(library, "bracket.stl");
  const remeshed = (options) => () => library.ask({ remesh: { form: { ...library.form, ...options } } });
  assert.throws(remeshed({ points: "1.5" }), /^Error: Vertices: it must be a whole number/);
  assert.throws(remeshed({ edge_length: 1 }), /^Error: Edge length: it cannot be given together with the number of points/);
  assert.throws(remeshed({ adapt: 2 }), /^Error: Grading: /);
  assert.throws(() => library.ask({ save: { format: "obj" } }), /no result yet/);
});

test("the form has the fields that errors name", async () => {
  const { ask } = await fresh();
  const page = readFileSync(join(ROOT, "web/index.html"), "utf8");
  for (const label of ask("describe").labels) assert.match(page, new RegExp(`<(label|option)[^>]*>${label}\\b`), label);
});

test("a panic ends the library with what it says", async () => {
  const { ask, form } = await fresh();
  // Larger than possible, so that memory for it cannot be allocated.
  const endless = { length: 3e9 };
  assert.throws(() => ask({ load: { names: ["a.obj"], form } }, [endless]), { name: "Fault", message: /capacity overflow/ });
});
