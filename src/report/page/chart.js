// A drawing as the script sees it: its points, where they stand, how they move when axes do.
//
// All numbers are read from the drawing: an svg's data-box, data-x and data-y say where its axes lie, a line's data-d
// holds its points as x,y[,low,high], data-n what else their rows say, data-o how far it stands aside.
const make = (name, attributes) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  return element;
};
// Three digits that count, as the tables have them.
const say = (value) => {
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e7 || size < 1e-4) return value.toExponential(2);
  return size >= 100 ? value.toFixed(0) : String(+value.toPrecision(3));
};

class Chart {
  constructor(svg) {
    this.svg = svg;
    [this.left, this.right, this.top, this.bottom] = svg.dataset.box.split(" ").map(Number);
    this.ax = svg.querySelector(".ax");
    this.drawn = this.ax.innerHTML;
    this.layer = svg.querySelector(".d");
    this.lines = [...this.layer.querySelectorAll("polyline")].map((line) => {
      const notes = (line.dataset.n || "").split("|");
      const points = line.dataset.d.split(" ").map((text, number) => {
        const [x, y, low, high] = text.split(",");
        const peak = x === "p";
        return { x: peak ? null : +x, y: +y, low: +(low ?? y), high: +(high ?? y), note: notes[number] || "" };
      });
      const bars = line.nextElementSibling;
      const places = line.getAttribute("points");
      const own = bars?.classList.contains("i") ? bars : null;
      return { line, points, places, bars: own, path: own?.getAttribute("d"), aside: +(line.dataset.o || 0) };
    });
    this.first = { x: this.axis(svg.dataset.x, svg.dataset.xn), y: this.axis(svg.dataset.y, svg.dataset.yn) };
    this.whole();
  }

  axis(text, name) {
    const [kind, low, high] = text.split(" ");
    return { kind, low: +low, high: +high, counts: name === "processors" };
  }

  whole() {
    this.x = { ...this.first.x };
    this.y = { ...this.first.y };
    this.zoomed = false;
  }

  // The smallest number above zero: where a logarithmic axis has to begin.
  least(part) {
    const values = this.lines.flatMap(({ points }) => points.map((point) => point[part]));
    return Math.min(...values.filter((value) => value > 0));
  }

  scale(which, kind) {
    const axis = this[which];
    if (axis.kind === "names" || axis.kind === kind) return;
    axis.kind = kind;
    if (kind === this.first[which].kind && !this.zoomed) {
      Object.assign(axis, this.first[which]);
    } else if (kind === "log") {
      const least = this.least(which === "x" ? "x" : "low");
      if (!Number.isFinite(least)) axis.kind = "even";
      else if (axis.low <= 0 || which === "x") axis.low = Math.min(least, axis.high / 2) / 1.15;
      if (which === "x") axis.high = Math.max(axis.high, axis.low * 2);
    } else if (!this.zoomed) {
      Object.assign(axis, this.first[which], { kind });
      if (this.first[which].kind === "log") axis.low = 0;
    }
    this.draw();
  }

  unit(axis, value) {
    return axis.kind === "log" ? Math.log2(Math.max(value, axis.low * 1e-3)) : value;
  }

  share(axis, value) {
    const [low, high] = [this.unit(axis, axis.low), this.unit(axis, axis.high)];
    return (this.unit(axis, value) - low) / (high - low);
  }

  back(axis, share) {
    const [low, high] = [this.unit(axis, axis.low), this.unit(axis, axis.high)];
    const value = low + share * (high - low);
    return axis.kind === "log" ? 2 ** value : value;
  }

  place(point, aside, value = point.y) {
    // A peak of the paper's stands beside the box, at no count.
    const beside = this.right + (this.svg.viewBox.baseVal.width - this.right) / 2;
    const x = point.x === null ? beside : this.left + this.share(this.x, point.x) * (this.right - this.left) + aside;
    return [x, this.bottom - this.share(this.y, value) * (this.bottom - this.top)];
  }

  still() {
    const same = (axis, first) => axis.kind === first.kind && axis.low === first.low && axis.high === first.high;
    return same(this.x, this.first.x) && same(this.y, this.first.y);
  }

  draw() {
    if (this.still()) {
      // As it was printed, to the byte.
      this.ax.innerHTML = this.drawn;
      for (const { line, places, bars, path } of this.lines) {
        line.setAttribute("points", places);
        bars?.setAttribute("d", path);
      }
      this.layer.removeAttribute("clip-path");
      return;
    }
    const round = (value) => Math.round(value * 10) / 10;
    for (const { line, points, bars, aside } of this.lines) {
      const places = points.map((point) => this.place(point, aside).map(round).join(","));
      if (places.length === 1) places.push(places[0]);
      line.setAttribute("points", places.join(" "));
      const reach = points.filter((point) => point.high > point.low);
      const bar = (point) => {
        const [x, low] = this.place(point, aside, point.low);
        return `M${round(x)} ${round(low)}V${round(this.place(point, aside, point.high)[1])}`;
      };
      bars?.setAttribute("d", reach.map(bar).join(""));
    }
    this.clip();
    this.axes();
  }

