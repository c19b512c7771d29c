// What a reader does: hover, step by keyboard, hide curves, change axes, zoom.
import assert from "node:assert/strict";

/// The first panel of each kind of figure that has points.
const samples = (page) => page.evaluate(() => {
  const kinds = new Map();
  for (const figure of document.querySelectorAll("figure")) {
    if (!kinds.has(figure.dataset.kind)) kinds.set(figure.dataset.kind, figure.id);
  }
  return [...kinds.values()];
});
const withAxes = async (page) => {
  const ids = await samples(page);
  const has = await page.evaluate((ids) => ids.filter((id) => document.getElementById(id).querySelector("[data-box]")), ids);
  assert(has.length > 0, "no chart has axes");
  return has;
};
const panel = (page, id) => page.locator(`[id="${id}"] svg.chart`).first();
/// Scrolled to, and drawn: what was beyond the screen is laid out only now.
const reach = async (page, id) => {
  await page.evaluate((id) => document.getElementById(id).scrollIntoView({ behavior: "instant", block: "start" }), id);
  await page.waitForTimeout(120);
  await page.evaluate((id) => document.getElementById(id).scrollIntoView({ behavior: "instant", block: "start" }), id);
  await page.waitForTimeout(60);
};
const drawn = (page, id) => panel(page, id).evaluate((svg) =>
  [...svg.querySelectorAll(".d polyline, .d path")].map((part) => part.getAttribute("points") ?? part.getAttribute("d")));
const tip = (page) => page.locator("#tip");

/// A pointer on a point or cell shows its row, and away from all points nothing.
export async function hover(page) {
  for (const id of await samples(page)) {
    await reach(page, id);
    const at = await panel(page, id).evaluate((svg) => {
      const line = svg.querySelector(".d polyline.c[data-c], .d polyline.s[data-c]");
      const cell = svg.querySelector("[data-t]");
      if (!line) {
        const box = (cell.querySelector("rect") ?? cell).getBoundingClientRect();
        // A path of many bars has no middle to point at: its first bar has.
        const first = cell.tagName === "path" && cell.getPointAtLength(1);
        const screen = first && new DOMPoint(first.x + 0.5, first.y + 1).matrixTransform(svg.getScreenCTM());
        const place = screen ? [screen.x, screen.y + 2] : [box.x + box.width / 2, box.y + 5];
        return { place, told: [cell.dataset.t] };
      }
      const points = [...svg.querySelectorAll(".d polyline[data-c]")].flatMap((line) => {
        const places = line.getAttribute("points").split(" ").map((text) => text.split(",").map(Number));
        return line.dataset.d.split(" ").map((text, n) => ({ at: places[n], value: Number(text.split(",")[1]) }));
      });
      // The point that stands furthest from all others: no other is meant.
      const far = (a, b) => Math.hypot(a.at[0] - b.at[0], a.at[1] - b.at[1]);
      const alone = (point) => Math.min(...points.filter((other) => other !== point).map((other) => far(point, other)));
      const { at: [x, y], value } = points.reduce((best, point) => (alone(point) > alone(best) ? point : best));
      const screen = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
      return { place: [screen.x, screen.y], value, told: [svg.dataset.yn] };
    });
    await page.mouse.move(...at.place);
    assert(await tip(page).isVisible(), `${id}: no row behind the point`);
    const words = await tip(page).textContent();
    for (const told of at.told) assert(words.includes(told), `${id}: "${words}" does not tell ${told}`);
    if (at.value !== undefined) {
      // Three digits of it, as the tables have them.
      const told = words.split("\n").find((line) => line.startsWith(`${at.told[0]}: `)).slice(at.told[0].length + 2);
      assert(Math.abs(parseFloat(told) - at.value) <= 0.006 * Math.abs(at.value), `${id}: "${words}" is not ${at.value}`);
    }
    const box = await tip(page).boundingBox();
    assert(box.x >= 0 && box.x + box.width <= 1280, `${id}: the row leaves the screen`);
    await page.mouse.move(2, 2);
    assert(!(await tip(page).isVisible()), `${id}: the row stays`);
  }
}

/// The keyboard gets to a chart and steps through its points.
export async function focus(page) {
  for (const id of await samples(page)) {
    await reach(page, id);
    await page.locator(`[id="${id}"] button`).first().focus();
    for (let press = 0; press < 40; press++) {
      await page.keyboard.press("Tab");
      if (await page.evaluate(() => document.activeElement.matches("svg.chart"))) break;
    }
    assert(await page.evaluate((id) => document.activeElement.closest("figure")?.id === id &&
      document.activeElement.matches("svg.chart"), id), `${id}: Tab does not reach the chart`);
    assert(await tip(page).isVisible(), `${id}: focus shows no row`);
    const first = await tip(page).textContent();
    await page.keyboard.press("ArrowRight");
    const many = await panel(page, id).evaluate((svg) => svg.querySelectorAll("[data-t]").length !== 1);
    const second = await tip(page).textContent();
    if (many) assert.notEqual(second, first, `${id}: an arrow does not step on`);
    await page.keyboard.press("ArrowLeft");
    assert.equal(await tip(page).textContent(), first, `${id}: nor back`);
    await page.keyboard.press("Escape");
    assert(!(await tip(page).isVisible()), `${id}: Escape does not let go`);
  }
}

