"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const svg = document.getElementById("plot"), tip = document.getElementById("tip");
const space = "http://www.w3.org/2000/svg", margin = { left: 74, right: 18, top: 12, bottom: 52 };
const hidden = new Set();
const log = { x: false, y: false };
let view = { ...data.views[0] }, box = null, size = { width: 0, height: 0 }, hoverable = [];

function make(tag, attributes, parent) {
  const node = document.createElementNS(space, tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (parent) parent.appendChild(node);
  return node;
}
function strands(branch, name) {
  if (branch.columns[name]) {  // of a cycle of a map: every iterate
    const iterates = Object.keys(branch.columns).filter(key => key.startsWith(name + ".") && /^\d+$/.test(key.slice(name.length + 1)));
    return iterates.length ? iterates.map(key => branch.columns[key]) : [branch.columns[name]];
  }
  const top = branch.columns[name + ".max"], low = branch.columns[name + ".min"];
  return top && low ? [top, low] : [];
}
function axisNames() {
  const found = new Set();
  for (const branch of data.branches) for (const key of Object.keys(branch.columns)) {
    const base = key.replace(/\.\d+$/, "");
    found.add(base !== key && branch.columns[base] ? base : key.replace(/\.(max|min)$/, ""));
  }
  return [...found];
}
function axisText(name) { return data.units[name] ? `${name} (${data.units[name]})` : name; }
function format(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-4 ? value.toExponential(5) : String(+value.toPrecision(7));
}
function extent() {
  let lowX = Infinity, highX = -Infinity, lowY = Infinity, highY = -Infinity;
  for (const branch of data.branches) {
    if (hidden.has(branch.name)) continue;
    for (const xs of strands(branch, view.x)) for (const ys of strands(branch, view.y))
      for (let i = 0; i < xs.length; i++) {
        if (xs[i] === null || ys[i] === null || (log.x && !(xs[i] > 0)) || (log.y && !(ys[i] > 0))) continue;
        lowX = Math.min(lowX, xs[i]); highX = Math.max(highX, xs[i]);
        lowY = Math.min(lowY, ys[i]); highY = Math.max(highY, ys[i]);
      }
  }
  if (lowX > highX) return { x: log.x ? [.1, 10] : [0, 1], y: log.y ? [.1, 10] : [0, 1] };
  if (regionsShown()) return { x: [...data.phase.range[view.x]], y: [...data.phase.range[view.y]] };
  const widen = (low, high, part) => { const d = high - low > Math.max(1e-9 * Math.max(Math.abs(low), Math.abs(high)), 1e-15) ? (high - low) * part : Math.abs(high) / 2 || 1; return [low - d, high + d]; };
  const stretched = (low, high, part) => { const ends = widen(Math.log10(low), Math.log10(high), part); return ends.map(v => 10 ** v); };
  return { x: (log.x ? stretched : widen)(lowX, highX, .03), y: (log.y ? stretched : widen)(lowY, highY, .06) };
}
function scales() {
  const width = size.width - margin.left - margin.right, height = size.height - margin.top - margin.bottom;
  const onto = { x: log.x ? Math.log10 : v => v, y: log.y ? Math.log10 : v => v }, back = { x: log.x ? v => 10 ** v : v => v, y: log.y ? v => 10 ** v : v => v };
  const [x0, x1] = box.x.map(onto.x), [y0, y1] = box.y.map(onto.y);
  return {
    x: v => margin.left + (onto.x(v) - x0) / (x1 - x0) * width,
    y: v => margin.top + (1 - (onto.y(v) - y0) / (y1 - y0)) * height,
    backX: p => back.x(x0 + (p - margin.left) / width * (x1 - x0)),
    backY: p => back.y(y0 + (1 - (p - margin.top) / height) * (y1 - y0)),
  };
}
function visible(x, y) { return x !== null && y !== null && !(log.x && !(x > 0)) && !(log.y && !(y > 0)); }
function marksOf(axis, count) { return log[axis] && box[axis][1] / box[axis][0] > 3 ? decades(box[axis], count) : ticks(box[axis], count); }
function decades([low, high], count) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9), list = [];
  const few = last - first < 3 ? [1, 2, 5] : [1], step = Math.max(1, Math.ceil((last - first) / count));
  for (let k = first - 1; k <= last; k += step) for (const f of few) if (f * 10 ** k >= low && f * 10 ** k <= high) list.push(+(f * 10 ** k).toPrecision(6));
  return list;
}
function ticks([low, high], count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= raw * .999);
  const first = Math.ceil(low / step), list = [];
  for (let k = first; k * step <= high + step * 1e-9 && list.length < 50; k++) list.push(+(k * step).toPrecision(12));
  return list;
}
function polygon(count, radius, turn) {
  return Array.from({ length: count }, (_, k) => {
    const angle = turn + 2 * Math.PI * k / count;
    return `${(radius * Math.cos(angle)).toFixed(2)},${(radius * Math.sin(angle)).toFixed(2)}`;
  }).join(" ");
}
function shape(kind, parent) {
  const up = -Math.PI / 2, marks = { "triangle-up": [3, 6.5, up], "triangle-down": [3, 6.5, -up], "triangle-left": [3, 6.5, Math.PI],
    "triangle-right": [3, 6.5, 0], square: [4, 6.5, Math.PI / 4], diamond: [4, 6.5, up], pentagon: [5, 6, up], hexagon: [6, 6, up], octagon: [8, 6, Math.PI / 8] };
  if (marks[kind]) return make("polygon", { points: polygon(...marks[kind]), class: "mark" }, parent);
  if (kind === "thin-diamond") return make("polygon", { points: "0,-7 4,0 0,7 -4,0", class: "mark" }, parent);
  if (kind === "star") return make("polygon", { points: Array.from({ length: 10 }, (_, k) => { const r = k % 2 ? 3 : 7.5, a = up + Math.PI * k / 5; return `${r * Math.cos(a)},${r * Math.sin(a)}`; }).join(" "), class: "mark" }, parent);
  const strokes = { cross: "M-5,-5L5,5M-5,5L5,-5", saltire: "M-5,-5L5,5M-5,5L5,-5", plus: "M-6,0L6,0M0,-6L0,6", "tri-down": "M0,0L0,6M0,0L-5,-4M0,0L5,-4", "tri-up": "M0,0L0,-6M0,0L-5,4M0,0L5,4" };
  if (strokes[kind]) return make("path", { d: strokes[kind], class: "mark stroke" }, parent);
  return make("circle", { r: 4.8, class: "mark" }, parent);
}
function draw() {
  size = { width: svg.clientWidth, height: svg.clientHeight };
  svg.setAttribute("viewBox", `0 0 ${size.width} ${size.height}`);
  svg.replaceChildren();
  hoverable = [];
  const to = scales(), bottom = size.height - margin.bottom, right = size.width - margin.right;
  for (const value of marksOf("x", Math.max(3, size.width / 110))) {
    make("line", { x1: to.x(value), x2: to.x(value), y1: margin.top, y2: bottom, class: "grid" }, svg);
    make("text", { x: to.x(value), y: bottom + 18, "text-anchor": "middle", class: "tick" }, svg).textContent = format(value);
  }
  for (const value of marksOf("y", Math.max(3, size.height / 70))) {
    make("line", { x1: margin.left, x2: right, y1: to.y(value), y2: to.y(value), class: "grid" }, svg);
    make("text", { x: margin.left - 8, y: to.y(value) + 4, "text-anchor": "end", class: "tick" }, svg).textContent = format(value);
  }
  make("path", { d: `M${margin.left},${margin.top}V${bottom}H${right}`, fill: "none", class: "axis" }, svg);
  make("text", { x: (margin.left + right) / 2, y: size.height - 12, "text-anchor": "middle", class: "name" }, svg).textContent = axisText(view.x);
  make("text", { x: 16, y: (margin.top + bottom) / 2, "text-anchor": "middle", class: "name", transform: `rotate(-90 16 ${(margin.top + bottom) / 2})` }, svg).textContent = axisText(view.y);
  const clip = make("clipPath", { id: "inside" }, make("defs", {}, svg));
  make("rect", { x: margin.left, y: margin.top, width: right - margin.left, height: bottom - margin.top }, clip);
  if (regionsShown()) drawRegions(to, make("g", { "clip-path": "url(#inside)" }, svg));
  const curves = make("g", { "clip-path": "url(#inside)" }, svg), marks = make("g", { "clip-path": "url(#inside)" }, svg), texts = make("g", {}, svg);
  const placed = [];
  for (const branch of data.branches) if (!hidden.has(branch.name)) drawBranch(branch, to, curves, marks, texts, placed);
}
function drawBranch(branch, to, curves, marks, texts, placed) {
  const half = name => (data.periods[name] || Infinity) / 2;
  for (const xs of strands(branch, view.x)) strands(branch, view.y).forEach((ys, strand) => {
    const paths = {};
    for (let i = 0; i + 1 < xs.length; i++) {
      if (!visible(xs[i], ys[i]) || !visible(xs[i + 1], ys[i + 1])) continue;
      if (Math.abs(xs[i + 1] - xs[i]) > half(view.x) || Math.abs(ys[i + 1] - ys[i]) > half(view.y)) continue;
      const style = branch.neutral && branch.neutral[i] ? "neutral" : branch.stable === null ? "plain" : branch.stable[i] ? "stable" : "unstable";
      const part = paths[style] || (paths[style] = { text: [], last: -2 });
      if (part.last !== i) part.text.push(`M${to.x(xs[i]).toFixed(2)},${to.y(ys[i]).toFixed(2)}`);
      part.text.push(`L${to.x(xs[i + 1]).toFixed(2)},${to.y(ys[i + 1]).toFixed(2)}`);
      part.last = i + 1;
    }
    for (const [style, part] of Object.entries(paths)) {
      const look = { stable: { "stroke-width": 2.6 }, unstable: { "stroke-width": 1.6, "stroke-dasharray": "6 4" }, plain: { "stroke-width": 2, ...(branch.dashes ? { "stroke-dasharray": branch.dashes } : {}) }, neutral: { "stroke-width": 1, "stroke-dasharray": "1.5 3" } }[style];
      make("path", { d: part.text.join(""), fill: "none", stroke: branch.colour, "stroke-linejoin": "round", "data-style": style, ...look }, curves);
    }
    if (branch.circles && branch.stable) beads(branch, xs, ys, to, curves);
    for (let i = 0; i < xs.length; i++) if (visible(xs[i], ys[i])) hoverable.push({ x: to.x(xs[i]), y: to.y(ys[i]), branch, row: i });
    if (strand > 0) return;
    for (const mark of branch.marks) {
      if (!visible(xs[mark.row], ys[mark.row])) continue;
      const x = to.x(xs[mark.row]), y = to.y(ys[mark.row]);
      shape(mark.shape, make("g", { transform: `translate(${x.toFixed(2)},${y.toFixed(2)})` }, marks));
      hoverable.push({ x, y, branch, row: mark.row, mark });
      if (x < margin.left || x > size.width - margin.right || y < margin.top || y > size.height - margin.bottom) continue;
      writeLabel(mark.label, x, y, texts, placed);
    }
  });
}
function writeLabel(text, x, y, parent, placed) {
  const width = text.length * 7.5, spots = [[9, -8], [-9 - width, -8], [9, 17], [-9 - width, 17], [-width / 2, -14], [-width / 2, 24], [14, -24], [-14 - width, -24], [14, 33]];
  const free = spots.find(([dx, dy]) => placed.every(p => x + dx > p.x + p.width || x + dx + width < p.x || y + dy < p.y - 12 || y + dy - 12 > p.y));
  if (!free) return;  // hovering still names it
  placed.push({ x: x + free[0], y: y + free[1], width });
  make("text", { x: x + free[0], y: y + free[1], class: "label" }, parent).textContent = text;
}
function facts(branch, row) {
  return Object.entries(branch.columns).filter(([, column]) => column[row] !== null).map(([name, column]) => [axisText(name), format(column[row])]);
}
function stability(branch, row) {
  if (branch.neutral && branch.neutral[Math.min(row, branch.neutral.length - 1)]) return "neutral saddles";
  return branch.stable ? branch.stable[Math.min(row, branch.stable.length - 1)] ? "stable" : "unstable" : "";
}
function describe({ branch, row, mark }) {
  const lines = [`${branch.name} (${branch.what})${mark ? "" : ", " + (stability(branch, row) || "row " + row)}`];
  if (mark) lines.unshift(`${mark.label}: ${mark.words}${mark.note ? ", " + mark.note : ""}`);
  for (const [name, value] of facts(branch, row)) lines.push(`${name} = ${value}`);
  if (mark) for (const [name, value] of mark.form) lines.push(`${name} = ${value}`);
  return lines;
}
function pointer(event) { const frame = svg.getBoundingClientRect(); return { x: event.clientX - frame.left, y: event.clientY - frame.top }; }
function nearestTo(at) {
  let best = null, nearest = 18 * 18;
  for (const spot of hoverable) {
    const d = (spot.x - at.x) ** 2 + (spot.y - at.y) ** 2 - (spot.mark ? 60 : 0);
    if (d < nearest) { nearest = d; best = spot; }
  }
  return best;
}
let drag = null, rubber = null;
svg.addEventListener("pointerdown", event => { drag = pointer(event); svg.setPointerCapture(event.pointerId); });
svg.addEventListener("pointermove", event => {
  const at = pointer(event);
  if (drag) {
    if (!rubber) rubber = make("rect", { fill: "#8884", stroke: "#888" }, svg);
    for (const [key, value] of Object.entries({ x: Math.min(at.x, drag.x), y: Math.min(at.y, drag.y), width: Math.abs(at.x - drag.x), height: Math.abs(at.y - drag.y) })) rubber.setAttribute(key, value);
    return;
  }
  const best = nearestTo(at);
  tip.hidden = !best;
  if (!best) return;
  const lines = describe(best);
  tip.textContent = lines.join("\n");
  tip.classList.toggle("many", lines.length > 18);
  tip.style.left = Math.max(0, Math.min(best.x + 14, size.width - tip.offsetWidth - 4)) + "px";
  tip.style.top = Math.max(best.y - tip.offsetHeight - 10, 0) + "px";
});
svg.addEventListener("pointerup", event => {
  const at = pointer(event), from = drag;
  drag = rubber = null;
  if (from && Math.hypot(at.x - from.x, at.y - from.y) < 6) { const best = nearestTo(at); if (best) detail(best); }
  if (!from || Math.abs(at.x - from.x) < 6 || Math.abs(at.y - from.y) < 6) { draw(); return; }
  const to = scales(), xs = [to.backX(from.x), to.backX(at.x)], ys = [to.backY(from.y), to.backY(at.y)];
  box = { x: [Math.min(...xs), Math.max(...xs)], y: [Math.min(...ys), Math.max(...ys)] };
  draw();
});
svg.addEventListener("pointerleave", () => { tip.hidden = true; });
svg.addEventListener("wheel", event => {
  event.preventDefault();
  const at = pointer(event), to = scales(), factor = Math.exp(event.deltaY * .0015), x = to.backX(at.x), y = to.backY(at.y);
  const about = (v, centre, axis) => log[axis] ? centre * (v / centre) ** factor : centre + (v - centre) * factor;
  box = { x: box.x.map(v => about(v, x, "x")), y: box.y.map(v => about(v, y, "y")) };
  draw();
}, { passive: false });
svg.addEventListener("dblclick", () => { box = extent(); draw(); });
function show(next) { view = next; box = extent(); controls(); draw(); }
function controls() {
  const bar = document.getElementById("bar"), names = axisNames();
  bar.replaceChildren();
  for (const axis of ["x", "y"]) {
    const label = document.createElement("label"), select = document.createElement("select");
    label.append(axis === "x" ? "horizontal " : "vertical ", select);
    for (const name of names) select.add(new Option(axisText(name), name, false, name === view[axis]));
    select.addEventListener("change", () => show({ ...view, [axis]: select.value }));
    const tick = document.createElement("label"), input = document.createElement("input");
    input.type = "checkbox"; input.id = "log-" + axis; input.checked = log[axis];
    input.addEventListener("change", () => { log[axis] = input.checked; box = extent(); draw(); });
    tick.append(input, " log");
    bar.append(label, tick);
  }
  if (data.views.length > 1) for (const each of data.views) {
    const button = document.createElement("button");
    button.textContent = `${each.y} over ${each.x}`;
    button.setAttribute("aria-pressed", each.x === view.x && each.y === view.y);
    button.addEventListener("click", () => show({ ...each }));
    bar.append(button);
  }
  exportButtons();
}
function exportButtons() {
  const bar = document.createElement("span");
  for (const [kind, work] of Object.entries({ SVG: saveSvg, PNG: savePng, CSV: saveCsv })) {
    const button = document.createElement("button");
    button.textContent = kind; button.title = "save as " + kind; button.id = "save-" + kind.toLowerCase();
    button.addEventListener("click", work);
    bar.append(button, " ");
  }
  document.getElementById("bar").append(bar);
}
function legend() {
  const parent = document.getElementById("legend");
  for (const branch of data.branches) {
    const label = document.createElement("label"), input = document.createElement("input"), swatch = document.createElement("span");
    input.type = "checkbox"; input.checked = true;
    swatch.className = "swatch"; swatch.style.borderColor = branch.colour;
    input.addEventListener("change", () => { if (input.checked) hidden.delete(branch.name); else hidden.add(branch.name); draw(); });
    label.append(input, swatch, `${branch.name} (${branch.what})`);
    parent.append(label);
    if (branch.neutral) {
      const dots = document.createElement("span"), note = document.createElement("label");
      dots.className = "swatch"; dots.style.borderColor = branch.colour; dots.style.borderTopStyle = "dotted";
      note.append(dots, "... neutral saddles, no bifurcation");
      parent.append(note);
    }
  }
}
