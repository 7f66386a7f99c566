// Corrections by a person, collected here and saved as overrides.toml, which `springline inspect --overrides` applies.

const FIELDS = {
  mask: ["from_m", "to_m", "from_clock", "to_clock"],
  remove: ["kind", "chainage_m", "clock_h"],
  relabel: ["kind", "chainage_m", "clock_h", "to"],
  add: ["kind", "chainage_m", "clock_h", "size_mm", "length_mm", "depth_mm"],
  datum: ["at_m", "chainage_m", "easting_m", "northing_m", "elevation_m"],
};
const OPTIONAL = new Set(["from_clock", "to_clock", "clock_h", "size_mm", "length_mm", "depth_mm", "easting_m", "northing_m", "elevation_m"]);
const WORDS = new Set(["kind", "to"]);
const FIELD_LABELS = {
  from_m: "From chainage [m]", to_m: "To chainage [m]", from_clock: "From clock [h], clockwise", to_clock: "To clock [h]",
  kind: "Kind", to: "New kind", chainage_m: "Chainage [m]", clock_h: "Clock [h]", size_mm: "Size [mm]", length_mm: "Length [mm]",
  depth_mm: "Depth [mm], outward positive", at_m: "Where the survey says [m]", easting_m: "Easting [m]", northing_m: "Northing [m]", elevation_m: "Elevation [m]",
};

// A basic string of TOML 1.0: quotes, backslashes and control characters escaped.
function tomlText(text) {
  const escaped = text.replace(/[\\"\u0000-\u001f\u007f]/g, (c) => (c === "\\" || c === '"' ? `\\${c}` : `\\u${c.charCodeAt(0).toString(16).padStart(4, "0")}`));
  return `"${escaped}"`;
}

function tomlOf(corrections) {
  return corrections.map(({ action, values, signed }) => [
    `[[${action}]]`,
    ...Object.entries(values).map(([key, value]) => `${key} = ${WORDS.has(key) ? tomlText(value) : Number.isInteger(value) ? value.toFixed(1) : value}`),
    `author = ${tomlText(signed.author)}`,
    `date = ${signed.date}`,
    `reason = ${tomlText(signed.reason)}`,
    "",
  ].join("\n")).join("\n");
}

class Corrections {
  // `where` returns { chainage, clock, feature, measured } of the moment, to fill the form with.
  constructor(where) {
    this.where = where;
    this.list = [];
    this.dialog = document.getElementById("correct");
    this.form = document.getElementById("correct-form");
    this.action = document.getElementById("correct-action");
    this.fields = document.getElementById("correct-fields");
    this.action.addEventListener("change", () => this.offer());
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.add();
    });
    document.getElementById("correct-save").addEventListener("click", () => saveAs(new Blob([this.text()], { type: "application/toml" }), "overrides.toml"));
    document.getElementById("correct-close").addEventListener("click", () => this.dialog.close());
    this.form.elements.date.value = new Date().toISOString().slice(0, 10);
    this.refresh();
  }

  open() {
    this.offer();
    this.dialog.showModal();
  }

  offer() {
    const { chainage, feature, measured } = this.where();
    const clock = feature && feature.clock !== null ? feature.clock.toFixed(2) : "";
    const [from, to] = measured.length === 2 ? measured.map((p) => p.chainage).sort((a, b) => a - b) : [chainage, chainage];
    const at = (feature ? feature.chainage : chainage).toFixed(3);
    const filled = { from_m: from.toFixed(3), to_m: to.toFixed(3), kind: feature ? feature.kind : "", chainage_m: at, clock_h: clock, at_m: chainage.toFixed(3) };
    if (this.action.value === "add") Object.assign(filled, { kind: "", chainage_m: chainage.toFixed(3), clock_h: "" });
    this.fields.replaceChildren(...FIELDS[this.action.value].map((key) => {
      const label = document.createElement("label");
      const input = document.createElement("input");
      input.name = key;
      input.value = filled[key] || "";
      input.required = !OPTIONAL.has(key);
      if (!WORDS.has(key)) input.inputMode = "decimal";
      label.append(`${FIELD_LABELS[key]}${OPTIONAL.has(key) ? ", if any" : ""}`, input);
      return label;
    }));
  }

  add() {
    const values = {};
    for (const input of this.fields.querySelectorAll("input")) {
      const text = input.value.trim();
      const value = WORDS.has(input.name) ? text : Number.parseFloat(text.replace(",", "."));
      if (text === "") continue;
      const wrong = !WORDS.has(input.name) && !Number.isFinite(value);
      input.setCustomValidity(wrong ? "a number is needed" : "");
      if (wrong) {
        input.reportValidity();
        input.addEventListener("input", () => input.setCustomValidity(""), { once: true });
        return;
      }
      values[input.name] = value;
    }
    const { author, date, reason } = this.form.elements;
    this.list.push({ action: this.action.value, values, signed: { author: author.value.trim(), date: date.value, reason: reason.value.trim() } });
    reason.value = "";
    this.refresh();
  }

  text() {
    return tomlOf(this.list);
  }

  refresh() {
    document.getElementById("correct-list").replaceChildren(...this.list.map((one, k) => {
      const item = document.createElement("li");
      const drop = document.createElement("button");
      drop.type = "button";
      drop.textContent = "Take back";
      drop.addEventListener("click", () => {
        this.list.splice(k, 1);
        this.refresh();
      });
      item.append(`${one.action}: ${Object.entries(one.values).map(([key, value]) => `${key} ${value}`).join(", ")}. ${one.signed.reason} `, drop);
      return item;
    }));
    document.getElementById("correct-save").disabled = !this.list.length;
  }
}
