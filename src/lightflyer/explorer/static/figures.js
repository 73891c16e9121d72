// Figures: made once by Bokeh, then changed in place.
import { get, make } from "./api.js";

const BYNAME = new Map();
const NULLABLE = new Set(["number", "object"]);

function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export class Figures {
  constructor() { this.kind = null; this.data = new Map(); this.onTap = null; this.dark = new Map(); this.made = new WeakMap(); }

  // Make all figures for a kind of surroundings; says whether they are new, and empty.
  async prepare(logarithmic) {
    const kind = logarithmic ? "logarithmic" : "linear";
    if (this.kind === kind) return false;
    this.data.clear(); // altitudes do not fit on an axis of pressure
    if (!BYNAME.has(kind)) BYNAME.set(kind, await get(`api/panes/${kind}`));
    this.kind = kind;
    this.plots = new Map();
    this.places = new Map();
    for (const [name, item] of Object.entries(structuredClone(BYNAME.get(kind)))) {
      const place = document.querySelector(`[data-figure="${name}"] .plot`);
      if (!place) continue;
      place.replaceChildren();
      place.classList.add("empty");
      item.target_id = null;
      item.root_id ??= item.doc.roots[0].id;
      const views = await Bokeh.embed.embed_item(item, place);
      const roots = views.roots ?? [...views];
      this.plots.set(name, roots[0].model);
      this.places.set(name, place);
    }
    this.plots.get("map")?.on_event("tap", (event) => this.onTap?.(event.x, event.y));
    this.dress();
    return true;
  }

  // Colours of text, axes and ground, light or dark.
  dress() {
    if (!this.plots) return;
    for (const plot of this.plots.values()) this.recolour(plot);
    for (const [name, data] of this.data) this.put(name, data);
    const [ink, quiet, card, grid] = ["--ink", "--quiet", "--card", "--grid"].map(color);
    const size = `${Math.round(0.8 * parseFloat(getComputedStyle(document.documentElement).fontSize))}px`;
    for (const plot of this.plots.values()) {
      plot.setv({ background_fill_color: card, border_fill_color: card });
      for (const part of [...plot.below, ...plot.left, ...plot.right, ...plot.center]) {
        const kind = part.type ?? part.constructor.__name__ ?? "";
        if (kind.endsWith("Axis")) {
          part.setv({
            axis_label_text_font_size: size, major_label_text_font_size: size, axis_label_text_color: ink, major_label_text_color: quiet, axis_line_color: quiet,
            major_tick_line_color: quiet, minor_tick_line_color: null,
          });
        } else if (kind.endsWith("Grid")) {
          part.setv({ grid_line_color: grid });
        } else if (kind.endsWith("ColorBar")) {
          part.setv({ background_fill_color: card, major_label_text_color: quiet, major_label_text_font_size: size });
        }
      }
    }
  }

  // The page's colour of one that the package draws with.
  shade(colour) {
    const isDark = document.documentElement.dataset.theme === "dark";
    return isDark ? this.dark.get(String(colour).toLowerCase()) ?? colour : colour;
  }

  // Lines and areas keep what they were made with, and show its shade.
  recolour(plot) {
    for (const { glyph } of plot.renderers) {
      if (!glyph) continue;
      const own = this.made.get(glyph) ?? {};
      this.made.set(glyph, own);
      for (const part of ["line_color", "fill_color"]) {
        const value = glyph[part]?.value ?? glyph[part];
        own[part] ??= typeof value === "string" && value.startsWith("#") ? value : null;
        if (own[part]) glyph.setv({ [part]: this.shade(own[part]) });
      }
    }
  }

  // Put data into a figure; what they do not name stays.
  put(name, data) {
    const before = this.data.get(name) ?? {};
    const kept = { ...before, ...data, sources: { ...before.sources, ...data.sources } };
    this.data.set(name, kept);
    const plot = this.plots?.get(name);
    if (!plot) return;
    const find = (wanted) => plot.document.get_model_by_name(wanted);
    for (const [source, columns] of Object.entries(data.sources ?? {})) {
      const found = find(source);
      if (found) found.data = Object.fromEntries(Object.entries(columns).map(([key, column]) => [key, key === "colour" ? column.map((one) => this.shade(one)) : numbers(column)]));
    }
    if (data.x) plot.x_range.setv({ start: data.x[0], end: data.x[1] });
    if (data.factors) plot.y_range.factors = data.factors;
    else if (data.y) plot.y_range.setv({ start: data.y[0], end: data.y[1] });
    if (data.labels) {
      find("x-axis").axis_label = data.labels[0];
      find("y-axis").axis_label = data.labels[1];
    }
    if (data.tips) {
      const tips = JSON.stringify(data.tips); // set anew they would flicker
      if (tips !== before.told) { find("hover").tooltips = data.tips; kept.told = tips; }
    }
    if (data.colours) {
      find("colours").setv({ low: data.colours.low, high: data.colours.high });
    }
    if (data.legend || data.words) this.explain(name, kept);
    this.places.get(name).classList.remove("empty");
  }

  // Legend and words beside a figure.
  explain(name, data) {
    const figure = document.querySelector(`[data-figure="${name}"]`);
    const place = figure.querySelector(".plot");
    place.setAttribute("role", "img");
    place.setAttribute("aria-label", data.words ?? "");
    figure.querySelector(".legend").replaceChildren(...(data.legend ?? []).map((line) => entry({ ...line, colour: this.shade(line.colour) })));
    const words = figure.querySelector(".said");
    if (words) words.textContent = data.words ?? "";
  }
}

