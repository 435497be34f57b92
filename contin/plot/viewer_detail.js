// What a label or a row is: orbit in time and in phase space, spectrum, normal form, all columns.
function detail({ branch, row, mark }) {
  const home = document.getElementById("detail"), panels = document.createElement("div"), title = document.createElement("h2");
  home.hidden = false;
  home.replaceChildren(title, panels);
  panels.id = "panels";
  title.textContent = mark ? `${branch.name}.${mark.label}: ${mark.words}${mark.note ? ", " + mark.note : ""}` : `${branch.name}, row ${row} (${stability(branch, row) || branch.what})`;
  const orbit = orbitAt(branch, row, mark);
  if (orbit) {
    const states = Object.keys(orbit.columns).filter(name => name !== "t"), apart = orbit.row === row ? "" : ` (of row ${orbit.row}, the nearest that is kept)`;
    panel(panels, `in time${apart}`, "t", "", states.map(name => [name, orbit.columns.t, orbit.columns[name]]));
    if (states.length > 1) panel(panels, `in phase space${apart}`, states[0], states[1], [["", orbit.columns[states[0]], orbit.columns[states[1]]]]);
  }
  const spectrum = mark && mark.spectrum.length ? mark.spectrum : branch.spectrum ? branch.spectrum[row] : null;
  if (spectrum && spectrum.length) spectrumPanel(panels, spectrum, branch.multipliers);
  const side = document.createElement("div");
  side.className = "facts";
  if (mark && mark.form.length) side.append(tableOf("normal form", mark.form));
  if (spectrum && spectrum.length) side.append(tableOf(branch.multipliers ? "multipliers" : "eigenvalues", spectrum.map(([re, im], k) => [String(k + 1), im === 0 ? format(re) : `${format(re)} ${im < 0 ? "\u2212" : "+"} ${format(Math.abs(im))}i`])));
  side.append(tableOf("values", facts(branch, row)));
  const scroll = document.createElement("div");
  scroll.className = "scroll";
  scroll.append(side);
  home.append(scroll);
}
function orbitAt(branch, row, mark) {
  if (mark && mark.orbit) return { row, columns: mark.orbit };
  let best = null;
  const labelled = branch.marks.filter(one => one.orbit).map(one => ({ row: one.row, columns: one.orbit }));
  for (const one of [...branch.orbits, ...labelled]) if (!best || Math.abs(one.row - row) < Math.abs(best.row - row)) best = one;
  return best;
}
function tableOf(caption, rows) {
  const table = document.createElement("table");
  table.createCaption().textContent = caption;
  for (const cells of rows) { const line = table.insertRow(); for (const cell of cells) line.insertCell().textContent = cell; }
  return table;
}
function small(parent, caption) {
  const figure = document.createElement("figure"), drawing = make("svg", { role: "img", "aria-label": [caption].flat().map(part => part.textContent || part).join("") }), words = document.createElement("figcaption");
  words.append(...[caption].flat());
  figure.append(drawing, words);
  parent.append(figure);
  return { drawing, width: drawing.clientWidth, height: drawing.clientHeight };
}
function frame(drawing, width, height, x, y, names) {
  const edge = { left: 52, right: 10, top: 8, bottom: 34 };
  drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const toX = v => edge.left + (v - x[0]) / (x[1] - x[0]) * (width - edge.left - edge.right), toY = v => height - edge.bottom - (v - y[0]) / (y[1] - y[0]) * (height - edge.top - edge.bottom);
  for (const v of ticks(x, 4)) make("text", { x: toX(v), y: height - edge.bottom + 15, "text-anchor": "middle", class: "tick" }, drawing).textContent = format(v);
  for (const v of ticks(y, 4)) make("text", { x: edge.left - 5, y: toY(v) + 4, "text-anchor": "end", class: "tick" }, drawing).textContent = format(v);
  make("path", { d: `M${edge.left},${edge.top}V${height - edge.bottom}H${width - edge.right}`, fill: "none", class: "axis" }, drawing);
  make("text", { x: (edge.left + width) / 2, y: height - 3, "text-anchor": "middle", class: "name" }, drawing).textContent = names[0];
  if (names[1]) make("text", { x: 11, y: height / 2, "text-anchor": "middle", class: "name", transform: `rotate(-90 11 ${height / 2})` }, drawing).textContent = names[1];
  return { toX, toY };
}
function ends(lists) {
  const all = lists.flat().filter(v => v !== null), low = Math.min(...all), high = Math.max(...all), d = high > low ? .05 * (high - low) : Math.abs(high) / 2 || 1;
  return [low - d, high + d];
}
const INKS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"];
function panel(parent, caption, x, y, curves) {
  const names = curves.map(c => c[0]).filter(Boolean).map((name, k) => { const word = document.createElement("b"); word.textContent = name + " "; word.style.color = INKS[k % INKS.length]; return word; });
  const { drawing, width, height } = small(parent, [...names, caption]);
  const { toX, toY } = frame(drawing, width, height, ends(curves.map(c => c[1])), ends(curves.map(c => c[2])), [x, y]);
  curves.forEach(([name, xs, ys], k) => {
    const parts = xs.map((v, i) => `${i ? "L" : "M"}${toX(v).toFixed(1)},${toY(ys[i]).toFixed(1)}`);
    const path = make("path", { d: parts.join(""), fill: "none", stroke: INKS[k % INKS.length], "stroke-width": 1.6, class: "orbit" }, drawing);
    if (name) make("title", {}, path).textContent = name;
  });
}
function spectrumPanel(parent, spectrum, multipliers) {
  const { drawing, width, height } = small(parent, multipliers ? "multipliers and the unit circle" : "eigenvalues and the imaginary axis");
  const radius = Math.max(...spectrum.map(([re, im]) => Math.hypot(re, im)), multipliers ? 1 : 0) * 1.15 || 1, wide = radius * (width - 62) / (height - 42);
  const { toX, toY } = frame(drawing, width, height, [-wide, wide], [-radius, radius], ["Re", "Im"]);
  if (multipliers) make("ellipse", { cx: toX(0), cy: toY(0), rx: toX(1) - toX(0), ry: toY(0) - toY(1), fill: "none", class: "grid" }, drawing);
  else make("line", { x1: toX(0), x2: toX(0), y1: toY(radius), y2: toY(-radius), class: "grid" }, drawing);
  for (const [re, im] of spectrum) make("circle", { cx: toX(re), cy: toY(im), r: 4, fill: (multipliers ? Math.hypot(re, im) > 1 : re > 0) ? "#D55E00" : "#0072B2", class: "eigenvalue" }, drawing);
}
