// The picture as SVG and PNG, the rows as CSV: made here, handed to the browser as files.
function standalone() {
  const copy = svg.cloneNode(true), theme = getComputedStyle(document.documentElement);
  const plain = text => text.replace(/var\((--[a-z]+)\)/g, (_, name) => theme.getPropertyValue(name).trim());
  const rules = [...document.styleSheets[0].cssRules].filter(rule => rule.selectorText && /^\.(grid|axis|tick|name|label|mark|stroke|region|letter)\b/.test(rule.selectorText)).map(rule => rule.cssText);
  copy.setAttribute("xmlns", space);
  copy.setAttribute("width", size.width);
  copy.setAttribute("height", size.height);
  copy.setAttribute("style", "font-family: sans-serif");
  for (const node of copy.querySelectorAll("[fill^='var('], [stroke^='var(']")) for (const key of ["fill", "stroke"]) if (node.hasAttribute(key)) node.setAttribute(key, plain(node.getAttribute(key)));
  const style = make("style", {});
  style.textContent = plain(rules.join("\n"));
  copy.prepend(style, make("rect", { width: size.width, height: size.height, fill: theme.getPropertyValue("--paper").trim() }));
  return new XMLSerializer().serializeToString(copy);
}
function hand(blob, ending) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = (data.title.replace(/[^\w-]+/g, "-").replace(/^-+|-+$/g, "") || "diagram") + "." + ending;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
function saveSvg() { hand(new Blob([standalone()], { type: "image/svg+xml" }), "svg"); }
function savePng() {
  const image = new Image(), scale = 2;
  image.onload = () => {
    const canvas = document.createElement("canvas");
    canvas.width = scale * size.width; canvas.height = scale * size.height;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob(blob => hand(blob, "png"));
  };
  image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(standalone());
}
function table() {
  const shown = data.branches.filter(branch => !hidden.has(branch.name)), names = [...new Set(shown.flatMap(branch => Object.keys(branch.columns)))];
  const cell = value => { const text = value === null || value === undefined ? "" : String(value); return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text; };
  const lines = [["branch", "row", "label", "stability", ...names].map(cell).join(",")];
  for (const branch of shown) {
    const labels = new Map(branch.marks.map(mark => [mark.row, mark.label])), count = Math.max(...Object.values(branch.columns).map(column => column.length));
    for (let i = 0; i < count; i++) lines.push([branch.name, i, labels.get(i) || "", stability(branch, i), ...names.map(name => branch.columns[name] ? branch.columns[name][i] : "")].map(cell).join(","));
  }
  return lines.join("\n") + "\n";
}
function saveCsv() { hand(new Blob([table()], { type: "text/csv" }), "csv"); }
