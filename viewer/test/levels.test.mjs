// What Khronos's validator says of levels of detail in one file.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import validator from "gltf-validator";
import { REMESH, data } from "./browser.mjs";

// It knows no levels, so that it has only these to say, and takes the coarser nodes for unused.
const KNOWN = new Set(["UNSUPPORTED_EXTENSION", "UNUSED_OBJECT"]);

/** An OBJ of two objects with a material and texture coordinates: the model of data/ twice. */
function painted() {
  const lines = readFileSync(data("blob.obj"), "utf8").split("\n");
  const vertices = lines.filter((line) => line.startsWith("v ")).map((line) => line.split(/\s+/).slice(1).map(Number));
  const faces = lines.filter((line) => line.startsWith("f ")).map((line) => line.split(/\s+/).slice(1).map((v) => parseInt(v)));
  const copy = (name, x, base) => [
    `o ${name}`,
    ...vertices.map(([a, b, c]) => `v ${a + x} ${b} ${c}\nvt ${a / 4} ${b / 4}`),
    "usemtl paint",
    ...faces.map((face) => `f ${face.map((v) => `${v + base}/${v + base}`).join(" ")}`),
  ];
  return ["mtllib paint.mtl", ...copy("left", 0, 0), ...copy("right", 5, vertices.length)].join("\n");
}

for (const ending of ["glb", "gltf"]) {
  test(`levels in ${ending} are valid`, async () => {
    const folder = mkdtempSync(join(tmpdir(), "remesh-levels-"));
    try {
      writeFileSync(join(folder, "paint.mtl"), "newmtl paint\nKd 1 0.5 0\n");
      writeFileSync(join(folder, "painted.obj"), painted());
      const words = ["painted.obj", `out.${ending}`, "--levels", "2000,600,200", "-q"];
      const ran = spawnSync(REMESH, words, { cwd: folder });
      assert.equal(ran.status, 0, String(ran.stderr));
      const bytes = new Uint8Array(readFileSync(join(folder, `out.${ending}`)));
      const { issues, info } = await validator.validateBytes(bytes);
      assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], JSON.stringify(issues.messages));
      assert.deepEqual(issues.messages.filter(({ code }) => !KNOWN.has(code)), []);
      assert.deepEqual([info.extensionsUsed, info.materialCount], [["MSFT_lod"], 1]);
    } finally {
      rmSync(folder, { recursive: true });
    }
  });
}
