// SPDX-License-Identifier: Apache-2.0
// One result, large, with its values and their reasons.

function open_() {
  const row = shown[here];
  if (!row) return;
  $("view").replaceWith(view(row));
  facts(row);
  if (row.status === "done" && !details.has(row.name)) {  // a page from disk may load scripts, and nothing else
    const script = make("script");
    script.src = file(row, "details.js");
    script.onload = script.onerror = () => { script.remove(); if (shown[here] === row) facts(row); };
    document.head.append(script);
  }
  if (!$("large").open) $("large").showModal();
  document.activeElement?.blur();
}
function vibeDetails(name, content) { details.set(name, content); }

function view(row) {
  let box;
  if (row.status === "done") {
    box = frames(row, ".png");
    for (const one of row.shots ? box.children : [box]) one.classList.add("cut");
    box.onpointerdown = event => { box.setPointerCapture(event.pointerId); cut(box, event); };
    box.onpointermove = event => { if (event.buttons) cut(box, event); };
  } else {
    box = make("div", "frame none");
    box.append(make("b", "", row.status));
  }
  box.id = "view";
  return box;
}

function facts(row) {
  const list = [make("div", "meta", who(row)), make("h3", "", row.prompt)];
  if (row.error) {
    const box = make("div", "error", row.error);
    if (row.remedy) box.append(make("div", "meta", row.remedy));
    list.push(box);
  }
  if (row.status === "done") {
    const scores = make("div", "scores");
    for (const [name, value] of [["ΔE between prediction and render", row.delta_e.toFixed(2)], ["seconds", row.seconds.toFixed(0)]]) {
      const box = make("div");
      box.append(make("b", "", value), name);
      scores.append(box);
    }
    list.push(verdict(row), scores);
  }
  if (row.final_error) list.push(make("div", "error", "Final frames: " + row.final_error));
  const links = make("div", "links");
  const files = row.status === "done" ? { ".blend": "vibed.blend", "preset": "preset.json", "comparison": "compare.png", "report": "report.json", "log": "log.txt" } : row.error ? { "log": "log.txt" } : {};
  if (row.variants) files[`${row.variants} variants`] = "variants.png";
  if (row.frames) files[`${row.frames} final frames`] = "frames/";
  for (const [name, place] of Object.entries(files)) {
    const link = make("a", "", name);
    link.href = file(row, place); link.target = "_blank";
    links.append(link);
  }
  if (row.status === "done") {
    const star = make("button", "", picks.has(row.name) ? "★ picked" : "☆ pick");
    star.onclick = () => pick(row);
    links.append(star);
  }
  list.push(links);
  const more = details.get(row.name);
  if (more) list.push(...changes(more));
  $("facts").replaceChildren(...list);
}

function changes(more) {
  const list = [make("h4", "", `${more.parameters.length} values changed, ${more.left} left alone`)];
  for (const [title, before, after, why] of more.parameters) {
    const box = make("div", "change"), name = make("div", "name"), values = make("span");
    values.append(value(before), " → ", value(after));
    name.append(make("span", "", title), values);
    box.append(name);
    if (why) box.append(make("div", "why", why));
    list.push(box);
  }
  const notes = [...more.warnings, ...(more.understood.notes || [])];
  if (more.understood.ignored) notes.push("Left out: " + more.understood.ignored.join(", "));
  for (const [word, guess] of Object.entries(more.understood.guesses || {})) notes.push(`“${word}” was taken for “${guess}”`);
  if (notes.length) {
    const box = make("ul", "notes");
    box.append(...notes.map(note => make("li", "", note)));
    list.push(make("h4", "", "Notes"), box);
  }
  return list;
}
function value(given) {  // a number comes as text with its unit, a color as three numbers
  if (!Array.isArray(given)) return document.createTextNode(given);
  const box = make("i", "swatch");
  const shade = x => Math.round(255 * Math.min(Math.max(x <= .0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - .055, 0), 1));
  box.style.background = `rgb(${given.map(shade).join(" ")})`;
  box.title = given.map(x => x.toFixed(3)).join(", ");
  return box;
}
