// SPDX-License-Identifier: Apache-2.0
// Which rows are shown, and in what order. ROWS comes from the page.

const $ = id => document.getElementById(id);
const SORTS = {
  "as in the manifest": null,
  "most words visible": row => row.status === "done" ? (row.missed?.length ?? 0) - (row.visible?.length ?? 0) : 1e9,
  "best predicted": row => row.delta_e ?? 1e9,
  "worst predicted": row => -(row.delta_e ?? -1e9),
  "slowest": row => -(row.seconds ?? -1),
};
const STATES = { visible: "Visible", already: "Was so already", unmeasured: "Set, not measured", missed: "Not visible" };
const SEEDS = new Set(ROWS.map(row => row.seed)).size;
const CHUNK = 120;  // cards that are added at a time
const store = "vibe picks " + location.pathname;
const details = new Map();
let picks = new Set(), shown = [], drawn = 0, here = -1, status = "", lastGroup = "";
try { picks = new Set(JSON.parse(localStorage.getItem(store) || "[]")); } catch {}

function make(tag, cls, text) {
  const element = document.createElement(tag);
  if (cls) element.className = cls;
  if (text !== undefined) element.textContent = text;
  return element;
}
const file = (row, name) => row.folder.split("/").map(encodeURIComponent).join("/") + "/" + name;
const stem = path => path.replace(/\.[^.\/]*$/, "").replace(/^.*\//, "");
const who = (row, scene = true) => [scene && stem(row.scene), SEEDS > 1 && `seed ${row.seed}`].filter(Boolean).join(" · ");
const tally = (rows, key) => rows.reduce((found, row) => found.set(row[key], (found.get(row[key]) || 0) + 1), new Map());

function choices(select, all, key) {
  select.replaceChildren(new Option(all, ""));
  for (const [value, count] of tally(ROWS, key)) select.add(new Option(`${key === "scene" ? stem(value) : value}  (${count})`, value));
}

function chips() {
  const found = tally(ROWS, "status");
  $("status").replaceChildren(...["", ...found.keys(), "picked"].map(name => {
    const count = name === "" ? ROWS.length : name === "picked" ? ROWS.filter(row => picks.has(row.name)).length : found.get(name);
    const chip = make("button", "chip", `${name || "all"} ${count}`);
    chip.setAttribute("aria-pressed", String(status === name));
    chip.onclick = () => { status = name; refresh(); };
    return chip;
  }));
}

function refresh() {
  const scene = $("scene").value, prompt = $("prompt").value, words = $("find").value.toLowerCase().split(/\s+/).filter(Boolean);
  const wanted = row => (!scene || row.scene === scene) && (!prompt || row.prompt === prompt)
    && (!status || (status === "picked" ? picks.has(row.name) : row.status === status))
    && words.every(word => `${row.scene} ${row.prompt} ${row.seed} ${row.error || ""}`.toLowerCase().includes(word));
  shown = ROWS.filter(wanted);
  const by = SORTS[$("sort").value], group = $("group").value;
  if (by) shown.sort((a, b) => by(a) - by(b));
  if (group) {
    const order = new Map([...tally(ROWS, group).keys()].map((name, place) => [name, place]));
    shown.sort((a, b) => order.get(a[group]) - order.get(b[group]));
  }
  $("count").textContent = (shown.length === ROWS.length ? `${ROWS.length} results` : `${shown.length} of ${ROWS.length} results`);
  $("empty").hidden = shown.length > 0;
  drawn = 0; here = -1; lastGroup = undefined;
  $("grid").replaceChildren();
  chips();
  more();
}

function more() {
  const group = $("group").value;
  for (const end = Math.min(drawn + CHUNK, shown.length); drawn < end; drawn++) {
    const row = shown[drawn];
    if (group && row[group] !== lastGroup) {
      lastGroup = row[group];
      $("grid").append(make("h2", "", group === "scene" ? stem(lastGroup) : lastGroup));
    }
    $("grid").append(card(row, drawn));
  }
}
