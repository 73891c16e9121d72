// The form: fields from the grammar, which comes from the declarations of the flyer file.
import { fill, make } from "./api.js";

const STEPS = 1000;
const GIVEN = "given";

export class Form {
  constructor(place, grammar, { edit, change }) {
    this.place = place;
    this.grammar = grammar;
    this.edit = edit; // (dotted, text) when a value changes
    this.change = change; // (section, tag) when another alternative is wanted
    this.fields = new Map();
    this.ends = new Map();
  }

  // Show a document, all parts but the mission; that has a place of its own.
  show(document, tags, models) {
    this.document = document;
    this.tags = tags;
    this.models = models;
    const open = new Map([...this.place.querySelectorAll("details")].map((one) => [one.id, one.open]));
    const focused = this.place.ownerDocument.activeElement?.id;
    this.fields.clear();
    this.ends.clear();
    fill(this.place, ...this.grammar.parts.filter((part) => part.name !== "mission").map((part) => this.part(part)));
    for (const one of this.place.querySelectorAll("details")) if (open.has(one.id)) one.open = open.get(one.id);
    if (focused) this.place.ownerDocument.getElementById(focused)?.focus();
  }

  // The mission's fields, in another place.
  showMission(place, document) {
    this.document = document;
    const part = this.grammar.parts.find((one) => one.name === "mission");
    fill(place, ...this.section(part.section, "mission"));
  }

  part(part) {
    const wide = matchMedia("(min-width: 62rem)").matches;
    const content = this.document[part.name];
    const needed = part.name !== "film" || content !== undefined;
    const inside = part.base
      ? this.alternatives(part.base, part.name, part.title, needed ? "" : "none")
      : this.optional(part.section, part.name, part.title);
    const open = part.name === "flyer" || (wide && content !== undefined && part.name !== "force");
    return make("details", { id: `part-${part.name}`, open }, make("summary", {}, part.title), ...inside);
  }

  // A section that is one of several kinds.
  alternatives(base, path, title, none = "") {
    const tag = this.tags[path] ?? "";
    let known = Object.keys(this.grammar.bases[base]);
    if (path === "force" && this.models?.length) known = known.filter((one) => this.models.includes(one));
    if (tag && !known.includes(tag)) known = [tag, ...known];
    const id = `kind-${path}`;
    const choice = make("select", { id, onchange: (event) => this.change(path, event.target.value) },
      ...(none || !tag ? [make("option", { value: "", selected: !tag }, none || "choose")] : []),
      ...known.map((one) => make("option", { value: one, selected: one === tag }, one)));
    const shown = [make("div", { class: "kind" }, make("label", { for: id, class: "unseen" }, `Kind of ${title.toLowerCase()}`), choice)];
    const section = this.grammar.bases[base][tag];
    if (section && this.value(path) !== undefined) {
      const about = this.grammar.sections[section].about;
      if (about.includes(" ") && about.length > 12) shown[0].append(make("p", { class: "quiet" }, `${about[0].toUpperCase()}${about.slice(1)}.`));
      shown.push(...this.section(section, path));
    }
    return shown;
  }

  // A section that may be left out.
  optional(section, path, title) {
    if (this.value(path) === undefined) {
      return [make("button", { type: "button", class: "small", onclick: () => this.change(path, GIVEN) }, `Add ${title.toLowerCase()}`)];
    }
    return [...this.section(section, path),
      make("button", { type: "button", class: "small", onclick: () => this.change(path, "") }, `Remove ${title.toLowerCase()}`)];
  }

  // Fields of a section: those given or needed, then the others under "more".
  section(name, path, terse = false) {
    const shown = [], more = [];
    for (const field of this.grammar.sections[name].fields) {
      const dotted = `${path}.${field.name}`;
      const given = this.value(dotted) !== undefined;
      const row = this.row(field, dotted);
      (given || field.required || (field.default && !terse) ? shown : more).push(row);
    }
    if (more.length) {
      shown.push(make("details", { class: "further", id: `more-${path}` },
        make("summary", {}, `${more.length} optional`), ...more));
    }
    return shown;
  }

