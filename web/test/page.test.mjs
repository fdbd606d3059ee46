// Uses the page in a browser as users would. Compares numbers and pixels, never whole pictures.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { DESKTOP, PHONE, ROOT, apart, brightness, data, launch, pixels, width } from "../../viewer/test/browser.mjs";
import { natively } from "./program.mjs";
import { serve } from "./server.mjs";

const PAGE = process.env.PAGE ?? join(ROOT, "target/web");

let server;
let browser;

before(async () => {
  server = await serve(PAGE);
  browser = await launch();
});

after(async () => {
  await browser?.close();
  server?.end();
});

/** Opens the page and calls `use` with it. The page must not fail, send anything, or request anything from elsewhere. */
async function open(options, use) {
  const page = await watched({ ...options, acceptDownloads: true });
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("request", (request) => {
    const isOwn = /^(blob|data):/.test(request.url()) || request.url().startsWith(server.address);
    if (!isOwn || request.method() !== "GET") faults.push(`${request.method()} ${request.url()}`);
  });
  await page.goto(server.address);
  await state(page, "ready");
  await use(page);
  await page.close();
  assert.deepEqual(faults, []);
}

/** Opens a page that records its states and the verdicts that it shows, since they may be gone before a test looks. */
async function watched(options) {
  const page = await browser.newPage(options);
  await page.addInitScript(() => {
    window.seen = { states: [], verdicts: [], upTo: 0 };
    const keep = (list, value) => value && value !== list.at(-1) && list.push(value);
    new MutationObserver(() => {
      keep(window.seen.states, document.documentElement?.dataset.page);
      keep(window.seen.verdicts, document.querySelector("#report .verdict h2")?.textContent);
    }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["data-page"] });
  });
  return page;
}

/** Waits until the page has been in a state at some time since the state last waited for. */
function state(page, name) {
  const reached = (name) => {
    const at = window.seen.states.indexOf(name, window.seen.upTo);
    window.seen.upTo = Math.max(window.seen.upTo, at + 1);
    return at >= 0;
  };
  return page.waitForFunction(reached, name, { timeout: 120_000 });
}

/** Drops files, as pairs of names and contents, in the middle of the page. */
async function drop(page, files) {
  const given = files.map(([name, content]) => [name, Buffer.from(content).toString("base64")]);
  const transfer = await page.evaluateHandle((given) => {
    const transfer = new DataTransfer();
    for (const [name, content] of given) {
      transfer.items.add(new File([Uint8Array.from(atob(content), (c) => c.charCodeAt(0))], name));
    }
    return transfer;
  }, given);
  for (const type of ["dragover", "drop"]) await page.dispatchEvent("#report", type, { dataTransfer: transfer });
}

