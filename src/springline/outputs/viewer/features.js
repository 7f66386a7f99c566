// The feature at the cursor: what is known of it, and its picture, the wall around it unrolled.

class FeatureView {
  constructor(survey, go) {
    this.survey = survey;
    this.list = document.getElementById("feature-list");
    this.box = document.getElementById("feature");
    this.canvas = document.getElementById("patch");
    const name = (f) => `${f.number}. ${f.kind}, ${f.chainage.toFixed(2)} m${f.clock === null ? "" : `, ${clockText(bearingOfClock(f.clock))}`}`;
    this.list.replaceChildren(new Option(survey.features.length ? "go to …" : "none", ""), ...survey.features.map((f, k) => new Option(name(f), String(k))));
    this.list.disabled = !survey.features.length;
    this.list.addEventListener("change", () => {
      if (this.list.value !== "") go(survey.features[Number(this.list.value)].chainage);
    });
  }

  // The nearest feature within half a diameter, or none.
  setCursor(chainage) {
    const { survey } = this;
    const away = (f) => Math.abs(f.chainage - chainage);
    const near = survey.features.filter((f) => away(f) <= survey.circle / 2 + (f.length || 0) / 2).sort((a, b) => away(a) - away(b))[0];
    this.list.value = near ? String(survey.features.indexOf(near)) : "";
    this.box.hidden = !near;
    this.current = near || null;
    if (near) this.show(near);
  }

  show(feature) {
    const millimetres = (value) => (value === null ? null : `${(1e3 * value).toFixed(0)} mm`);
    const rows = [
      ["Kind", feature.kind],
      ["Chainage", `${feature.chainage.toFixed(3)}${feature.sigma > 0 ? ` ± ${(1.96 * feature.sigma).toFixed(3)}` : ""} m`],
      ["Clock", feature.clock === null ? "all round" : clockText(bearingOfClock(feature.clock))],
      ["Size", millimetres(feature.size)],
      ["Length", millimetres(feature.length)],
      ["Depth", feature.depth === null ? null : `${(1e3 * feature.depth).toFixed(1)} mm`],
      ["Confidence", feature.confidence === null ? null : feature.confidence.toFixed(2)],
      ["Seen in", feature.source],
      ["Image", feature.image],
    ];
    fillList(document.getElementById("feature-values"), rows.filter(([, value]) => value));
    this.draw(feature);
  }

  draw(feature) {
    const { survey } = this;
    const { context, width, height } = sharp(this.canvas);
    const reach = Math.max(0.75 * (feature.length || 0), 0.6 * survey.circle);
    const around = feature.clock === null ? survey.rows / 2 : Math.round((75 / 360) * survey.rows);
    const middle = feature.clock === null ? survey.rows / 4 : rowAt(survey, bearingOfClock(feature.clock));
    const colours = cellColours(survey, "surface");
    const [columns, rows] = [120, 2 * Math.floor(around)];
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [columns, rows];
    const image = picture.getContext("2d").createImageData(columns, rows);
    for (let c = 0; c < columns; c += 1) {
      const x = feature.chainage + reach * ((2 * (c + 0.5)) / columns - 1);
      const g = groupAt(survey, x);
      const inside = x >= survey.start[g] - 1e-9 && x <= survey.end[g] + 1e-9;
      for (let r = 0; r < rows; r += 1) {
        const k = (((middle - around + r) % survey.rows) + survey.rows) % survey.rows;
        const rgb = inside ? survey.palette[colours[g * survey.rows + Math.floor(k)]] : [255, 255, 255];
        image.data.set([rgb[0], rgb[1], rgb[2], 255], 4 * (r * columns + c));
      }
    }
    picture.getContext("2d").putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, 0, 0, width, height);
    document.getElementById("patch-note").textContent = `${(2 * reach).toFixed(2)} m along, ${feature.clock === null ? "all round, 12 h in the middle" : "150° of arc"}; departure from the fit.`;
  }
}

// Fill a list of terms and their descriptions.
function fillList(list, rows) {
  list.replaceChildren(...rows.flatMap(([label, value]) => {
    const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
    dt.textContent = label;
    dd.textContent = value;
    return [dt, dd];
  }));
}

function saveAs(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