  row(field, dotted) {
    if (field.kind === "section") {
      const content = field.base ? this.alternatives(field.base, dotted, field.label, field.required ? "" : "none")
        : this.optional(field.section, dotted, field.label);
      return make("fieldset", { class: "inside" }, make("legend", {}, field.label), ...content);
    }
    if (field.kind === "list") return this.list(field, dotted);
    return this.simple(field, dotted);
  }

  list(field, dotted) {
    const entries = this.value(dotted) ?? [];
    const act = (change) => () => { const copy = structuredClone(entries); change(copy); this.edit(dotted, copy, true); };
    const rows = entries.map((_, index) => make("div", { class: "entry", role: "group", "aria-label": `${field.label} ${index + 1}` },
      ...this.section(field.section, `${dotted}.${index}`, true),
      make("div", { class: "moves" },
        make("button", { type: "button", class: "small", disabled: index === 0, onclick: act((copy) => copy.splice(index - 1, 0, ...copy.splice(index, 1))), "aria-label": `Move ${field.label} ${index + 1} up` }, "up"),
        make("button", { type: "button", class: "small", onclick: act((copy) => copy.splice(index, 0, structuredClone(copy[index]))), "aria-label": `Double ${field.label} ${index + 1}` }, "double"),
        make("button", { type: "button", class: "small", onclick: act((copy) => copy.splice(index, 1)), "aria-label": `Remove ${field.label} ${index + 1}` }, "remove"))));
    return make("fieldset", { class: "inside" }, make("legend", {}, field.label), ...rows,
      make("button", { type: "button", class: "small", onclick: act((copy) => copy.push({})) }, `Add to ${field.label}`),
      make("p", { class: "wrong", id: `wrong-${dotted}` }));
  }

  simple(field, dotted) {
    const id = `field-${dotted}`;
    const value = this.value(dotted);
    const given = value !== undefined && value !== null && value !== "";
    const label = make("label", { for: id }, field.label);
    const wrong = make("p", { class: "wrong", id: `wrong-${dotted}` });
    const words = [field.words, field.kind === "number" && field.range.includes("between") ? field.range : ""].filter(Boolean).join("; ");
    const help = make("p", { class: "words", id: `words-${dotted}` }, words);
    const about = { id, "aria-describedby": `words-${dotted} wrong-${dotted}`, "data-key": dotted };
    const row = make("div", { class: "field", "data-row": dotted }, label);
    if (field.kind === "choice") {
      const now = String(given ? value : "");
      row.append(make("select", { ...about, onchange: (event) => this.edit(dotted, event.target.value) },
        make("option", { value: "", selected: !given }, field.default ? `${field.default} (default)` : field.required ? "choose" : "none"),
        ...field.choices.map((one) => make("option", { value: one, selected: one === now }, one))));
    } else {
      const box = make("input", {
        ...about, type: "text", value: given ? String(value) : field.default ?? "",
        class: given ? null : "assumed", placeholder: field.required ? field.unit ?? "" : "not given",
        list: field.suggested === "material" ? "materials" : null,
        oninput: (event) => { event.target.classList.remove("assumed"); this.edit(dotted, event.target.value); },
      });
      row.append(box);
      if (field.kind === "number") {
        const slider = make("input", { type: "range", min: 0, max: STEPS, step: 1, hidden: true, "aria-label": `${field.label} (slider)`, "aria-describedby": `wrong-${dotted}`,
          oninput: (event) => this.slide(dotted, event.target) });
        slider.addEventListener("pointerdown", () => { slider.dataset.held = "1"; });
        for (const end of ["pointerup", "pointercancel", "blur"]) slider.addEventListener(end, () => { delete slider.dataset.held; this.settle(dotted); });
        row.append(slider);
        this.fields.set(dotted, { box, slider, given, row, assumed: !given, default: field.default });
      }
    }
    if (!this.fields.has(dotted)) this.fields.set(dotted, { box: row.querySelector("input, select"), row, default: field.default });
    row.append(help, wrong);
    return row;
  }

