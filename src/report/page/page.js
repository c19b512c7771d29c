// What a still page has not: the row behind a point, hiding curves, logarithmic axes, zoom. Drawings are in chart.js.
const tip = document.getElementById("tip");
// A drawing with axes. It is read when somebody first turns to it, so that opening the page costs nothing.
const charts = new WeakMap();
const chartOf = (svg) => {
  if (!charts.has(svg)) charts.set(svg, svg.dataset.box ? new Chart(svg) : new Cells(svg));
  return charts.get(svg);
};

// From the screen to the drawing's units, and back.
const inside = (svg, event) => {
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return [point.x, point.y];
};
const ring = make("circle", { class: "ring", r: 14 });

const show = (svg, point) => {
  const chart = chartOf(svg);
  ring.setAttribute("cx", point.at[0]);
  ring.setAttribute("cy", point.at[1]);
  svg.append(ring);
  tip.textContent = chart.words(point);
  tip.hidden = false;
  const screen = new DOMPoint(...point.at).matrixTransform(svg.getScreenCTM());
  const { offsetWidth: width, offsetHeight: height } = tip;
  const left = Math.max(8, Math.min(screen.x + 14, document.documentElement.clientWidth - width - 8));
  const above = screen.y - height - 14;
  tip.style.left = `${left}px`;
  tip.style.top = `${above > 4 ? above : screen.y + 18}px`;
};
const hide = () => {
  tip.hidden = true;
  ring.remove();
};

const near = (svg, event) => {
  const [x, y] = inside(svg, event);
  // A cell is what the pointer is on; of points the nearest counts, if it is near.
  const cell = event.target.closest?.("[data-t]");
  const points = chartOf(svg).points();
  if (cell) return points.find((point) => point.cell === cell);
  const far = (point) => Math.hypot(point.at[0] - x, point.at[1] - y);
  const best = points.filter((point) => point.curve).sort((a, b) => far(a) - far(b))[0];
  return best && far(best) < 40 ? best : undefined;
};

let drag = null;
document.addEventListener("pointermove", (event) => {
  if (drag) return stretch(event);
  const svg = event.target.closest?.("svg.chart");
  const point = svg && near(svg, event);
  if (point) show(svg, point);
  else if (!document.activeElement?.matches("svg.chart") || svg) hide();
});
document.addEventListener("scroll", hide, { passive: true });

// Drag a box to zoom: with a mouse, for a finger has the page to move.
const shareOf = (chart, [x, y]) => [
  Math.min(1, Math.max(0, (x - chart.left) / (chart.right - chart.left))),
  Math.min(1, Math.max(0, (chart.bottom - y) / (chart.bottom - chart.top))),
];
const stretch = (event) => {
  const [x, y] = inside(drag.svg, event);
  const [a, b] = drag.from;
  drag.to = [x, y];
  drag.box.setAttribute("x", Math.min(a, x));
  drag.box.setAttribute("y", Math.min(b, y));
  drag.box.setAttribute("width", Math.abs(x - a));
  drag.box.setAttribute("height", Math.abs(y - b));
};
document.addEventListener("pointerdown", (event) => {
  const svg = event.target.closest?.("svg.chart[data-box]");
  if (!svg || event.pointerType !== "mouse" || event.button !== 0) return;
  const from = inside(svg, event);
  drag = { svg, from, to: from, box: make("rect", { class: "box" }) };
  svg.append(drag.box);
  hide();
});
document.addEventListener("pointerup", () => {
  if (!drag) return;
  const { svg, from, to, box } = drag;
  drag = null;
  box.remove();
  if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 12) return;
  const chart = chartOf(svg);
  chart.zoom(shareOf(chart, from), shareOf(chart, to));
});
const whole = (svg) => {
  const chart = chartOf(svg);
  chart.whole();
  chart.draw();
  for (const button of svg.closest("figure").querySelectorAll("[data-axis]")) {
    button.setAttribute("aria-pressed", chart[button.dataset.axis].kind === "log");
  }
};
document.addEventListener("dblclick", (event) => {
  const svg = event.target.closest?.("svg.chart[data-box]");
  if (svg) whole(svg);
});
const closer = (svg, times) => {
  const half = 0.5 / times;
  // From the corner where the axes meet: what matters lies above it.
  chartOf(svg).zoom([0.5 - half, 0], [0.5 + half, 2 * half]);
};