  // Nothing is drawn beside the box but what has stood there before: marks at its edge, the peaks.
  clip() {
    if (!this.window) {
      const id = `clip${document.querySelectorAll("clipPath").length}`;
      const path = make("clipPath", { id });
      const width = this.svg.viewBox.baseVal.width - this.left + 12;
      path.append(make("rect", { x: this.left - 12, y: this.top - 12, width, height: this.bottom - this.top + 24 }));
      this.svg.append(path);
      this.window = `url(#${id})`;
    }
    this.layer.setAttribute("clip-path", this.window);
  }

  ticks(axis, most) {
    if (axis.kind === "names") return null;
    const ticks = [];
    if (axis.kind === "log") {
      const doublings = Math.log2(axis.high / axis.low);
      // A number that is no count is read by its power of ten.
      const base = !axis.counts && doublings > 6.6 ? 10 : 2;
      const power = (value) => Math.log2(value) / Math.log2(base);
      const step = Math.max(1, Math.ceil(doublings / Math.log2(base) / most));
      for (let at = Math.ceil(power(axis.low)); base ** at <= axis.high; at += step) ticks.push(base ** at);
      if (ticks.length > 1) return ticks;
      ticks.length = 0;
    }
    const raw = (axis.high - axis.low) / most;
    const size = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((times) => times * size).find((step) => step >= raw);
    for (let n = Math.ceil(axis.low / step); n * step <= axis.high; n++) ticks.push(n * step);
    return ticks;
  }

  axes() {
    const descriptions = [...this.ax.querySelectorAll("text")].filter((text) =>
      [this.svg.dataset.xn, this.svg.dataset.yn].some((name) => text.textContent.startsWith(name)));
    const names = [...this.ax.querySelectorAll("text")].filter((text) => !descriptions.includes(text));
    let grid = "";
    const labels = [];
    const label = (x, y, kind, words) => {
      const text = make("text", { x, y, class: kind });
      text.textContent = words;
      labels.push(text);
    };
    for (const value of this.ticks(this.y, (this.bottom - this.top) / 60)) {
      const y = Math.round(this.place({ x: 1, y: value }, 0)[1]);
      grid += `M${this.left} ${y}H${this.right}`;
      label(this.left - 10, y + 8, "e", say(value));
    }
    const across = this.ticks(this.x, (this.right - this.left) / 56);
    if (across === null) labels.push(...names.filter((text) => text.classList.contains("m")));
    for (const value of across ?? []) {
      const x = Math.round(this.place({ x: value, y: 1 }, 0)[0]);
      grid += `M${x} ${this.top}V${this.bottom}`;
      label(x, this.bottom + 28, "m", say(value));
    }
    const frame = `M${this.left} ${this.top}V${this.bottom}H${this.right}`;
    this.ax.replaceChildren(make("path", { class: "g", d: grid }), make("path", { class: "a", d: frame }),
      ...labels, ...descriptions);
  }

  // Shares of the box, from its left and its bottom.
  zoom(from, to) {
    for (const [which, n] of [["x", 0], ["y", 1]]) {
      const axis = this[which];
      if (axis.kind === "names") continue;
      const ends = [from[n], to[n]].sort((a, b) => a - b).map((share) => this.back(axis, share));
      if (ends[1] - ends[0] > 1e-9) [axis.low, axis.high] = ends;
    }
    this.zoomed = true;
    this.draw();
  }

  // All points that are shown, in reading order.
  points() {
    const shown = this.lines.filter(({ line }) => !line.classList.contains("off") && line.dataset.c !== undefined);
    return shown.flatMap((curve) => curve.points.map((point) => ({ curve, point, at: this.place(point, curve.aside) })))
      .filter(({ at: [x, y], point }) => y >= this.top - 12 && y <= this.bottom + 12 &&
        (point.x === null || (x >= this.left - 12 && x <= this.right + 12)));
  }

  words({ curve, point }) {
    const { xn, yn, yu } = this.svg.dataset;
    const figure = this.svg.closest("figure");
    const legend = figure.querySelector(`.legend [data-c="${curve.line.dataset.c}"]`).textContent;
    const paper = curve.line.classList.contains("h");
    const names = this.first.x.kind === "names" && this.ax.querySelectorAll("text.m")[Math.round(point.x)];
    const x = point.x === null ? "at its peak" : names ? `${xn}: ${names.textContent}` : `${xn} = ${say(point.x)}`;
    const unit = yu === "x" ? " x" : yu ? ` ${yu}` : "";
    const interval = point.high > point.low ? ` [${say(point.low)}, ${say(point.high)}]` : "";
    return [paper ? `${legend}: the paper` : legend, this.svg.closest(".panel").querySelector("h4").textContent, x,
      `${yn}: ${say(point.y)}${unit}${interval}`, point.note].filter(Boolean).join("\n");
  }
}

// A drawing of cells or bars: what is behind each is written on it.
class Cells {
  constructor(svg) {
    this.svg = svg;
  }

  points() {
    const box = (cell) => cell.getBBox();
    return [...this.svg.querySelectorAll("[data-t]:not(.off)")].map((cell) => {
      const { x, y, width, height } = box(cell);
      return { cell, at: [x + width / 2, y + height / 2] };
    });
  }

  words({ cell }) {
    return `${this.svg.closest(".panel").querySelector("h4").textContent}\n${cell.dataset.t}`;
  }
}
