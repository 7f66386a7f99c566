// The unrolled map and the chart below it: one chainage window for both.

const GUTTER = 44;
const SERIES = {
  Diameters: {
    unit: "mm",
    factor: 1e3,
    lines: [["diameter_max", "largest", "#d55e00"], ["diameter_min", "smallest", "#0072b2"], ["diameter_x", "X", "#009e73", [7, 3]], ["diameter_y", "Y", "#b0599a", [2, 3]]],
    reference: true,
  },
  Ovality: { unit: "%", factor: 100, lines: [["ovality_polar", "polar mean, with 95 %", INK]], band: (s, g) => [s.ovality_polar_low[g], s.ovality_polar_high[g]], zero: true },
  Deflection: { unit: "%", factor: 100, lines: [["deflection", "deflection, with 95 %", INK]], band: (s, g) => [s.deflection[g] - 1.96 * s.deflection_sigma[g], s.deflection[g] + 1.96 * s.deflection_sigma[g]], zero: true },
  Losses: { unit: "%", factor: 100, lines: [["area_loss", "area", "#0072b2"], ["capacity_loss", "capacity", "#d55e00", [7, 3]]], zero: true },
  Elevation: { unit: "m", factor: 1, lines: [["elevation", "axis", INK]] },
  Gradient: { unit: "%", factor: 100, lines: [["gradient", "rising along travel", INK]] },
  Coverage: { unit: "%", factor: 100, lines: [["coverage", "used over possible readings", "#0072b2"]], zero: true },
};

class Strips {
  constructor(survey, onPick) {
    this.survey = survey;
    this.map = document.getElementById("map");
    this.chart = document.getElementById("chart");
    this.otherMap = document.getElementById("other-map");
    this.otherPicture = document.createElement("canvas");
    this.window = [survey.low, survey.high];
    this.mode = "shape";
    this.series = "Diameters";
    this.cursor = survey.low;
    this.picture = document.createElement("canvas");
    this.ruler = [];
    for (const canvas of [this.map, this.otherMap, this.chart]) this.listen(canvas, onPick);
  }