/** Returns the name and the content of the file that a click saves. */
async function saved(page, click) {
  const [download] = await Promise.all([page.waitForEvent("download"), click()]);
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

const degrees = (page, number) => page.textContent(`.figure:nth-child(${number}) b`).then(parseFloat);

test("a dropped STL is remeshed, shown and saved with the bytes of the program", async () => {
  await open(DESKTOP, async (page) => {
    await page.fill("#density", "1500");
    await drop(page, [["bracket.stl", readFileSync(data("bracket.stl"))]]);
    await state(page, "busy");
    await state(page, "done");
    const verdicts = await page.evaluate(() => window.seen.verdicts);
    assert.deepEqual(verdicts, ["bracket.stl: Sound", "Verified"], "the input is shown first");
    assert.equal(await page.textContent("#counts"), "280 vertices, 564 triangles");
    assert.match(await page.textContent("#status"), /^Verified: 1500 vertices in \d+\.\d s\.$/);
    assert.match(await page.textContent("#report .lede"), /^280 → 1500 vertices, 1500 wanted/);
    assert.ok((await degrees(page, 1)) > 20, "the smallest angle is a good one");
    assert.equal(await page.title(), "bracket.stl → bracket-remeshed.stl · remesh");

    const { stl, ply } = natively("bracket.stl", "--points 1500", ["stl", "ply"]);
    const first = await saved(page, () => page.click("#save-mesh"));
    assert.equal(first.name, "bracket-remeshed.stl");
    assert.ok(stl.equals(first.content));
    await page.selectOption("#save-format", "ply");
    const second = await saved(page, () => page.click("#save-mesh"));
    assert.equal(second.name, "bracket-remeshed.ply");
    assert.ok(ply.equals(second.content));
    // Two at once arrive in order.
    const both = [];
    page.on("download", (download) => both.push(download.suggestedFilename()));
    await page.evaluate(() => ["save-mesh", "save-json"].forEach((id) => document.getElementById(id).click()));
    while (both.length < 2) await page.waitForTimeout(50);
    assert.deepEqual(both, ["bracket-remeshed.ply", "bracket-remeshed.json"]);
    const report = await saved(page, () => page.click("#save-page"));
    assert.equal(report.name, "bracket-remeshed.html");
    assert.match(report.content.toString(), /^<!doctype html>/);
    const json = await saved(page, () => page.click("#save-json"));
    assert.equal(JSON.parse(json.content).output.topology.vertices, 1500);
  });
});

test("before and after are drawn side by side, coloured and turned together", async () => {
  await open(DESKTOP, async (page) => {
    await page.click("[data-model='blob.obj']");
    await state(page, "done");
    assert.ok((await degrees(page, 1)) > 35);
    const first = await pixels(page);
    assert.equal(first.length, 2);
    for (const { share } of first) assert.ok(share > 0.1 && share < 0.9, `${share}`);
    assert.ok(Math.abs(first[0].share - first[1].share) < 0.02, "both meshes are of one shape");
    assert.ok(first[1].colour[2] > first[0].colour[2] + 20, "good triangles are light");
    for (const by of ["quality", "valence", "distance"]) {
      await page.check(`input[value=${by}]`, { force: true });
      assert.ok(apart((await pixels(page))[0], first[0]) > 3, by);
    }
    await page.uncheck("#wire");
    await page.focus(".panel:nth-child(2) canvas");
    for (let k = 0; k < 6; k++) await page.keyboard.press("ArrowDown");
    const turned = await pixels(page);
    assert.ok(Math.abs(turned[0].share - first[0].share) > 0.005 && Math.abs(turned[0].share - turned[1].share) < 0.02);

    await page.fill("#density", "500");
    await page.selectOption("#features", "none");
    await page.click("#remesh");
    await state(page, "busy");
    await state(page, "done");
    assert.match(await page.textContent("#status"), /: 500 vertices/);
    assert.equal(await page.isChecked("input[value=distance]"), true, "what was chosen stays chosen");
  });
});

test("the keyboard is enough", async () => {
  await open(DESKTOP, async (page) => {
    const focused = () => page.evaluate(() => document.activeElement.id || document.activeElement.dataset.model || document.activeElement.tagName);
    /** Moves to an element with the Tab key. Each element on the way must show that it has the focus. */
    async function tabTo(name, key = "Tab") {
      for (let k = 0; k < 40; k++) {
        await page.keyboard.press(key);
        const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
        assert.notEqual(outline, "none", `${await focused()} shows no focus`);
        if ((await focused()) === name) return;
      }
      assert.fail(`${name} is not reached`);
    }
    await tabTo("density");
    await page.keyboard.press("Control+A");
    await page.keyboard.type("700");
    await tabTo("bracket.stl", "Shift+Tab");
    await page.keyboard.press("Enter");
    await state(page, "done");
    assert.match(await page.textContent("#status"), /: 700 vertices/);
    await tabTo("remesh");
    await page.keyboard.press("Enter");
    await state(page, "busy");
    await tabTo("cancel");
    await state(page, "done");
    assert.equal(await focused(), "remesh", "the focus is not lost with the button that had it");
    await tabTo("save-mesh");
    const { name } = await saved(page, () => page.keyboard.press("Enter"));
    assert.equal(name, "bracket-remeshed.stl");
    await tabTo("CANVAS");
  });
});

test("a broken file is told with its place, and the next one works", async () => {
  await open(DESKTOP, async (page) => {
    const broken = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n";
    await drop(page, [["broken.stl", broken]]);
    await state(page, "failed");
    assert.equal(await page.textContent("#cause"),
      "broken.stl:4: a coordinate expected, 'x' found; export it again, or repair it with the program that made it");
    assert.equal(await page.getAttribute("#error", "role"), "alert");
    await page.fill("#density", "300");
    await page.click("[data-model='bracket.stl']");
    await state(page, "done");
    assert.equal(await page.isVisible("#error"), false);
  });
});

test("a library that dies says why", async () => {
  // The files seem to be larger than memory can be.
  const endless = (name, content) => (name === "/worker.js" ? String(content).replace("ask(request, contents)",
    "ask(request, contents.map(() => ({ length: 3e9 })))") : content);
  const changed = await serve(PAGE, endless);
  const page = await watched();
  await page.goto(changed.address);
  await state(page, "ready");
  await page.click("[data-model='bracket.stl']");
  await state(page, "failed");
  assert.match(await page.textContent("#cause"), /too large for the memory of a page.*capacity overflow/s);
  assert.equal(await page.isEnabled("#remesh"), true);
  await page.close();
  changed.end();
});

test("a job is cancelled at once, and the next one works", async () => {
  await open(DESKTOP, async (page) => {
    await page.fill("#density", "300");
    await page.click("[data-model='bracket.stl']");
    await state(page, "done");
    await page.fill("#density", "60000");
    await page.click("#remesh");
    await page.waitForFunction(() => document.getElementById("progress").value > 0.05);
    assert.match(await page.textContent("#status"), / …$/);
    const from = performance.now();
    await page.click("#cancel");
    await state(page, "cancelled");
    assert.ok(performance.now() - from < 1000);
    assert.equal(await page.textContent("#status"), "Cancelled.");
    assert.equal(await page.isVisible("#cancel"), false);
    const before = await saved(page, () => page.click("#save-mesh"));
    assert.equal(before.content.readUInt32LE(80), 604, "the last result is still there to be saved");
    await page.fill("#density", "400");
    await page.click("#remesh");
    await state(page, "done");
    assert.match(await page.textContent("#status"), /: 400 vertices/);
  });
});

test("a cloud becomes a mesh, and fields tell what they need", async () => {
  await open(DESKTOP, async (page) => {
    const n = 40;
    const point = (i) => [i % n, Math.floor(i / n), 3 * Math.sin(i / n / 6)].join(" ");
    await page.fill("#density", "200");
    await drop(page, [["points.xyz", [...Array(n * n).keys()].map(point).join("\n")]]);
    await state(page, "done");
    assert.equal(await page.textContent("#counts"), "1600 vertices, no triangles");
    assert.equal(await page.inputValue("#save-format"), "ply");
    await page.fill("#density", "");
    // A name is never markup: otherwise the page would request the image.
    await drop(page, [["grid<img src=no.png>.xyz", [...Array(n * n).keys()].map(point).join("\n")]]);
    assert.equal(await page.$eval("#density", (field) => field.matches(":focus:invalid")), true);
    await page.fill("#density", "150");
    await page.click("#remesh");
    await state(page, "busy");
    await state(page, "done");
    assert.match(await page.textContent("#report h1"), /^grid<img src=no\.png>\.xyz → /);
    await page.selectOption("#by", "edge_length");
    await page.click("#remesh");
    assert.equal(await page.$eval("#density", (field) => field.validity.valueMissing), true);
    await page.fill("#density", "4");
    await page.click("#remesh");
    await state(page, "busy");
    await state(page, "done");
    assert.equal(await page.textContent("#density-label"), "Mean edge length");
  });
});

test("a phone and the dark", async () => {
  await open(PHONE, async (page) => {
    assert.ok((await width(page)) <= 390, `${await width(page)} pixels wide`);
    await page.click("summary");
    assert.ok((await width(page)) <= 390, "with all options");
    await page.fill("#density", "500");
    await page.tap("[data-model='terrain.ply']");
    await state(page, "done");
    assert.ok((await width(page)) <= 390, "with a result");
    const [paper, ink] = await brightness(page);
    assert.ok(paper < 150 && ink > 600, "light on dark");
    assert.ok((await pixels(page)).every(({ share }) => share > 0.05));
  });
});