// JSON has no NaN: null stands for it. Texts and nested columns stay what they are.
function numbers(column) {
  if (column.length === 0 || !NULLABLE.has(typeof column[0])) return column;
  if (Array.isArray(column[0])) return column.map(numbers);
  if (column.some((value) => value !== null && typeof value !== "number")) return column;
  return Float64Array.from(column, (value) => (value === null ? NaN : value));
}

const MARKS = { cross: "M8 5H18M13 0V10", star: "M13 0L14.5 3.6L18 3.8L15.3 6.1L16.2 10L13 7.8L9.8 10L10.7 6.1L8 3.8L11.5 3.6Z" };
const DASHES = { dashed: "6 4", dotted: "2 3", dashdot: "7 3 2 3", dotdash: "2 3 7 3" };

function entry(line) {
  const space = "http://www.w3.org/2000/svg";
  const sample = document.createElementNS(space, "svg");
  sample.setAttribute("viewBox", "0 0 26 10");
  sample.setAttribute("aria-hidden", "true");
  const stroke = document.createElementNS(space, "path");
  stroke.setAttribute("d", MARKS[line.dash] ?? "M0 5H26");
  stroke.setAttribute("stroke", line.colour);
  stroke.setAttribute("stroke-width", { area: "10", star: "0" }[line.dash] ?? "3");
  stroke.setAttribute("fill", line.dash === "star" ? line.colour : "none");
  if (line.dash === "area") stroke.setAttribute("stroke-opacity", "0.4");
  if (DASHES[line.dash]) stroke.setAttribute("stroke-dasharray", DASHES[line.dash]);
  sample.append(stroke);
  return make("li", {}, sample, line.label);
}

// What surrounds a plot: legend, words, files.
export function frame(figure, download, { tall = false, said = false } = {}) {
  const name = figure.dataset.figure;
  const title = figure.querySelector("h3").textContent;
  const files = make("span", { class: "files" }, ...["png", "svg"].map((ending) => make("button", {
    type: "button", class: "small", onclick: () => download(`${name}.${ending}`),
    "aria-label": `${title} as ${ending.toUpperCase()}`,
  }, ending.toUpperCase())));
  figure.querySelector("figcaption").append(files);
  figure.append(make("ul", { class: "legend" }), make("div", { class: tall ? "plot tall empty" : "plot empty" }));
  if (said) figure.append(make("p", { class: "said quiet" }));
}
