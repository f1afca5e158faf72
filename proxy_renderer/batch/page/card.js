// SPDX-License-Identifier: Apache-2.0
// A card of the sheet: the pictures, with the slider over them, and what is below.

function frames(row, suffix) {  // of several shots that share a look, all of them: one slider moves them together
  if (!row.shots) return frame(row, suffix, 0, "");
  const box = make("div", "shots");
  box.style.setProperty("--across", row.shots.length === 2 ? 1 : Math.ceil(Math.sqrt(row.shots.length)));
  row.shots.forEach((name, number) => {
    const one = frame(row, suffix, number, name);
    one.append(make("span", "name", name));
    box.append(one);
  });
  return box;
}

function frame(row, suffix, number, name) {
  const box = make("div", "frame");
  for (const kind of ["after", "before"]) {
    const picture = make("img", kind);
    picture.loading = "lazy"; picture.decoding = "async"; picture.draggable = false;
    picture.src = file(row, kind + (number ? `-${number + 1}` : "") + suffix);
    picture.onload = () => box.style.setProperty("--ratio", picture.naturalWidth / picture.naturalHeight);
    picture.alt = [stem(row.scene), name, kind].filter(Boolean).join(", ");
    box.append(picture);
  }
  box.append(make("i", "edge"), make("span", "said", "before"), make("span", "said right", "after"));
  return box;
}

function card(row, place) {
  const one = make("article", "card " + row.status);
  one.dataset.place = place;
  one.classList.toggle("picked", picks.has(row.name));
  if (row.status === "done") {
    const box = frames(row, ".jpg");
    box.onpointermove = event => { if (event.pointerType === "mouse") cut(box, event); };
    box.onpointerleave = () => { box.classList.remove("cut"); box.style.setProperty("--cut", "0%"); };
    const star = make("button", "pick", picks.has(row.name) ? "★" : "☆");
    star.title = "Pick (P)"; star.tabIndex = -1;
    star.onclick = event => { event.stopPropagation(); pick(row); };
    box.append(star);
    one.append(box);
  } else {
    const box = make("div", "frame none");
    box.append(make("b", "", row.status), make("span", "", row.error || "It has not been done yet."));
    if (row.remedy) box.append(make("span", "", row.remedy));
    one.append(box);
  }
  one.append(make("div", "words", row.prompt));
  const meta = make("div", "meta");
  meta.append(make("span", "who", who(row, $("group").value !== "scene")));
  if (row.status === "done") {
    one.append(verdict(row));
    if ($("sort").value.includes("predicted")) {
      const box = make("span", "", "ΔE ");
      box.append(make("b", "", row.delta_e.toFixed(1)));
      box.title = "how far the prediction was from the render (CIEDE2000)";
      meta.append(box);
    }
  }
  one.append(meta);
  one.onclick = () => { go(place); open_(); };
  return one;
}

function verdict(row) {  // words by what the render shows of them
  const box = make("div", "verdict");
  for (const [state, name] of Object.entries(STATES)) if (row[state]?.length) box.append(make("span", state, `${name}: ${row[state].join(", ")}`));
  return box;
}

function cut(box, event) {
  const area = (event.target.closest?.(".frame") || box).getBoundingClientRect();
  const share = Math.min(Math.max((event.clientX - area.left) / area.width, 0), 1);
  box.classList.add("cut");
  box.style.setProperty("--cut", 100 * share + "%");
  box.style.setProperty("--edge", 100 * share + "%");
}
