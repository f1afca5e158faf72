// SPDX-License-Identifier: Apache-2.0
// Moving about, picks and the keyboard; starts everything.

function go(place) {
  if (!shown.length) return;
  here = Math.min(Math.max(place, 0), shown.length - 1);
  while (drawn <= here) more();
  document.querySelector(".card.here")?.classList.remove("here");
  const one = document.querySelector(`.card[data-place="${here}"]`);
  one.classList.add("here");
  const area = one.getBoundingClientRect(), top = document.querySelector("header").offsetHeight;
  if (area.top < top + 8) scrollBy(0, area.top - top - 20);
  else if (area.bottom > innerHeight) scrollBy(0, area.bottom - innerHeight + 20);
}

function pick(row) {
  picks.has(row.name) ? picks.delete(row.name) : picks.add(row.name);
  try { localStorage.setItem(store, JSON.stringify([...picks])); } catch {}
  const one = document.querySelector(`.card[data-place="${shown.indexOf(row)}"]`);
  if (one) { one.classList.toggle("picked", picks.has(row.name)); one.querySelector(".pick").textContent = picks.has(row.name) ? "★" : "☆"; }
  chips();
  if ($("large").open) facts(row);
}

function columns() {
  const cards = [...document.querySelectorAll(".card")].slice(0, 60);
  return Math.max(1, cards.findIndex((one, i) => i && one.offsetTop !== cards[0].offsetTop)) || 1;
}

addEventListener("keydown", event => {
  const typing = event.target.matches("input, select"), large = $("large").open;
  if (event.key === "Escape" && typing) return event.target.blur();
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: large ? -1 : -columns(), ArrowDown: large ? 1 : columns(), Home: -1e9, End: 1e9 }[event.key];
  if (step) { go(here < 0 ? 0 : here + step); if (large) open_(); }
  else if (event.key === "Enter" && !large && event.target === document.body) open_();
  else if (event.key === " " && large) { const box = $("view"), all = box.style.getPropertyValue("--cut") !== "100%"; box.style.setProperty("--cut", all ? "100%" : "0%"); box.style.setProperty("--edge", all ? "100%" : "0%"); }
  else if (event.key.toLowerCase() === "p" && shown[here]?.status === "done") pick(shown[here]);
  else if (event.key === "/") $("find").focus();
  else return;
  event.preventDefault();
});
$("large").addEventListener("close", () => { if (here >= 0) go(here); });
$("close").onclick = () => $("large").close();
$("clear").onclick = () => { $("scene").value = $("prompt").value = $("find").value = status = ""; refresh(); };
for (const id of ["scene", "prompt", "sort", "group", "find"]) $(id).oninput = refresh;
$("size").oninput = () => document.documentElement.style.setProperty("--thumb", $("size").value + "px");
addEventListener("scroll", () => { if (innerHeight + scrollY > document.body.offsetHeight - 1200) more(); }, { passive: true });
choices($("scene"), "all scenes", "scene");
choices($("prompt"), "all prompts", "prompt");
for (const name of Object.keys(SORTS)) $("sort").add(new Option(name));
refresh();