  // Ends of the sliders, as the server says; those of a slider in use stay until it is released.
  setEnds(ends) {
    for (const [dotted, one] of Object.entries(ends)) {
      const field = this.fields.get(dotted);
      if (!field?.slider) continue;
      field.next = one;
      const first = field.slider.hidden;
      const used = field.slider.dataset.held || document.activeElement === field.slider;
      if (first || !used) this.settle(dotted);
      if (this.value(dotted) === undefined && field.box !== document.activeElement && !used) field.box.value = one.text;
    }
  }

  settle(dotted) {
    const field = this.fields.get(dotted);
    const ends = field?.next;
    if (!ends || field.slider.dataset.held) return;
    const now = field.ends;
    const fits = now && unitOf(ends.text) === unitOf(field.unit) && ends.value > now.low && ends.value < now.high;
    if (!fits) { field.ends = ends; field.unit = ends.text; }
    field.slider.hidden = !(field.ends.high > field.ends.low);
    field.slider.value = Math.round(STEPS * share(ends.value, field.ends));
    field.slider.setAttribute("aria-valuetext", ends.text);
  }

  slide(dotted, slider) {
    const field = this.fields.get(dotted);
    if (!field.ends) return;
    const value = place(slider.value / STEPS, field.ends);
    const text = withNumber(field.box.value || field.next.text, value, field.ends);
    field.box.value = text;
    field.box.classList.remove("assumed");
    slider.setAttribute("aria-valuetext", text);
    this.edit(dotted, text);
  }

  // What is wrong, beside the field that it is about; returns what has no field.
  showMistakes(list) {
    for (const one of document.querySelectorAll(".field.is-wrong")) one.classList.remove("is-wrong");
    for (const one of document.querySelectorAll("[id^='wrong-']")) one.textContent = "";
    for (const one of document.querySelectorAll("[aria-invalid]")) one.removeAttribute("aria-invalid");
    for (const { key, text } of list) {
      const field = this.fields.get(key);
      const place = document.getElementById(`wrong-${key}`);
      if (place) place.textContent = text;
      if (!field) continue;
      field.row.classList.add("is-wrong");
      field.box.setAttribute("aria-invalid", "true");
      for (let outer = field.row.closest("details"); outer; outer = outer.parentElement.closest("details")) outer.open = true;
    }
  }

  // What a field is called, with the part that it stands in.
  title(dotted) {
    const label = this.fields.get(dotted)?.row.querySelector("label")?.textContent;
    return label ? `${dotted.split(".").slice(0, -1).join(" ")}, ${label}` : "";
  }

  value(dotted) {
    let here = this.document;
    for (const key of dotted.split(".")) here = here?.[key];
    return here;
  }
}

export function put(document, dotted, value) {
  const keys = dotted.split(".");
  let here = document;
  keys.slice(0, -1).forEach((key) => { here = here[key] ??= {}; });
  const last = keys.at(-1);
  if (value === "" || value === undefined) delete here[last];
  else here[last] = value;
}

function unitOf(text) { return /[A-Za-zµμ°%].*$/.exec(text.replace(/^[-+\d.]+e[-+]?\d+/i, ""))?.[0] ?? ""; }

function share(value, { low, high, logarithmic }) {
  const part = logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return Math.min(1, Math.max(0, part));
}

function place(part, { low, high, logarithmic }) {
  return logarithmic ? low * (high / low) ** part : low + part * (high - low);
}

// The text with another number in it; its unit and ± stay.
function withNumber(text, value, { low, high, logarithmic }) {
  const fine = logarithmic ? Math.abs(value) : Math.max(Math.abs(low), Math.abs(high));
  const decimals = Math.min(12, Math.max(0, 2 - Math.floor(Math.log10(fine || 1))));
  let number = value.toFixed(decimals + (logarithmic ? 0 : 1));
  if (number.includes(".")) number = number.replace(/\.?0+$/, "");
  if (fine >= 1e6 || fine < 1e-6) number = Number(value.toPrecision(4)).toString();
  return text.replace(/^\s*[-+]?[\d.]+(?:[eE][-+]?\d+)?/, number);
}
