// Runs the program on a model, for comparison with the page's result.

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { REMESH, data } from "../../viewer/test/browser.mjs";

/** Remeshes a model of data/ with the arguments `words`. Returns the outputs by extension, for each of `endings`. */
export function natively(model, words, endings) {
  const folder = mkdtempSync(join(tmpdir(), "remesh-web-"));
  const stem = model.replace(/\.\w+$/, "");
  const name = (ending) => `${stem}-remeshed.${ending}`;
  const made = endings.map((ending) => {
    const isReport = ending === "html";
    const report = isReport ? ["--report", name(ending)] : ["--quiet"];
    const output = name(isReport ? endings[0] : ending);
    // The report has the names as given, so the model is in the working folder.
    execFileSync("cp", [data(model), folder]);
    execFileSync(REMESH, [model, output, ...words.split(" "), ...report], { cwd: folder });
    return [ending, readFileSync(join(folder, name(ending)))];
  });
  rmSync(folder, { recursive: true });
  return Object.fromEntries(made);
}
