// The section at the cursor: readings, fit and the circle it is judged against, seen looking forward.

const OTHER = "#9a3fb5";
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200];

class SectionView {
  constructor(survey) {
    this.survey = survey;
    this.canvas = document.querySelector("#section canvas");
    this.note = document.getElementById("section-note");
    this.values = document.getElementById("values");
    this.group = 0;
  }

  setCursor(chainage) {
    this.group = groupAt(this.survey, chainage);
    this.canvas.dataset.chainage = this.survey.chainage[this.group].toFixed(4);
    this.draw();
    this.describe(chainage);
  }

  draw() {
    const { survey, group } = this;
    const { context, width, height } = sharp(this.canvas);
    const circle = (survey.reference || survey.circle) / 2;
    const radius = 0.36 * Math.min(width, height);
    const readings = this.readings("shape");
    const factor = this.factor(readings, circle);
    const place = (r, k) => {
      const drawn = Math.min(1.36, Math.max(0, 1 + factor * (r / circle - 1))) * radius;
      return [width / 2 + drawn * survey.cosines[k % survey.rows], height / 2 - drawn * survey.sines[k % survey.rows]];
    };
    this.drawFrame(context, width, height, radius);
    const dots = (colour, values) => {
      context.fillStyle = colour;
      for (const [r, k] of values) {
        const [x, y] = place(r, k);
        context.fillRect(x - 1.2, y - 1.2, 2.4, 2.4);
      }
    };
    if (survey.other) dots(OTHER, this.readings("other"));
    dots(INK, readings);
    if (survey.semi_major[group] > 0) {
      context.strokeStyle = "#c0392b";
      context.lineWidth = 1.6;
      context.beginPath();
      for (let k = 0; k <= survey.rows; k += 1) context[k ? "lineTo" : "moveTo"](...place(fittedRadius(survey, group, k), k));
      context.stroke();
      context.lineWidth = 1;
    }
    const against = survey.reference ? `${survey.referenceKind} circle` : "circle of the mean diameter";
    this.note.textContent = `Looking forward. Dots: readings${survey.other ? `, purple those of ${survey.otherName}` : ""}; red: fit; dashed: ${against}. Departures ${factor > 1 ? `drawn ${factor} times as large` : "to scale"}. ±: 95 %.`;
  }

  readings(layer) {
    const { survey, group } = this;
    const found = [];
    for (let k = 0; k < survey.rows; k += 1) {
      const value = survey[layer][group * survey.rows + k];
      if (value >= EMPTY) found.push([survey.circle / 2 + value * survey.tick, k]);
    }
    return found;
  }

  factor(readings, circle) {
    const departures = readings.map(([r]) => Math.abs(r / circle - 1)).sort((a, b) => a - b);
    const most = departures.length ? departures[Math.floor(0.95 * (departures.length - 1))] : 0;
    return Math.max(1, ...STEPS.filter((s) => s * most <= 0.25));
  }

  drawFrame(context, width, height, radius) {
    context.strokeStyle = GRID;
    context.beginPath();
    context.moveTo(0.06 * width, height / 2);
    context.lineTo(0.94 * width, height / 2);
    context.moveTo(width / 2, 0.06 * height);
    context.lineTo(width / 2, 0.94 * height);
    context.stroke();
    context.fillStyle = SOFT;
    context.textAlign = "center";
    context.textBaseline = "middle";
    [["12", 0, -1], ["3", 1, 0], ["6", 0, 1], ["9", -1, 0]].forEach(([label, x, y]) => context.fillText(label, width / 2 + 0.48 * x * width, height / 2 + 0.48 * y * height));
    context.strokeStyle = "#6b7480";
    context.setLineDash([5, 4]);
    context.beginPath();
    context.arc(width / 2, height / 2, radius, 0, 2 * Math.PI);
    context.stroke();
    context.setLineDash([]);
  }

  describe(chainage) {
    const { survey: s, group: g } = this;
    const half = (name) => (Number.isFinite(s[`${name}_sigma`][g]) ? ` ± ${(1.96e3 * s[`${name}_sigma`][g]).toFixed(1)}` : "");
    const diameter = (name) => (Number.isFinite(s[name][g]) ? `${(1e3 * s[name][g]).toFixed(1)}${half(name)} mm` : "–");
    const percent = (value, half) => (Number.isFinite(value) ? `${(100 * value).toFixed(2)}${Number.isFinite(half) ? ` ± ${(100 * half).toFixed(2)}` : ""} %` : "–");
    const rows = [["Station", `${s.chainage[g].toFixed(3)} m`]];
    if (chainage < s.start[g] - 1e-6 || chainage > s.end[g] + 1e-6) rows.push(["", "no readings at the cursor; the nearest station is shown"]);
    if (s.status[g] > 0) rows.push(["No section", s.statusWords[s.status[g]]]);
    if (!s.speaks[g]) rows.push(["Left out of charts", "unlike its neighbours"]);
    rows.push(
      ["Largest", `${diameter("diameter_max")}${Number.isFinite(s.diameter_max_bearing[g]) ? ` at ${clockText(s.diameter_max_bearing[g])}` : ""}`],
      ["Smallest", diameter("diameter_min")],
      ["Horizontal (X)", diameter("diameter_x")],
      ["Vertical (Y)", diameter("diameter_y")],
      ["Mean (area)", diameter("diameter_area")],
      ["Ovality", Number.isFinite(s.ovality_polar_high[g]) ? `${percent(s.ovality_polar[g]).slice(0, -2)} (${(100 * s.ovality_polar_low[g]).toFixed(2)} to ${(100 * s.ovality_polar_high[g]).toFixed(2)}) %` : percent(s.ovality_polar[g])],
      ["Deflection", percent(s.deflection[g], 1.96 * s.deflection_sigma[g])],
      ["Coverage", Number.isFinite(s.coverage[g]) ? `${(100 * s.coverage[g]).toFixed(0)} %` : "–"],
    );
    if (s.joined > 1) rows.push(["Joined", `${s.joined} stations, the worst shown`]);
    fillList(this.values, rows);
  }
}
