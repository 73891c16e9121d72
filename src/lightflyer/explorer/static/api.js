// Questions to the server. Nothing of an answer is ever taken for markup.

export async function get(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer.json();
}

export async function ask(name, content, signal) {
  try {
    const answer = await fetch(`api/${name}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(content),
      signal,
    });
    return await answer.json();
  } catch (error) {
    if (error.name === "AbortError") throw error;
    return { lost: true, errors: [{ key: "", text: "The explorer does not answer: is it still running in its terminal?" }] };
  }
}

// A job: steps are told as they come, the last line is the result.
export async function work(name, content, signal, tell) {
  const answer = await fetch(`api/job/${name}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(content),
    signal,
  });
  if (!answer.ok) return answer.json();
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "", last = {};
  for (;;) {
    const { value, done } = await reader.read();
    if (done) break;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines) {
      last = JSON.parse(line);
      if ("doing" in last) tell(last);
    }
  }
  return last;
}

export async function save(what, content) {
  const answer = await fetch(`api/download/${what}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(content),
  });
  if (!answer.ok) return answer.json();
  const name = /filename="([^"]*)"/.exec(answer.headers.get("Content-Disposition") || "");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name ? name[1] : what;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  return {};
}

// An element with attributes and children; texts are texts.
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function at(id) { return document.getElementById(id); }

export function fill(element, ...children) { element.replaceChildren(...children); }

export function digits(number, count = 4) {
  return Number(number.toPrecision(count)).toString();
}
