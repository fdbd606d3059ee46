// What the tests of pages share: the program, a browser, and the pixels of a viewer.
//
// The browser is of the Chromium family, named by CHROMIUM or found in the PATH; the program is REMESH, or
// target/release/remesh.

import { execFileSync, spawnSync } from "node:child_process";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

export const ROOT = resolve(import.meta.dirname, "../..");
export const REMESH = process.env.REMESH ?? join(ROOT, "target/release/remesh");
export const DESKTOP = { viewport: { width: 1280, height: 900 } };
export const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, colorScheme: "dark", hasTouch: true };

const BROWSER = process.env.CHROMIUM ?? ["chromium", "chromium-browser", "google-chrome"].find(isInstalled);
const FLAGS = ["no-sandbox", "disable-quic", "no-first-run", "disable-background-networking", "disable-component-update",
  "disable-sync"];

/** A model of data/. */
export const data = (name) => join(ROOT, "data", name);

export function launch() {
  return chromium.launch({ executablePath: which(BROWSER), args: FLAGS.map((flag) => `--${flag}`) });
}

function isInstalled(name) {
  return spawnSync("which", [name]).status === 0;
}

function which(name) {
  return name.includes("/") ? name : execFileSync("which", [name], { encoding: "utf8" }).trim();
}

/**
 * For each canvas the share of its pixels that are drawn on, and the mean of their red, green and blue; how many of those at its
 * rim are drawn on; and where the middle of what has the blue of a ring is, in shares of its width and height.
 */
export async function pixels(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return page.$$eval(".panel canvas", (canvases) => canvases.map((canvas) => {
    const all = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    const { width, height } = canvas;
    const sum = [0, 0, 0];
    let [drawn, rim] = [0, 0];
    const blue = [0, 0, 0];
    for (let i = 0; i < all.length; i += 4) {
      if (all[i + 3] < 128) continue;
      const [x, y] = [(i / 4) % width, Math.floor(i / 4 / width)];
      drawn += 1;
      if (x === 0 || y === 0 || x === width - 1 || y === height - 1) rim += 1;
      if (all[i] < 60 && all[i + 2] > 180) [1, x / width, y / height].forEach((add, k) => { blue[k] += add; });
      for (let k = 0; k < 3; k++) sum[k] += all[i + k];
    }
    const ring = blue[0] === 0 ? null : [blue[1] / blue[0], blue[2] / blue[0]];
    return { share: drawn / (width * height), colour: sum.map((x) => x / drawn), rim, ring };
  }));
}

/** How far apart the colours of two canvases are. */
export const apart = (a, b) => Math.hypot(...a.colour.map((x, i) => x - b.colour[i]));

/** How wide a page is, in pixels of the page. */
export const width = (page) => page.evaluate(() => document.documentElement.scrollWidth);

/** The sums of red, green and blue of the paper and of the ink. */
export function brightness(page) {
  return page.evaluate(() => {
    const { backgroundColor, color } = getComputedStyle(document.body);
    return [backgroundColor, color].map((text) => text.match(/\d+/g).slice(0, 3).reduce((a, b) => a + Number(b), 0));
  });
}
