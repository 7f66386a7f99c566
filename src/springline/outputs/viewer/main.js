// Everything linked: one cursor for the scene, the map, the chart, the section and the address.

const byId = (id) => document.getElementById(id);

function makeScene(survey) {
  try {
    return new PipeScene(survey);
  } catch {
    document.querySelector("#scene .fail").hidden = false;
    document.querySelector("#scene .hint").hidden = true;
    return null;
  }
}

function fillLegends(survey, mode) {
  const limit = survey.limits[mode] * 1e3;
  const [inward, outward] = document.querySelectorAll("#scene .scale span");
  inward.textContent = `inward −${limit}`;
  outward.textContent = `+${limit} mm outward`;
  const stops = Array.from({ length: 11 }, (_, n) => survey.palette[Math.round((n / 10) * (survey.levels - 1))]);
  document.querySelector("#scene .scale i").style.background = `linear-gradient(90deg, ${stops.map((rgb) => `rgb(${rgb})`).join(",")})`;
  byId("map-title").textContent = mode === "shape" ? `Departure from a circle of ${(survey.circle * 1e3).toFixed(1)} mm` : "Departure from the fitted section";
  const present = new Set(cellColours(survey, mode));
  byId("legend").replaceChildren(...Object.entries(survey.reasons).filter(([, colour]) => present.has(colour)).map(([flag, colour]) => {
    const item = document.createElement("li");
    const chip = document.createElement("i");
    chip.style.background = `rgb(${survey.palette[colour]})`;
    item.append(chip, survey.reasonWords[flag]);
    return item;
  }));
}

function fillSeriesLegend(series) {
  byId("series-legend").replaceChildren(...SERIES[series].lines.map(([, label, colour, dash]) => {
    const item = document.createElement("li");
    const line = document.createElement("i");
    line.className = "line";
    line.style.borderTopStyle = dash ? (dash[0] > 3 ? "dashed" : "dotted") : "solid";
    line.style.borderColor = colour;
    item.append(line, label);
    return item;
  }));
}

function available(survey) {
  return Object.keys(SERIES).filter((name) => SERIES[name].lines.some(([variable]) => survey[variable].some(Number.isFinite)));
}

async function start() {
  const survey = await loadSurvey();
  const scene = makeScene(survey);
  const section = new SectionView(survey);
  let cursor = survey.low;

  function go(chainage, { remember = true } = {}) {
    if (!Number.isFinite(chainage)) return;
    cursor = Math.min(survey.high, Math.max(survey.low, chainage));
    section.setCursor(cursor);
    strips.setCursor(cursor);
    if (scene) scene.setCursor(cursor);
    byId("chainage").value = cursor.toFixed(3);
    if (remember) history.replaceState(null, "", `#chainage=${cursor.toFixed(3)}`);
  }
  const strips = new Strips(survey, go);

  function step(count) {
    const group = Math.min(survey.groups - 1, Math.max(0, groupAt(survey, cursor) + count));
    go(survey.chainage[group]);
  }
  function feature(direction) {
    const places = survey.features.map((f) => f.chainage).filter((x) => direction * (x - cursor) > 1e-3);
    if (places.length) go(direction > 0 ? Math.min(...places) : Math.max(...places));
  }
  function setMode(mode) {
    byId("mode").value = strips.mode = mode;
    if (scene) scene.setMode(mode);
    fillLegends(survey, mode);
    strips.draw();
  }
  function setSeries(name) {
    byId("series").value = strips.series = name;
    fillSeriesLegend(name);
    strips.draw();
  }
  function cycle(id, by, set) {
    const select = byId(id);
    const next = select.selectedIndex + by;
    select.selectedIndex = id === "exaggeration" ? Math.min(select.length - 1, Math.max(0, next)) : (next + select.length) % select.length;
    set(select.value);
  }
  const setExaggeration = (value) => scene && scene.setExaggeration(Number(value));
  const act = {
    inside: (button) => scene && button.setAttribute("aria-pressed", scene.toggle("inside")),
    cut: (button) => scene && button.setAttribute("aria-pressed", scene.toggle("cut")),
    wire: (button) => scene && button.setAttribute("aria-pressed", scene.toggle("wire")),
    shot: () => scene && scene.save(`pipe-${cursor.toFixed(2)}m.png`),
  };
  const press = (name) => act[name](document.querySelector(`[data-act="${name}"]`));
  const keys = {
    ArrowRight: (e) => step(e.shiftKey ? 10 : 1), ArrowLeft: (e) => step(e.shiftKey ? -10 : -1),
    PageDown: () => go(cursor + 1), PageUp: () => go(cursor - 1), Home: () => go(survey.low), End: () => go(survey.high),
    n: () => feature(1), p: () => feature(-1), i: () => press("inside"), x: () => press("cut"), w: () => press("wire"), s: () => press("shot"),
    m: () => cycle("mode", 1, setMode), c: () => cycle("series", 1, setSeries),
    "[": () => cycle("exaggeration", -1, setExaggeration), "]": () => cycle("exaggeration", 1, setExaggeration),
    "+": () => scene && scene.zoom(0.8), "=": () => scene && scene.zoom(0.8), "-": () => scene && scene.zoom(1.25),
    "?": () => byId("help").showModal(),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input, select, dialog")) return;
    const handle = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!handle) return;
    event.preventDefault();
    handle(event);
  });
  for (const button of document.querySelectorAll("[data-act]")) button.addEventListener("click", () => press(button.dataset.act));
  byId("mode").addEventListener("change", (event) => setMode(event.target.value));
  byId("series").addEventListener("change", (event) => setSeries(event.target.value));
  byId("exaggeration").addEventListener("change", (event) => setExaggeration(event.target.value));
  byId("goto").addEventListener("submit", (event) => {
    event.preventDefault();
    go(Number.parseFloat(byId("chainage").value.replace(",", ".")));
  });
  if (scene) {
    scene.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      if (scene.inside) go(cursor - (event.deltaY / 400) * survey.circle);
      else scene.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY / 500))));
    }, { passive: false });
  }
  const linked = () => Number.parseFloat((/[#&]chainage=([-+.\deE]+)/.exec(location.hash) || [])[1]);
  window.addEventListener("hashchange", () => go(linked(), { remember: false }));
  window.addEventListener("resize", () => {
    strips.draw();
    section.draw();
    if (scene) scene.request();
  });

  const names = available(survey);
  byId("series").replaceChildren(...names.map((name) => new Option(`${name} [${SERIES[name].unit}]`, name)));
  setSeries(names[0] || "Coverage");
  fillLegends(survey, "shape");
  const wanted = linked();
  go(Number.isFinite(wanted) ? wanted : survey.chainage[0], { remember: false });
  document.body.dataset.ready = scene ? "yes" : "without-webgl";
}

start().catch((error) => {
  document.body.dataset.ready = "failed";
  const note = document.querySelector("#scene .fail");
  note.textContent = `This viewer could not be opened: ${error.message}. A current browser is needed.`;
  note.hidden = false;
});