/// A button of the legend hides its curve in all panels, and brings it back.
export async function toggles(page) {
  for (const id of await samples(page)) {
    await reach(page, id);
    const button = page.locator(`[id="${id}"] .legend button`).first();
    const number = await button.getAttribute("data-c");
    const shown = () => page.evaluate(([id, number]) => {
      const parts = [...document.getElementById(id).querySelectorAll(`.chart [data-c="${number}"]`)];
      return [parts.length, parts.filter((part) => getComputedStyle(part).display !== "none").length];
    }, [id, number]);
    const [all, before] = await shown();
    assert(all > 0 && before === all, `${id}: the legend's first curve is not there`);
    await button.click();
    assert.equal((await shown())[1], 0, `${id}: the curve is not hidden`);
    assert.equal(await button.getAttribute("aria-pressed"), "false");
    await button.press("Enter");
    assert.equal((await shown())[1], all, `${id}: the curve does not come back`);
  }
}

/// Logarithmic axes, as drawn or asked for, put twice the number the same way further; a button pressed twice gives the
/// same drawing back.
export async function axes(page) {
  for (const id of await withAxes(page)) {
    await reach(page, id);
    const before = await drawn(page, id);
    for (const axis of ["x", "y"]) {
      const button = page.locator(`[id="${id}"] [data-axis=${axis}]`);
      if (!(await button.isVisible())) continue;
      const was = await button.getAttribute("aria-pressed");
      const logarithmic = async () => assert(await doublingIsEven(page, id), `${id}: log y is not logarithmic`);
      if (axis === "y" && was === "true") await logarithmic();
      await button.click();
      assert.notEqual(await button.getAttribute("aria-pressed"), was);
      const now = await drawn(page, id);
      assert(!now.some((path) => /NaN|Infinity|undefined/.test(path)), `${id}: log ${axis} draws nonsense`);
      assert.notDeepEqual(now, before, `${id}: log ${axis} changes nothing`);
      if (axis === "y" && was === "false") await logarithmic();
      const texts = await panel(page, id).evaluate((svg) => svg.querySelectorAll(".ax text").length);
      assert(texts >= 3, `${id}: log ${axis} leaves ${texts} words on the axes`);
      await button.click();
      assert.deepEqual(await drawn(page, id), before, `${id}: ${axis} does not come back as it was`);
    }
  }
}

const doublingIsEven = (page, id) => panel(page, id).evaluate((svg) => {
  const points = [...svg.querySelectorAll(".d polyline[data-c]")].flatMap((line) => {
    const places = line.getAttribute("points").split(" ").map((text) => text.split(",").map(Number));
    return line.dataset.d.split(" ").map((text, n) => ({ value: Number(text.split(",")[1]), y: places[n][1] }));
  }).filter(({ value }) => value > 0).sort((a, b) => a.value - b.value);
  const [low, middle, high] = [points[0], points[Math.floor(points.length / 2)], points.at(-1)];
  if (high.value / low.value < 1.01) return true;
  const expected = low.y + (high.y - low.y) * Math.log(middle.value / low.value) / Math.log(high.value / low.value);
  return Math.abs(expected - middle.y) < 1;
});

/// Buttons, keys and a dragged box zoom; a double click shows the whole again.
export async function zoom(page) {
  for (const id of await withAxes(page)) {
    await reach(page, id);
    const before = await drawn(page, id);
    const changed = async (what) => {
      const now = await drawn(page, id);
      assert.notDeepEqual(now, before, `${id}: ${what} does not zoom`);
      assert(!now.some((path) => /NaN|Infinity|undefined/.test(path)), `${id}: ${what} draws nonsense`);
    };
    const tool = (name) => page.locator(`[id="${id}"] [data-zoom=${name}]`);
    await tool("in").click();
    await changed("+");
    await tool("all").click();
    assert.deepEqual(await drawn(page, id), before, `${id}: the whole is not as it was`);
    await panel(page, id).focus();
    await page.keyboard.press("+");
    await changed("the key +");
    await page.keyboard.press("0");
    assert.deepEqual(await drawn(page, id), before, `${id}: the key 0 does not bring it back`);
    const box = await panel(page, id).boundingBox();
    const at = (x, y) => [box.x + box.width * x, box.y + box.height * y];
    await page.mouse.move(...at(0.3, 0.2));
    await page.mouse.down();
    await page.mouse.move(...at(0.5, 0.4));
    await page.mouse.move(...at(0.7, 0.6));
    await page.mouse.up();
    await changed("a dragged box");
    assert(await panel(page, id).evaluate((svg) => svg.querySelector(".d").hasAttribute("clip-path")));
    await page.mouse.dblclick(...at(0.5, 0.5));
    assert.deepEqual(await drawn(page, id), before, `${id}: a double click does not bring it back`);
  }
}
