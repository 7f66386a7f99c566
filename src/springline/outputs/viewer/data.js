// The survey: unpacked arrays, and colours of cells by palette index.

const EMPTY = -32000;

// From base64; browsers of before 2025 lack the quick way.
function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

async function loadSurvey() {
  const header = JSON.parse(document.getElementById("header").textContent);
  const element = document.getElementById("payload");
  const bytes = bytesOf(element.textContent.trim());
  element.remove();
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(stream).arrayBuffer();
  const kinds = { f8: Float64Array, f4: Float32Array, i2: Int16Array, u1: Uint8Array };
  const survey = { ...header, colours: {} };
  let offset = 0;
  for (const [name, kind, count] of header.arrays) {
    survey[name] = new kinds[kind](buffer, offset, count);
    offset += survey[name].byteLength;
  }
  survey.low = survey.start[0];
  survey.high = survey.end[survey.groups - 1];
  if (!(survey.high > survey.low)) [survey.low, survey.high] = [survey.low - 0.05, survey.high + 0.05];
  survey.sines = Float64Array.from({ length: survey.rows }, (_, k) => Math.sin((2 * Math.PI * k) / survey.rows));
  survey.cosines = Float64Array.from({ length: survey.rows }, (_, k) => Math.cos((2 * Math.PI * k) / survey.rows));
  return survey;
}

// The group at a chainage, or the nearest one.
function groupAt(survey, chainage) {
  let low = 0;
  let high = survey.groups - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (survey.start[middle] <= chainage) low = middle;
    else high = middle - 1;
  }
  const beyond = chainage - survey.end[low];
  return low + 1 < survey.groups && beyond > survey.start[low + 1] - chainage ? low + 1 : low;
}

// Radius [m] of a group's fitted section at row k, NaN where it has none.
function fittedRadius(survey, group, k) {
  const a = survey.semi_major[group];
  const b = survey.semi_minor[group];
  const phase = (2 * Math.PI * k) / survey.rows - survey.axis_bearing[group];
  return (a * b) / Math.hypot(b * Math.cos(phase), a * Math.sin(phase));
}

// Radius [m] of the drawn wall of a layer (shape, or other: the other inspection), departures exaggerated.
function wallRadius(survey, layer, group, k, exaggeration) {
  const value = survey[layer][group * survey.rows + (k % survey.rows)];
  let departure = value * survey.tick;
  // Behind a hole the fit carries the shape, so that its rim does not bend.
  if (value < EMPTY) departure = survey.semi_major[group] > 0 ? fittedRadius(survey, group, k) - survey.circle / 2 : 0;
  return survey.circle / 2 + exaggeration * departure;
}

const isSeen = (survey, group, k) => survey.shape[group * survey.rows + (k % survey.rows)] >= EMPTY;

// How far a colour speaks for its cell: departures by their size, greys of intensity alike, reasons not at all.
function weightOf(survey, colour) {
  if (colour < survey.levels) return 1 + Math.abs(colour - (survey.levels - 1) / 2);
  return colour >= survey.greys ? 1 : 0;
}

function intensityColours(survey) {
  const count = survey.palette.length - survey.greys - 1;
  const result = new Uint8Array(survey.groups * survey.rows);
  for (let cell = 0; cell < result.length; cell += 1) {
    const value = survey.shape[cell];
    if (survey.intensity[cell]) result[cell] = survey.greys + Math.round(((survey.intensity[cell] - 1) / 254) * count);
    else result[cell] = survey.reasons[value < EMPTY ? value + 32768 : 1];
  }
  return result;
}

// Palette index of every cell: a step of the scale, or the colour of the reason why there is none.
function cellColours(survey, mode) {
  if (survey.colours[mode]) return survey.colours[mode];
  if (mode === "intensity") {
    survey.colours[mode] = intensityColours(survey);
    return survey.colours[mode];
  }
  const { rows, groups, tick } = survey;
  const shape = mode === "other" ? survey.other : survey.shape;
  const half = (survey.levels - 1) / 2;
  const limit = survey.limits[mode];
  const result = new Uint8Array(groups * rows);
  for (let g = 0; g < groups; g += 1) {
    for (let k = 0; k < rows; k += 1) {
      const cell = g * rows + k;
      const value = shape[cell];
      if (value < EMPTY) {
        result[cell] = survey.reasons[value + 32768];
        continue;
      }
      let departure = value * tick;
      if (mode === "difference") {
        const before = survey.other[cell];
        if (before < EMPTY) {
          result[cell] = survey.reasons[before + 32768];
          continue;
        }
        departure = (survey.otherLater ? -1 : 1) * (departure - before * tick);
      }
      if (mode === "surface") departure += survey.circle / 2 - fittedRadius(survey, g, k);
      result[cell] = Math.round(Math.max(-1, Math.min(1, departure / limit)) * half + half);
    }
  }
  survey.colours[mode] = result;
  return result;
}

function rowAt(survey, bearing) {
  const row = Math.round((bearing / (2 * Math.PI)) * survey.rows) % survey.rows;
  return row < 0 ? row + survey.rows : row;
}

const bearingOfClock = (hours) => Math.PI / 2 - (hours * Math.PI) / 6;

function clockText(bearing) {
  const minutes = ((Math.round((3 - (bearing * 6) / Math.PI) * 60) % 720) + 720) % 720;
  return `${Math.floor(minutes / 60) || 12}:${String(minutes % 60).padStart(2, "0")}`;
}
