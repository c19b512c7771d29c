// Opens pages of `apportion report` in headless Chromium and uses them as a reader would.
//
//   node page.mjs [--runs N] [--shots DIR] PAGE.html...
//
// --runs N: the first page shows so many runs. --shots DIR: screenshots for a person to look at.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, mkdtempSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL, fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { chromium } from "playwright-core";
import { charts, contrast } from "./looks.mjs";
import { axes, focus, hover, toggles, zoom } from "./uses.mjs";

/// The page of all reference results weighs no more a run, bytes, and opens within so long, ms.
const WEIGHT = 1e5;
const OPEN = 2000;
const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];

const { values: words, positionals: pages } = parseArgs({
  options: { runs: { type: "string" }, shots: { type: "string" } }, allowPositionals: true,
});
assert(pages.length > 0, "name a page");
const program = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
assert(program, "no Chromium: install it, or set CHROMIUM to its path");

/// Opens a page that must ask for nothing and say nothing.
async function open(context, file) {
  const page = await context.newPage();
  const noise = [];
  page.on("console", (message) => noise.push(`console: ${message.text()}`));
  page.on("pageerror", (error) => noise.push(`error: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url();
    const own = url.split("#")[0] === pathToFileURL(file).href || url.startsWith("data:");
    if (!own) noise.push(`request: ${url}`);
  });
  await page.goto(pathToFileURL(file).href, { waitUntil: "load" });
  const time = await page.evaluate(() => performance.getEntriesByType("navigation")[0].loadEventEnd);
  return { page, noise, time };
}

/// A context with no network and a clean start.
const settings = (more) => ({ offline: true, viewport: { width: 1280, height: 1000 }, ...more });

async function shot(page, name) {
  if (!words.shots) return;
  mkdirSync(words.shots, { recursive: true });
  const figures = await page.evaluate(() => {
    const kinds = new Map();
    for (const figure of document.querySelectorAll("figure")) {
      if (!kinds.has(figure.dataset.kind)) kinds.set(figure.dataset.kind, figure.id);
    }
    return [["top", document.documentElement.querySelector("header").id], ...kinds];
  });
  for (const [kind, id] of figures) {
    await page.evaluate((id) => {
      const place = id ? document.getElementById(id) : document.body;
      place.scrollIntoView({ behavior: "instant" });
    }, id);
    await page.waitForTimeout(150);
    await page.screenshot({ path: join(words.shots, `${name}-${kind}.png`) });
  }
}

/// Everything a link promises is there; of other files, those that every run has.
async function links(page, file, folders) {
  const found = await page.evaluate(() => ({
    ids: [...document.querySelectorAll("[id]")].map((element) => element.id),
    links: [...document.querySelectorAll("a[href]")].map((link) => link.getAttribute("href")),
    images: document.querySelectorAll("img, link[rel=stylesheet], script[src], iframe").length,
  }));
  assert.equal(found.images, 0, "the page holds all it needs");
  assert.equal(new Set(found.ids).size, found.ids.length, "an id stands twice");
  for (const link of found.links) {
    if (link.startsWith("#")) assert(found.ids.includes(link.slice(1)), `nothing is at ${link}`);
    else if (/rows\.csv$|meta\.json$/.test(link) && folders) {
      assert(existsSync(fileURLToPath(new URL(link, pathToFileURL(file)))), `${link} is not there`);
    }
  }
}

async function check(browserOf, file, runs) {
  const weight = statSync(file).size;
  // The made-up page has a chart of every kind, as ten runs may have.
  assert(weight < WEIGHT * (runs ?? 10), `${file} weighs ${weight} bytes`);
  const times = [];
  // A computer that does other things too is sometimes slow: the best of three is what the page takes.
  for (let turn = 0; turn < 3; turn++) {
    const context = await browserOf(settings());
    times.push((await open(context, file)).time);
    await context.close();
  }
  const time = Math.min(...times);
  assert(time < OPEN, `${file} opens in ${time} ms`);

  const context = await browserOf(settings());
  const { page, noise } = await open(context, file);
  const seen = await charts(page, runs);
  // Runs made up for a test lie nowhere.
  await links(page, file, runs !== undefined);
  await hover(page);
  await focus(page);
  await toggles(page);
  await axes(page);
  await zoom(page);
  await shot(page, "light");
  await contrast(page, "light");
  await page.emulateMedia({ media: "print" });
  await contrast(page, "light");
  assert.equal(await page.locator(".tools:visible").count(), 0, "buttons stand in print");
  await shot(page, "print");
  const pdf = await page.pdf({ format: "A4" });
  assert(pdf.length > 10_000, "the page does not print");
  if (words.shots) writeFileSync(join(words.shots, "print.pdf"), pdf);
  assert.deepEqual(noise, []);
  await context.close();

  for (const [name, more] of [
    ["dark", { colorScheme: "dark" }],
    ["narrow", { viewport: { width: 400, height: 800 }, hasTouch: true }],
  ]) {
    const context = await browserOf(settings(more));
    const { page, noise } = await open(context, file);
    // Parts that are not on the screen are measured too.
    await page.addStyleTag({ content: ".run{content-visibility:visible!important}" });
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert(width <= (more.viewport?.width ?? 1280), `${name}: the page is ${width} wide`);
    await contrast(page, name === "dark" ? "dark" : "light");
    await shot(page, name);
    if (name === "dark") {
      await page.emulateMedia({ media: "print", colorScheme: "dark" });
      await contrast(page, "light");
    }
    assert.deepEqual(noise, []);
    await context.close();
  }
  console.log(`${file}: ${seen.figures} charts, ${seen.panels} panels, ${weight} bytes, open in ${Math.round(time)} ms`);
}

const profile = mkdtempSync(join(tmpdir(), "apportion-browser-"));
const browser = await chromium.launch({ executablePath: program, args: FLAGS, env: { ...process.env, HOME: profile } });
try {
  for (const [number, file] of pages.entries()) {
    const runs = number === 0 && words.runs ? Number(words.runs) : undefined;
    await check((options) => browser.newContext(options), resolve(file), runs);
  }
} finally {
  await browser.close();
}
