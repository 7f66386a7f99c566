// Everything linked: one cursor for the scene, the map, the chart, the section, the feature and the address.

const byId = (id) => document.getElementById(id);
const FLIGHT = 2.5;

function makeScene(survey, onPick) {
  try {
    return new PipeScene(survey, onPick);
  } catch {
    document.querySelector("#scene .fail").hidden = false;
    document.querySelector("#scene .hint").hidden = true;
    return null;
  }
}

function mapTitle(survey, mode) {
  return {
    shape: `Departure from a circle of ${(survey.circle * 1e3).toFixed(1)} mm`,
    surface: "Departure from the fitted section",
    intensity: `${survey.brightnessOf} of the wall`,
    difference: `Change ${survey.otherLater ? "until" : "since"} ${survey.otherName}, outward positive`,
    other: `${survey.otherName}: departure from the same circle`,
  }[mode];
}

function fillLegends(survey, mode) {
  const grey = mode === "intensity";
  const limit = survey.limits[mode] * 1e3;
  const [inward, outward] = document.querySelectorAll("#scene .scale span");
  inward.textContent = grey ? "dark" : `inward −${limit}`;
  outward.textContent = grey ? "bright" : `+${limit} mm outward`;
  const [first, last] = grey ? [survey.greys, survey.palette.length - 1] : [0, survey.levels - 1];
  const stops = Array.from({ length: 11 }, (_, n) => survey.palette[first + Math.round((n / 10) * (last - first))]);
  document.querySelector("#scene .scale i").style.background = `linear-gradient(90deg, ${stops.map((rgb) => `rgb(${rgb})`).join(",")})`;
  byId("map-title").textContent = mapTitle(survey, mode);
  const present = new Uint8Array(256);
  for (const colour of cellColours(survey, mode)) present[colour] = 1;
  byId("legend").replaceChildren(...Object.entries(survey.reasons).filter(([, colour]) => present[colour]).map(([flag, colour]) => {
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
  return Object.keys(SERIES).filter((name) => SERIES[name].lines.some(([variable]) => survey[variable] && survey[variable].some(Number.isFinite)));
}

// Two places on the wall, taken from scene or map, and what lies between them.
class Ruler {
  constructor(survey, scene, strips) {
    Object.assign(this, { survey, scene, strips, points: [], on: false });
  }

  toggle() {
    this.on = !this.on;
    this.points = [];
    this.show();
    return this.on;
  }

  take(point) {
    this.points = this.points.length === 2 ? [point] : [...this.points, point];
    this.show();
  }

  show() {
    const { points } = this;
    if (this.scene) this.scene.setRuler(points);
    this.strips.ruler = points;
    this.strips.draw();
    const box = byId("measured");
    box.hidden = !this.on;
    const name = (p) => `${p.chainage.toFixed(3)} m, ${clockText(p.bearing)}`;
    if (points.length < 2) {
      box.textContent = points.length ? `From ${name(points[0])} to … (click the other place)` : "Click two places on the wall or the map.";
      return;
    }
    const found = measureBetween(...points);
    const mm = (value) => `${(1e3 * value).toFixed(1)} mm`;
    box.textContent = `${mm(found.straight)} straight; ${mm(found.along)} along, ${mm(found.arc)} of arc (${((180 / Math.PI) * found.turn).toFixed(1)}°). From ${name(points[0])} to ${name(points[1])}.`;
  }
}

async function start() {
  const survey = await loadSurvey();
  let cursor = survey.low;
  let flight = null;
  const exaggeration = () => Number(byId("exaggeration").value);
  const pick = (point) => (ruler.on ? ruler.take(point) : go(point.chainage));
  const scene = makeScene(survey, pick);
  const section = new SectionView(survey);
  const feature = new FeatureView(survey, (chainage) => go(chainage));

  function go(chainage, { remember = true } = {}) {
    if (!Number.isFinite(chainage)) return;
    cursor = Math.min(survey.high, Math.max(survey.low, chainage));
    section.setCursor(cursor);
    strips.setCursor(cursor);
    feature.setCursor(cursor);
    if (scene) scene.setCursor(cursor);
    byId("chainage").value = cursor.toFixed(3);
    if (remember) history.replaceState(null, "", `#chainage=${cursor.toFixed(3)}`);
  }
  const strips = new Strips(survey, (chainage, bearing) => {
    const at = Math.min(survey.high, Math.max(survey.low, chainage));
    if (ruler.on && bearing !== null) ruler.take(wallPoint(survey, at, bearing, exaggeration()));
    else go(at);
  });
  const ruler = new Ruler(survey, scene, strips);
  const corrections = new Corrections(() => ({ chainage: cursor, feature: feature.current, measured: ruler.points }));

  function step(count) {
    const group = Math.min(survey.groups - 1, Math.max(0, groupAt(survey, cursor) + count));
    go(survey.chainage[group]);
  }
  function nextFeature(direction) {
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
  const setExaggeration = (value) => {
    if (scene) scene.setExaggeration(Number(value));
    ruler.points = ruler.points.map((p) => wallPoint(survey, p.chainage, p.bearing, Number(value)));
    ruler.show();
  };
  const pressed = (button, state) => button.setAttribute("aria-pressed", String(state));

  // Along the axis at a walking pace for the size of the pipe, until the end, a key or a second press.
  function fly(button) {
    if (flight !== null || !scene) {
      cancelAnimationFrame(flight);
      flight = null;
      return pressed(button, false);
    }
    if (!scene.inside) press("inside");
    if (cursor >= survey.high) go(survey.low);
    let before = performance.now();
    const onward = (now) => {
      go(cursor + (FLIGHT * survey.circle * Math.min(now - before, 200)) / 1e3, { remember: false });
      before = now;
      if (cursor < survey.high) flight = requestAnimationFrame(onward);
      else fly(button);
    };
    flight = requestAnimationFrame(onward);
    return pressed(button, true);
  }
  function beside(button) {
    if (!survey.other) return;
    byId("other-map").hidden = !byId("other-map").hidden;
    if (scene) scene.toggle("beside");
    pressed(button, !byId("other-map").hidden);
    strips.draw();
  }
  const act = {
    inside: (button) => scene && pressed(button, scene.toggle("inside")),
    fly,
    cut: (button) => scene && pressed(button, scene.toggle("cut")),
    wire: (button) => scene && pressed(button, scene.toggle("wire")),
    measure: (button) => pressed(button, ruler.toggle()),
    beside,
    shot: () => scene && scene.save(`pipe-${cursor.toFixed(2)}m.png`),
    correct: () => corrections.open(),
    help: () => byId("help").showModal(),
  };
  const press = (name) => act[name](document.querySelector(`[data-act="${name}"]`));
  const keys = {
    ArrowRight: (e) => step(e.shiftKey ? 10 : 1), ArrowLeft: (e) => step(e.shiftKey ? -10 : -1),
    PageDown: () => go(cursor + 1), PageUp: () => go(cursor - 1), Home: () => go(survey.low), End: () => go(survey.high),
    n: () => nextFeature(1), p: () => nextFeature(-1), i: () => press("inside"), f: () => press("fly"), x: () => press("cut"), w: () => press("wire"),
    r: () => press("measure"), b: () => press("beside"), s: () => press("shot"), o: () => press("correct"),
    m: () => cycle("mode", 1, setMode), c: () => cycle("series", 1, setSeries),
    "[": () => cycle("exaggeration", -1, setExaggeration), "]": () => cycle("exaggeration", 1, setExaggeration),
    "+": () => scene && scene.zoom(0.8), "=": () => scene && scene.zoom(0.8), "-": () => scene && scene.zoom(1.25),
    Escape: () => flight !== null && press("fly"),
    "?": () => press("help"),
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
    if (feature.current) feature.draw(feature.current);
    if (scene) scene.request();
  });

  if (survey.intensity) byId("mode").append(new Option(survey.brightnessOf.toLowerCase(), "intensity"));
  if (survey.other) {
    byId("mode").append(new Option(`change ${survey.otherLater ? "until" : "since"} ${survey.otherName}`, "difference"), new Option(survey.otherName, "other"));
    document.querySelector('[data-act="beside"]').hidden = false;
  }
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