  listen(canvas, onPick) {
    let from = null;
    const chainageAt = (event) => {
      const share = (event.clientX - canvas.getBoundingClientRect().left - GUTTER) / (canvas.clientWidth - GUTTER - 8);
      return this.window[0] + share * (this.window[1] - this.window[0]);
    };
    canvas.addEventListener("pointerdown", (event) => {
      from = { x: event.clientX, window: [...this.window], moved: false };
      if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      if (Math.abs(event.clientX - from.x) > 4) from.moved = true;
      if (!from.moved) return;
      const length = from.window[1] - from.window[0];
      const shift = ((from.x - event.clientX) / (canvas.clientWidth - GUTTER - 8)) * length;
      this.setWindow(from.window[0] + shift, from.window[1] + shift);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (from && !from.moved) onPick(chainageAt(event), canvas === this.chart ? null : this.bearingAt(event, canvas));
      from = null;
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const middle = chainageAt(event);
      const factor = Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY / 400)));
      this.setWindow(middle - (middle - this.window[0]) * factor, middle + (this.window[1] - middle) * factor);
    }, { passive: false });
  }

  // Bearing grows downwards from the invert.
  bearingAt(event, canvas) {
    const share = (event.clientY - canvas.getBoundingClientRect().top - 7) / (canvas.clientHeight - 24);
    return -Math.PI / 2 + 2 * Math.PI * Math.min(1, Math.max(0, share));
  }

  setWindow(low, high) {
    const whole = this.survey.high - this.survey.low;
    const length = Math.min(whole, Math.max(high - low, Math.min(whole, this.survey.circle / 2)));
    const start = Math.min(Math.max(low, this.survey.low), this.survey.high - length);
    this.window = [start, start + length];
    this.draw();
  }

  setCursor(chainage) {
    this.cursor = chainage;
    const [low, high] = this.window;
    if (chainage < low || chainage > high) {
      const half = (high - low) / 2;
      this.setWindow(chainage - half, chainage + half);
    } else this.draw();
    this.map.dataset.chainage = this.chart.dataset.chainage = chainage.toFixed(4);
  }

  draw() {
    this.drawMap(this.map, this.picture, this.mode);
    if (!this.otherMap.hidden) this.drawMap(this.otherMap, this.otherPicture, "other");
    this.drawChart();
  }

  x(chainage, width) {
    return GUTTER + ((chainage - this.window[0]) / (this.window[1] - this.window[0])) * (width - GUTTER - 8);
  }

  drawMap(canvas, picture, mode) {
    const { context, width, height } = sharp(canvas);
    const box = { left: GUTTER, top: 7, width: width - GUTTER - 8, height: height - 24 };
    this.paint(picture, mode, Math.max(1, Math.round(box.width)));
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, box.left, box.top, box.width, box.height);
    context.strokeStyle = "#8b95a1";
    context.strokeRect(box.left, box.top, box.width, box.height);
    context.fillStyle = SOFT;
    context.textAlign = "right";
    context.textBaseline = "middle";
    [6, 3, 12, 9, 6].forEach((hour, n) => context.fillText(`${hour} h`, GUTTER - 6, box.top + (n / 4) * box.height));
    this.drawMarks(context, width, box);
    this.drawChainage(context, width, box);
  }

  // Circles where features have a place on the wall, ticks at both edges where they go all the way round.
  drawMarks(context, width, box) {
    context.strokeStyle = INK;
    context.textAlign = "left";
    for (const feature of this.survey.features) {
      const x = this.x(feature.chainage, width);
      if (x < box.left || x > box.left + box.width) continue;
      context.beginPath();
      if (feature.clock === null) {
        for (const [from, to] of [[0, 6], [box.height - 6, box.height]]) {
          context.moveTo(x, box.top + from);
          context.lineTo(x, box.top + to);
        }
      } else context.arc(x, box.top + ((((6 - feature.clock) / 12) % 1 + 1) % 1) * box.height, 8, 0, 2 * Math.PI);
      context.stroke();
    }
    context.strokeStyle = "#d50057";
    for (const point of this.ruler) {
      const [x, y] = [this.x(point.chainage, width), box.top + (((point.bearing / (2 * Math.PI) + 0.25) % 1) + 1) % 1 * box.height];
      context.beginPath();
      context.moveTo(x - 6, y);
      context.lineTo(x + 6, y);
      context.moveTo(x, y - 6);
      context.lineTo(x, y + 6);
      context.stroke();
    }
  }

  // One pixel column may hold many groups: of each row the cell furthest from none stays.
  paint(picture, mode, columns) {
    const { survey } = this;
    const { rows, start, end, palette } = survey;
    const shown = [mode, columns, ...this.window].join();
    if (picture.dataset.shown === shown) return;
    picture.dataset.shown = shown;
    const colours = cellColours(survey, mode);
    [picture.width, picture.height] = [columns, rows];
    const context = picture.getContext("2d");
    const image = context.createImageData(columns, rows);
    const step = (this.window[1] - this.window[0]) / columns;
    let group = groupAt(survey, this.window[0]);
    for (let c = 0; c < columns; c += 1) {
      const low = this.window[0] + c * step;
      while (group < survey.groups && end[group] <= low) group += 1;
      for (let k = 0; k < rows; k += 1) {
        let best = -1;
        let found = -1;
        for (let g = group; g < survey.groups && start[g] < low + step; g += 1) {
          const colour = colours[g * rows + k];
          const weight = weightOf(survey, colour);
          if (weight > best) [best, found] = [weight, colour];
        }
        // Bearing grows downwards from the invert: 6, 3, 12, 9 and 6 o'clock again.
        const pixel = 4 * (((k + (rows >> 2)) % rows) * columns + c);
        const rgb = found < 0 ? [255, 255, 255] : palette[found];
        image.data[pixel] = rgb[0];
        image.data[pixel + 1] = rgb[1];
        image.data[pixel + 2] = rgb[2];
        image.data[pixel + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
  }

  drawChainage(context, width, box) {
    context.fillStyle = SOFT;
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const [value, label] of ticksOver(...this.window, Math.max(2, box.width / 90))) {
      context.fillText(label, this.x(value, width), box.top + box.height + 4);
    }
    const at = this.x(this.cursor, width);
    if (at < box.left - 1 || at > box.left + box.width + 1) return;
    context.strokeStyle = INK;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(at, box.top);
    context.lineTo(at, box.top + box.height);
    context.stroke();
    context.lineWidth = 1;
  }

  drawChart() {
    const { context, width, height } = sharp(this.chart);
    const box = { left: GUTTER, top: 6, width: width - GUTTER - 8, height: height - 36 };
    const thinned = this.thin(Math.max(2, Math.round(box.width)));
    let [low, high] = thinned.range;
    if (!(high > low)) [low, high] = [low - 0.5, low + 0.5];
    const pad = 0.06 * (high - low);
    const y = (value) => box.top + (1 - (value - low + pad) / (high - low + 2 * pad)) * box.height;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const [value, label] of ticksOver(low, high, 4)) {
      context.strokeStyle = GRID;
      context.beginPath();
      context.moveTo(box.left, y(value));
      context.lineTo(box.left + box.width, y(value));
      context.stroke();
      context.fillStyle = SOFT;
      context.fillText(label, GUTTER - 6, y(value));
    }
    this.drawBand(context, thinned, y, box);
    for (const line of thinned.lines.reverse()) this.drawLine(context, line, y, box);
    context.strokeStyle = "#8b95a1";
    context.strokeRect(box.left, box.top, box.width, box.height);
    this.drawChainage(context, width, box);
    context.fillStyle = SOFT;
    context.fillText("Chainage [m]", box.left + box.width / 2, box.top + box.height + 18);
  }

  // Smallest and largest value of each pixel column.
  thin(columns) {
    const { survey } = this;
    const kind = SERIES[this.series];
    const [from, to] = this.window;
    const lines = kind.lines.map(([name, label, colour, dash]) => ({ name, label, colour, dash, low: new Float64Array(columns).fill(NaN), high: new Float64Array(columns).fill(NaN) }));
    const band = kind.band ? { low: new Float64Array(columns).fill(NaN), high: new Float64Array(columns).fill(NaN) } : null;
    const range = [Infinity, -Infinity];
    const put = (target, c, low, high) => {
      if (!(low <= high)) return;
      target.low[c] = low < target.low[c] || Number.isNaN(target.low[c]) ? low : target.low[c];
      target.high[c] = high > target.high[c] || Number.isNaN(target.high[c]) ? high : target.high[c];
      range[0] = Math.min(range[0], low);
      range[1] = Math.max(range[1], high);
    };
    for (let g = groupAt(survey, from); g < survey.groups && survey.start[g] < to; g += 1) {
      // Stations at joints and misread ones do not speak for the pipe, and would set the scale.
      if (!survey.speaks[g]) continue;
      const first = Math.max(0, Math.floor(((survey.start[g] - from) / (to - from)) * columns));
      const last = Math.max(first, Math.min(columns - 1, Math.ceil(((survey.end[g] - from) / (to - from)) * columns) - 1));
      for (let c = first; c <= last; c += 1) {
        for (const line of lines) put(line, c, survey[line.name][g] * kind.factor, survey[line.name][g] * kind.factor);
        if (band) put(band, c, ...kind.band(survey, g).map((v) => v * kind.factor));
      }
    }
    if (kind.zero) [range[0], range[1]] = [Math.min(0, range[0]), Math.max(0, range[1])];
    if (kind.reference && survey.reference) {
      const value = survey.reference * kind.factor;
      [range[0], range[1]] = [Math.min(value, range[0]), Math.max(value, range[1])];
      lines.push({ colour: "#6b7480", dash: [5, 4], low: new Float64Array(columns).fill(value), high: new Float64Array(columns).fill(value) });
    }
    if (range[0] === Infinity) [range[0], range[1]] = [0, 1];
    return { lines, band, range };
  }

  drawBand(context, { band }, y, box) {
    if (!band) return;
    context.fillStyle = "rgba(29, 39, 51, .16)";
    band.low.forEach((low, c) => {
      if (!Number.isNaN(low)) context.fillRect(box.left + c, y(band.high[c]), 1, Math.max(1, y(low) - y(band.high[c])));
    });
  }

  drawLine(context, line, y, box) {
    context.strokeStyle = line.colour;
    context.lineWidth = 1.4;
    context.setLineDash(line.dash || []);
    context.beginPath();
    let drawing = false;
    line.low.forEach((low, c) => {
      if (Number.isNaN(low)) {
        drawing = false;
        return;
      }
      const x = box.left + c + 0.5;
      if (drawing) context.lineTo(x, y(low));
      else context.moveTo(x, y(low));
      if (line.high[c] > low) context.lineTo(x, y(line.high[c]));
      drawing = true;
    });
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1;
  }
}