// Arrow keys step from point to point; + and - zoom, 0 shows the whole, Escape lets go.
const at = new WeakMap();
document.addEventListener("keydown", (event) => {
  const svg = event.target.closest?.("svg.chart");
  if (!svg || event.ctrlKey || event.metaKey || event.altKey) return;
  const points = chartOf(svg).points();
  const now = at.get(svg) ?? -1;
  const to = { ArrowRight: now + 1, ArrowLeft: now - 1, Home: 0, End: points.length - 1 }[event.key];
  const column = (from, step) => {
    // The next curve at the same place, up or down.
    const here = points[from];
    const same = points.map((point, number) => ({ point, number }))
      .filter(({ point }) => Math.abs(point.at[0] - here.at[0]) < 40)
      .sort((a, b) => a.point.at[1] - b.point.at[1]);
    const place = same.findIndex(({ number }) => number === from) + step;
    return same[Math.max(0, Math.min(same.length - 1, place))].number;
  };
  if (event.key === "Escape") return hide();
  if (svg.dataset.box && "+=-_0".includes(event.key)) {
    if (event.key === "0") whole(svg);
    else closer(svg, "+=".includes(event.key) ? 1.5 : 1 / 1.5);
    at.delete(svg);
    hide();
  } else if (points.length && (to !== undefined || event.key === "ArrowUp" || event.key === "ArrowDown")) {
    const steps = event.key === "ArrowUp" ? -1 : 1;
    const next = to ?? (now < 0 ? 0 : column(Math.min(now, points.length - 1), steps));
    const number = (next + points.length) % points.length;
    at.set(svg, number);
    show(svg, points[number]);
  } else return;
  event.preventDefault();
});
document.addEventListener("focusin", (event) => {
  const svg = event.target.closest?.("svg.chart");
  if (!svg?.matches(":focus-visible")) return;
  const points = chartOf(svg).points();
  if (points.length) {
    at.set(svg, 0);
    show(svg, points[0]);
  }
});
document.addEventListener("focusout", (event) => event.target.matches?.("svg.chart") && hide());

// Buttons.
document.addEventListener("click", (event) => {
  const button = event.target.closest?.("figure button");
  if (!button) return;
  const figure = button.closest("figure");
  const on = button.getAttribute("aria-pressed") !== "true";
  if (button.dataset.c !== undefined) {
    button.setAttribute("aria-pressed", on);
    for (const part of figure.querySelectorAll(`.chart [data-c="${button.dataset.c}"]`)) part.classList.toggle("off", !on);
    return;
  }
  for (const svg of figure.querySelectorAll("svg.chart[data-box]")) {
    const { axis, zoom } = button.dataset;
    if (axis) chartOf(svg).scale(axis, on ? "log" : "even");
    else if (zoom === "all") whole(svg);
    else closer(svg, zoom === "in" ? 1.5 : 1 / 1.5);
  }
  if (button.dataset.axis) button.setAttribute("aria-pressed", on);
});

for (const tools of document.querySelectorAll(".tools")) {
  tools.hidden = false;
  const svg = tools.closest("figure").querySelector("svg.chart[data-box]");
  for (const axis of ["x", "y"]) {
    const kind = svg.dataset[axis].split(" ")[0];
    const button = tools.querySelector(`[data-axis=${axis}]`);
    button.setAttribute("aria-pressed", kind === "log");
    button.hidden = kind === "names";
  }
}
