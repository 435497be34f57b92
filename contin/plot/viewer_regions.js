// Regions of a diagram in two parameters, and circles on families of orbits.
function regionsShown() { return Boolean(data.phase) && view.x === data.phase.parameters[0] && view.y === data.phase.parameters[1]; }
function drawRegions(to, parent) {
  for (const region of data.phase.regions) {
    const ring = points => points.map(([x, y], i) => `${i ? "L" : "M"}${to.x(log.x ? Math.max(x, box.x[0] * 1e-3) : x).toFixed(1)},${to.y(log.y ? Math.max(y, box.y[0] * 1e-3) : y).toFixed(1)}`).join("") + "Z";
    const path = make("path", { d: [region.outline, ...region.holes].map(ring).join(""), "fill-rule": "evenodd", class: "region", "fill-opacity": .85, fill: region.fill }, parent);
    make("title", {}, path).textContent = `${region.name}: ${region.words}`;
    if (region.at) make("text", { x: to.x(region.at[0]), y: to.y(region.at[1]) + 5, "text-anchor": "middle", class: "letter" }, parent).textContent = region.name;
  }
}
function regionKey() {
  if (!data.phase) return;
  const table = document.getElementById("key"), seen = new Set();
  for (const region of data.phase.regions) {
    if (seen.has(region.name)) continue;
    seen.add(region.name);
    const row = table.insertRow(), name = row.insertCell(), words = row.insertCell();
    name.textContent = region.name; name.style.background = region.fill; name.style.color = "#333"; name.style.padding = "1px 8px";
    words.textContent = region.words; words.style.paddingLeft = ".6rem";
  }
}
function beads(branch, xs, ys, to, parent) {
  let last = null;
  for (let i = 0; i < xs.length; i++) {
    if (!visible(xs[i], ys[i])) continue;
    const x = to.x(xs[i]), y = to.y(ys[i]);
    if (last && Math.hypot(x - last[0], y - last[1]) < 13) continue;
    last = [x, y];
    const stable = branch.stable[Math.min(i, branch.stable.length - 1)];
    make("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 3, fill: stable ? branch.colour : "var(--paper)", stroke: branch.colour, "stroke-width": 1.1, class: stable ? "bead filled" : "bead open" }, parent);
  }
}
