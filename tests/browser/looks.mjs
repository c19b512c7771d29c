// Whether everything is drawn, and can be seen.
import assert from "node:assert/strict";

/// Every chart drew, in the number the page says, and has what those need who do not see it.
export async function charts(page, runs) {
  const seen = await page.evaluate(() => {
    const wrong = [];
    const panels = [...document.querySelectorAll("svg.chart")];
    for (const svg of panels) {
      const name = `${svg.closest("figure").id}: ${svg.getAttribute("aria-label")}`;
      const marks = svg.querySelectorAll(".d polyline[data-c], .d path, .d rect");
      if (marks.length === 0) wrong.push(`${name}: nothing is drawn`);
      if (svg.querySelectorAll("text").length < 2) wrong.push(`${name}: no words on the axes`);
      for (const part of svg.querySelectorAll("*")) {
        for (const { name: key, value } of part.attributes) {
          if (/NaN|undefined|Infinity|\binf\b/.test(value)) wrong.push(`${name}: ${key}="${value.slice(0, 80)}"`);
        }
      }
      const { width, height } = svg.viewBox.baseVal;
      for (const line of svg.querySelectorAll(".d polyline[data-c]")) {
        const places = line.getAttribute("points").split(" ").map((text) => text.split(",").map(Number));
        const out = places.some(([x, y]) => !(x >= 0 && y >= -1 && x <= width && y <= height));
        if (out) wrong.push(`${name}: a curve leaves the drawing: ${line.getAttribute("points")}`);
        const numbers = line.dataset.d.split(" ").length;
        if (places.length !== Math.max(2, numbers)) wrong.push(`${name}: ${places.length} places, ${numbers} numbers`);
        if (getComputedStyle(line).markerStart === "none") wrong.push(`${name}: a curve without marks`);
      }
      if (svg.getAttribute("role") !== "img" || !svg.getAttribute("aria-label")) wrong.push(`${name}: no role or label`);
      if (svg.tabIndex !== 0) wrong.push(`${name}: the keyboard does not get there`);
    }
    for (const id of new Set([...document.documentElement.innerHTML.matchAll(/url\(#([\w-]+)\)/g)].map((m) => m[1]))) {
      if (!document.getElementById(id)) wrong.push(`no mark #${id}`);
    }
    for (const figure of document.querySelectorAll("figure")) {
      const cells = figure.querySelectorAll("details td");
      if (cells.length === 0) wrong.push(`${figure.id}: no table`);
      if (!figure.querySelector("figcaption p").textContent.trim()) wrong.push(`${figure.id}: says nothing`);
    }
    const words = document.querySelector("header").textContent.match(/(\d+) charts in (\d+) panels/);
    return {
      wrong, told: words && words.slice(1, 3).map(Number), runs: document.querySelectorAll("section.run").length,
      figures: document.querySelectorAll("figure").length, panels: panels.length,
    };
  });
  assert.deepEqual(seen.wrong, []);
  assert.deepEqual([seen.figures, seen.panels], seen.told, "not every chart is there");
  assert(seen.figures > 0);
  if (runs !== undefined) assert.equal(seen.runs, runs, "not every run is there");
  return seen;
}

/// Curves and words stand out from the ground, which is as light or dark as asked.
export async function contrast(page, ground) {
  const found = await page.evaluate(() => {
    const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const light = (colour) => {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = colour;
      canvas.fillRect(0, 0, 1, 1);
      const parts = [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3).map((part) => part / 255)
        .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
      return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2];
    };
    const ground = light(getComputedStyle(document.body).backgroundColor);
    const against = (colour) => {
      const own = light(colour);
      return (Math.max(own, ground) + 0.05) / (Math.min(own, ground) + 0.05);
    };
    const low = [];
    for (const line of document.querySelectorAll("polyline.c")) {
      const colour = getComputedStyle(line).stroke;
      if (against(colour) < 3) low.push(`curve ${colour}`);
    }
    for (const word of document.querySelectorAll("p, td, th, h1, h2, h3, h4, a, svg.chart text")) {
      const style = getComputedStyle(word);
      const colour = word.closest("svg") ? style.fill : style.color;
      if (against(colour) < 4.5) low.push(`${word.tagName} ${colour}`);
    }
    return { ground, low: [...new Set(low)] };
  });
  assert.deepEqual(found.low, [], `too faint on ${ground}`);
  assert(ground === "dark" ? found.ground < 0.05 : found.ground > 0.8, `the ground is not ${ground}`);
}
