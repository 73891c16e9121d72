/* Two published flyers beside each other. The address holds which: #first&second. */
(function () {
  "use strict";

  const section = document.getElementById("lf-pair");
  if (!section) return;
  const flyers = JSON.parse(section.dataset.flyers);
  const choices = [0, 1].map((at) => document.getElementById(`lf-pair-${at}`));
  const LINK = "#pair:";

  function cell(tag, content) {
    const made = document.createElement(tag);
    made.append(content);
    return made;
  }

  function row(title, contents) {
    const made = document.createElement("tr");
    const head = cell("th", title);
    head.scope = "row";
    made.append(head, ...contents.map((content) => cell("td", content)));
    return made;
  }

  function drawing(flyer) {
    const template = section.querySelector(`template[data-kind="${flyer.kind}"]`);
    return template.content.cloneNode(true);
  }

  function link(flyer) {
    const made = cell("a", "its page");
    made.href = flyer.page;
    return made;
  }

  function show() {
    const pair = choices.map((choice) => flyers[choice.value]);
    const rows = pair[0].rows.map(([title], at) =>
      row(title, pair.map((flyer) => flyer.rows[at][1])));
    document.getElementById("lf-pair-rows").replaceChildren(
      row("drawing", pair.map(drawing)), ...rows, row("more", pair.map(link)));
  }

  function start() {
    const wanted = location.hash.startsWith(LINK) ? location.hash.slice(LINK.length).split("&") : [];
    choices.forEach((choice, at) => {
      const named = flyers.findIndex(({ name }) => name === wanted[at]);
      choice.value = named < 0 ? at * 6 : named;
      choice.addEventListener("change", () => {
        show();
        const names = choices.map((one) => flyers[one.value].name);
        window.history.replaceState(null, "", LINK + names.join("&"));
      });
    });
    show();
    if (wanted.length) section.scrollIntoView({ behavior: "instant" });
  }

  start();
})();
