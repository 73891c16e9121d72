// Figures that take a while, each in a tab: computed when it is looked at, stopped when outdated.
import { at, digits, fill, make, save, work } from "./api.js";
import { frame } from "./figures.js";

const TABS = [
  ["map", "Map of payload"], ["models", "Force models"], ["film", "Film"],
  ["sensitivity", "Sensitivity"], ["mission", "Mission"], ["pins", "Pinned designs"], ["files", "Files and Python"],
];
const FEW = 2; // notes that stand open
const JOBS = new Set(["map", "models", "film", "sensitivity"]);

export class Tabs {
  constructor(explorer) {
    this.explorer = explorer;
    this.active = "map";
    this.choices = {};
    this.panels = new Map();
    this.fresh = new Map(); // version of the design that a figure shows
    for (const [name, title] of TABS) this.add(name, title);
    at("tabs").addEventListener("keydown", (event) => this.key(event));
    this.select("map", false);
  }

  add(name, title) {
    const tab = make("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `panel-${name}`,
      onclick: () => this.select(name) }, title);
    const panel = make("div", { role: "tabpanel", id: `panel-${name}`, "aria-labelledby": `tab-${name}`, hidden: true, tabindex: 0 });
    this.panels.set(name, { tab, panel });
    at("tabs").append(tab);
    at("panels").append(panel);
    this[`build_${name}`]?.(panel);
    if (JOBS.has(name) || name === "mission") this.figure(panel, name, title);
    if (name === "mission") this.build_track(panel);
  }

  figure(panel, name, title) {
    panel.append(
      make("p", { class: "wrong", id: `job-wrong-${name}` }),
      make("progress", { id: `job-${name}`, max: 1, hidden: true, "aria-label": `Progress of ${title.toLowerCase()}` }),
      make("p", { class: "quiet", id: `job-doing-${name}`, role: "status" }));
    this.plot(panel, name, title);
    panel.append(make("details", { class: "notes", id: `job-notes-${name}`, hidden: true }, make("summary"),
      make("ul", { class: "warnings", id: `job-warnings-${name}` })));
  }

  plot(panel, name, title) {
    const figure = make("figure", { "data-figure": name }, make("figcaption", {}, make("h3", {}, title)));
    panel.append(figure);
    frame(figure, (what) => this.download(what), { tall: ["map", "sensitivity", "track"].includes(name), said: true });
  }

  build_map(panel) {
    panel.append(make("div", { class: "chooser" },
      make("label", {}, "Over ", make("select", { id: "map-over", onchange: (event) => this.choose("over", event.target.value, "map") })),
      make("button", { type: "button", id: "to-optimum", disabled: true, onclick: () => this.explorer.goTo(...this.optimum) }, "Go to the optimum"),
      make("span", { class: "quiet" }, "Click a point of the map to go there.")));
  }

  build_sensitivity(panel) {
    panel.append(make("div", { class: "chooser" }, make("label", {}, "Of the ",
      make("select", { id: "sensitive", onchange: (event) => this.choose("output", event.target.value, "sensitivity") }))));
  }

  build_mission(panel) {
    panel.append(
      make("p", { class: "quiet" }, "A flight through day and night: altitude over time, and what ends it."),
      make("div", { id: "mission-fields" }),
      make("div", { class: "buttons" },
        make("button", { type: "button", id: "mission-add", onclick: () => this.explorer.change("mission", "given") }, "Add a mission"),
        make("button", { type: "button", id: "mission-fly", class: "primary", onclick: () => this.compute("mission") }, "Fly"),
        make("button", { type: "button", id: "mission-remove", onclick: () => this.explorer.change("mission", "") }, "Remove the mission")));
  }

  build_track(panel) {
    panel.append(make("label", { class: "time", id: "mission-when", hidden: true }, "Time",
      make("input", { type: "range", id: "mission-time", min: 0, value: 0, oninput: (event) => this.showMoment(+event.target.value) }),
      make("output", { id: "mission-moment", for: "mission-time" })));
    this.plot(panel, "track", "Ground track");
  }

  build_pins(panel) {
    panel.append(make("p", { class: "quiet", id: "pins-words" }),
      make("div", { class: "scroll", tabindex: 0, role: "group", "aria-label": "Pinned designs" }, make("table", { id: "pins-table", class: "numbers" })));
  }

  build_files(panel) {
    const button = (what, text) => make("button", { type: "button", onclick: () => this.download(what) }, text);
    panel.append(
      make("p", { class: "quiet" }, "The flyer file gives the same numbers on the command line, to the last digit; so do the lines of Python. The address of this page holds the design, too."),
      make("div", { class: "buttons" }, button("toml", "Flyer file (TOML)"), button("csv", "Table (CSV)"), button("netcdf", "Dataset (NetCDF)"),
        button("python", "Python file"), make("button", { type: "button", id: "mission-file", onclick: () => this.download("mission.toml") }, "Mission file (TOML)"),
        make("button", { type: "button", onclick: () => this.copy(location.href, "the address") }, "Copy the address")),
      make("p", { class: "wrong", id: "files-wrong", role: "alert" }),
      make("p", { class: "quiet", id: "files-said", role: "status" }),
      make("div", { class: "pair" },
        make("div", {}, make("h3", {}, "Python"), make("pre", { id: "python", tabindex: 0, role: "region", "aria-label": "Lines of Python" })),
        make("div", {}, make("h3", {}, "Flyer file"), make("pre", { id: "toml", tabindex: 0, role: "region", "aria-label": "Flyer file" }))));
  }

  select(name, focus = true) {
    this.active = name;
    for (const [one, { tab, panel }] of this.panels) {
      tab.setAttribute("aria-selected", one === name);
      tab.tabIndex = one === name ? 0 : -1;
      panel.hidden = one !== name;
    }
    if (focus) this.panels.get(name).tab.focus();
    if (this.explorer.url !== undefined) this.explorer.address(this.explorer.url);
    this.refresh();
  }

  // What is looked at, for the address; taken from one by "look".
  looked() {
    const chosen = Object.entries(this.choices).filter(([, value]) => value).map(([name, value]) => `,${name}:${value}`);
    return this.active === "map" && !chosen.length ? "" : `&looks=${this.active}${chosen.join("")}`;
  }

  look(text) {
    const [name, ...chosen] = text.split(",");
    this.flown = true; // the address says what to look at, not the design
    this.choices = Object.fromEntries(chosen.map((one) => one.split(":")).filter(([key]) => ["over", "output"].includes(key)));
    if (this.panels.has(name)) this.select(name, false);
  }

  key(event) {
    const names = TABS.map(([name]) => name), here = names.indexOf(this.active);
    const next = { ArrowRight: here + 1, ArrowLeft: here - 1, Home: 0, End: names.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.select(names[(next + names.length) % names.length]);
  }

  // The design has come to rest, or another tab is shown.
  refresh() {
    if (JOBS.has(this.active) && this.explorer.version && this.fresh.get(this.active) !== this.explorer.version) this.compute(this.active);
  }

  choose(choice, value, name) {
    this.choices[choice] = value;
    this.explorer.address(this.explorer.url);
    this.compute(name);
  }

  stop() { this.running?.abort(); }

  // The design has moved on: what is drawn is of an earlier one.
  outdate() {
    for (const name of this.fresh.keys()) this.mark(name, true);
  }

  mark(name, outdated) {
    for (const figure of at(`panel-${name}`).querySelectorAll("figure")) figure.classList.toggle("outdated", outdated);
  }

  // The figures are new, for other surroundings.
  clear() { this.fresh.clear(); }

  async compute(name) {
    if (this.explorer.wrong) return;
    this.running?.abort();
    const mine = this.running = new AbortController();
    const version = this.explorer.version;
    const bar = at(`job-${name}`), doing = at(`job-doing-${name}`), wrong = at(`job-wrong-${name}`);
    bar.hidden = false;
    bar.removeAttribute("value");
    doing.textContent = "computing…";
    wrong.textContent = "";
    const tell = ({ doing: what, share }) => {
      doing.textContent = `${what}…`;
      if (share === null) bar.removeAttribute("value"); else bar.value = share;
    };
    try {
      const last = await work(name, { document: this.explorer.document, choices: this.choices }, mine.signal, tell);
      if (last.errors) wrong.textContent = last.errors.map((one) => one.text).join("; ");
      if (last.result) { this.fresh.set(name, version); this.show(name, last.result); }
      doing.textContent = "";
    } catch (error) {
      if (error.name !== "AbortError") {
        wrong.textContent = error instanceof TypeError ? "the explorer does not answer: is it still running in its terminal?" : String(error);
        console.error(error);
      }
      doing.textContent = "";
    }
    if (this.running === mine) { bar.hidden = true; this.running = null; }
    else if (!this.running) bar.hidden = true;
  }

  show(name, result) {
    const figure = document.querySelector(`[data-figure="${name}"]`);
    this.mark(name, this.fresh.get(name) !== this.explorer.version);
    if (result.factors) figure.querySelector(".plot").classList.toggle("tall", result.factors.length > 6);
    this.explorer.figures.put(name, result);
    const warnings = result.warnings ?? [];
    const notes = at(`job-notes-${name}`);
    notes.hidden = warnings.length === 0;
    notes.open = warnings.length <= FEW;
    notes.querySelector("summary").textContent = `Where this holds: ${warnings.length} ${warnings.length === 1 ? "note" : "notes"}`;
    fill(at(`job-warnings-${name}`), ...warnings.map((text) => make("li", {}, text)));
    if (name === "map") {
      this.map = result;
      this.optimum = [result.best[0] * result.across, result.best[1] * result.up];
      at("to-optimum").disabled = false;
      fill(at("map-over"), ...result.numbers.map((one) => make("option", { value: one, selected: one === result.over }, one.replaceAll("_", " ").replaceAll(".", " "))));
    }
    if (name === "mission") {
      this.flight = result;
      this.explorer.figures.put("track", result.track);
      const last = result.track.latitude.length - 1;
      Object.assign(at("mission-time"), { max: last, value: last });
      at("mission-when").hidden = false;
      this.showMoment(last);
    }
    if (name === "sensitivity") {
      fill(at("sensitive"), ...Object.entries(result.outputs).map(([key, words]) => make("option", { value: key, selected: key === result.output }, words)));
    }
  }

  // Where the flyer is at a moment, in both figures and in words.
  showMoment(number) {
    const { sources: { curve }, track } = this.flight, way = track.sources.curve;
    const latitude = track.latitude[number], now = (x, y) => ({ sources: { now: { x: [x], y: [y] } } });
    this.explorer.figures.put("mission", now(curve.x[number], curve.y[number]));
    this.explorer.figures.put("track", now(way.x[number], latitude));
    const longitude = (way.x[number] + 540) % 360 - 180, degrees = (value, sides) => `${digits(Math.abs(value))}° ${sides[+(value < 0)]}`;
    at("mission-moment").textContent = `${way.utc[number]}: ${digits(curve.y[number])} km, ${degrees(latitude, "NS")}, `
      + `${degrees(longitude, "EW")}, light ${digits(curve.light[number])} W/m², flyer ${digits(curve.temperature[number])} K`;
  }

  showMission(form, document) {
    const given = document.mission !== undefined;
    if (given && !this.flown) { this.flown = true; this.select("mission", false); }
    if (given) form.showMission(at("mission-fields"), document); else fill(at("mission-fields"));
    at("mission-add").hidden = given;
    at("mission-fly").hidden = at("mission-remove").hidden = !given;
    at("mission-file").hidden = !given;
  }

  showPins({ results, differences, warnings }, colours, remove) {
    const count = results.length - 1;
    at("pins-words").textContent = count
      ? `Highlighted: what differs from the design on the left. ${warnings.join(" ")}`
      : "Nothing is pinned. “Pin this design” keeps the present design beside those to come, up to four.";
    if (!count) { fill(at("pins-table")); return; }
    const heads = [make("td", {}), make("th", { scope: "col" }, "this design")];
    for (let index = 0; index < count; index++) {
      const head = make("th", { scope: "col", class: "pinned" }, `pin ${index + 1} `,
        make("button", { type: "button", class: "small", "aria-label": `Remove pin ${index + 1}`, onclick: () => remove(index) }, "×"));
      head.style.borderBottomColor = colours[index];
      heads.push(head);
    }
    const row = (label, values) => make("tr", {}, make("th", { scope: "row" }, label),
      ...values.map((value, index) => make("td", { class: index && value !== values[0] ? "differs" : null }, value)));
    const readings = results[0].map((reading, index) => row(reading.label.replace(/, at .*/, ""),
      results.map((one) => (one.find((other) => other.name === reading.name) ?? one[index])?.text ?? "–")));
    fill(at("pins-table"), make("thead", {}, make("tr", {}, ...heads)),
      make("tbody", {}, ...readings, ...differences.map(({ key, values }) => row(key.replaceAll(".", " ").replaceAll("_", " "), values))));
  }

  async download(what) {
    at("files-wrong").textContent = "";
    const answer = await save(what, { document: this.explorer.document, choices: this.choices });
    if (answer.errors) {
      const text = answer.errors.map((one) => one.text).join("; ");
      at("files-wrong").textContent = text;
      this.explorer.say(text);
    }
  }

  async copy(text, what) {
    try { await navigator.clipboard.writeText(text); at("files-said").textContent = `${what} is copied`; }
    catch { at("files-said").textContent = "the browser does not let this page copy: copy it from the address bar"; }
  }
}

export function goText(value, unit) { return `${digits(value)} ${unit}`.trim(); }
