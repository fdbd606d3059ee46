// Opens pages of reports in a browser and looks at what people would see: numbers and pixels, never whole pictures.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { DESKTOP, PHONE, REMESH, apart, brightness, data, launch, pixels, width } from "./browser.mjs";

let folder;
let browser;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "remesh-page-"));
  browser = await launch();
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

/** Runs the program on the models of data/, and gives the address of the page. */
function report(name, words, status = 0) {
  const ran = spawnSync(REMESH, [...words.split(" "), "--report", `${name}.html`], { cwd: folder });
  assert.equal(ran.status, status, String(ran.stderr));
  return pathToFileURL(join(folder, `${name}.html`)).href;
}

/** Opens a page and calls `look` with it. It must neither fail nor ask for anything but itself. */
async function open(address, options, look) {
  const page = await browser.newPage(options);
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("request", (request) => {
    if (request.url() !== address && !request.url().startsWith("data:")) faults.push(`asked for ${request.url()}`);
  });
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.viewer);
  await look(page);
  await page.close();
  assert.deepEqual(faults, []);
}

test("before and after are drawn, coloured and turned together", async () => {
  const address = report("bracket", `${data("bracket.stl")} out.obj --points 1500`);
  await open(address, DESKTOP, async (page) => {
    assert.equal(await page.textContent(".verdict h2"), "Verified");
    assert.equal(await page.evaluate(() => document.documentElement.dataset.viewer), "ready");
    const first = await pixels(page);
    assert.equal(first.length, 2);
    for (const { share } of first) assert.ok(share > 0.1 && share < 0.9, `${share}`);
    assert.ok(Math.abs(first[0].share - first[1].share) < 0.02, "both meshes are of one shape");
    // The input is long triangles, the result good ones, which are light.
    assert.ok(first[1].colour[2] > first[0].colour[2] + 20, JSON.stringify(first));

    for (const by of ["quality", "valence", "distance"]) {
      await page.check(`input[value=${by}]`, { force: true });
      assert.equal(await page.isVisible(`.legend[data-colouring=${by}]`), true);
      assert.equal(await page.isVisible(".legend[data-colouring=angle]"), false);
      assert.ok(apart((await pixels(page))[0], first[0]) > 3, by);
    }
    await page.check("input[value=angle]", { force: true });
    await page.uncheck("#wire");
    assert.ok(apart((await pixels(page))[1], first[1]) > 1, "without lines it is another colour");
    await page.check("#wire");
    await page.uncheck("#edges");
    assert.ok(apart((await pixels(page))[1], first[1]) > 0.5, "without sharp edges it is another colour");
    await page.check("#edges");

    await page.focus(".panel:nth-child(2) canvas");
    for (let k = 0; k < 6; k++) await page.keyboard.press("ArrowDown");
    const turned = await pixels(page);
    assert.ok(Math.abs(turned[0].share - first[0].share) > 0.005 && Math.abs(turned[0].share - turned[1].share) < 0.02);
    await page.keyboard.press("+");
    assert.ok((await pixels(page))[0].share > turned[0].share, "nearer is larger");
    await page.click("#reset");
    assert.deepEqual(await pixels(page), first);

    const box = await page.locator(".panel:nth-child(1) canvas").boundingBox();
    await page.mouse.move(box.x + 100, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 160, box.y + 220, { steps: 4 });
    await page.mouse.up();
    assert.ok(Math.abs((await pixels(page))[1].share - first[1].share) > 0.003, "the other one turns, too");
    await page.mouse.wheel(0, -300);
    await page.click("#reset");
    assert.deepEqual(await pixels(page), first);
  });
});

test("a place that is not verified turns the camera", async () => {
  const address = report("far", `${data("blob.obj")} far.obj --points 2000 --max-error 0.01%`, 3);
  await open(address, DESKTOP, async (page) => {
    assert.equal(await page.textContent(".verdict h2"), "Not verified");
    const first = await pixels(page);
    await page.click(".verdict a");
    const there = await pixels(page);
    assert.ok(first[1].rim === 0 && there[1].rim > 0, "it is seen from nearer: the mesh leaves the picture");
    assert.ok(first[1].ring === null && there[1].ring.every((x) => Math.abs(x - 0.5) < 0.01), "a ring around it is in the middle");
    await page.click("a[data-by=distance]");
    assert.equal(await page.isChecked("input[value=distance]"), true);
    const json = await page.getAttribute("#save a", "href");
    assert.equal(JSON.parse(decodeURIComponent(json.slice(json.indexOf(",") + 1))).verified, false);
  });
});

test("a phone, the dark and paper", async () => {
  report("first", `${data("terrain.ply")} first.ply --points 1000`);
  const address = report("quality", `quality first.ply ${data("terrain.ply")} --against ${data("terrain.ply")}`);
  await open(address, PHONE, async (page) => {
    assert.equal((await pixels(page)).length, 3);
    assert.ok((await pixels(page)).every(({ share }) => share > 0.05));
    const wide = await width(page);
    assert.ok(wide <= 390, `${wide} pixels wide`);
    const [paper, ink] = await brightness(page);
    assert.ok(paper < 150 && ink > 600, "light on dark");
    const pdf = await page.pdf({ format: "A4" });
    const pages = pdf.toString("latin1").match(/\/Type\s*\/Page\b/g).length;
    assert.ok(pages >= 2 && pages <= 6, `${pages} pages`);
  });
});

test("large meshes are pictures that can be chosen from", async () => {
  const n = 330;
  const vertex = (i) => `v ${i % n} ${Math.floor(i / n)} ${Math.sin(i % n / 20) * 20}`;
  const face = (i) => (i % n < n - 1 && i < n * (n - 1) ? `f ${i + 1} ${i + 2} ${i + n + 2} ${i + n + 1}` : "");
  const all = [...Array(n * n).keys()];
  writeFileSync(join(folder, "large.obj"), [...all.map(vertex), ...all.map(face)].join("\n"));
  await open(report("large", "quality large.obj"), DESKTOP, async (page) => {
    assert.equal(await page.locator("canvas").count(), 0);
    assert.equal(await page.isVisible("img[data-colouring=angle]"), true);
    assert.ok(await page.$eval("img", (img) => img.naturalWidth === 960 && img.naturalHeight === 720));
    await page.check("input[value=valence]", { force: true });
    assert.deepEqual(
      await page.$$eval("img", (all) => all.filter((img) => img.offsetWidth > 0).map((img) => img.dataset.colouring)),
      ["valence"],
    );
  });
});
