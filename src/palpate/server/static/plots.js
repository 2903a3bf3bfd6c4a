// A plot stands in the page as a picture, which is all that one needs to read it. When somebody turns to it, it becomes
// a figure that one can zoom; nothing of that is loaded before.
const { nonce, dataset: { bokeh } } = document.currentScript;
const dark = matchMedia("(prefers-color-scheme: dark)");
const DWELL_MS = 200;
let loading;

// BokehJS makes style elements: each is given the word by which the page knows what is its own.
function loadBokeh() {
  loading ??= new Promise((done, fail) => {
    const make = document.createElement.bind(document);
    document.createElement = (name, options) => {
      const made = make(name, options);
      if (name === "style") made.nonce = nonce;
      return made;
    };
    const script = make("script");
    script.src = bokeh;
    script.onload = () => { Bokeh.set_log_level("warn"); done(); };
    script.onerror = () => { loading = undefined; fail(new Error("the plot's program cannot be loaded")); };
    document.head.append(script);
  });
  return loading;
}

// A point that leads somewhere does so here too.
function followLinks(views) {
  for (const view of views) {
    for (const source of view.model.select_one ? view.model.references() : []) {
      if (source.type !== "ColumnDataSource" || !source.data.link) continue;
      const { indices } = source.selected.properties;
      indices.change.connect(() => {
        const [first] = source.selected.indices;
        if (first !== undefined) location.href = source.data.link[first];
      });
    }
  }
}

async function draw(place) {
  const address = `${place.frame.dataset.figure}${place.frame.dataset.figure.includes("?") ? "&" : "?"}dark=${dark.matches}`;
  const [answer] = await Promise.all([fetch(address), loadBokeh()]);
  if (!answer.ok) throw new Error(`the plot cannot be had: ${answer.status}`);
  const item = await answer.json();
  const host = document.createElement("div");
  host.className = "figure";
  host.setAttribute("role", "group");
  host.setAttribute("aria-label", place.picture.getAttribute("aria-label"));
  place.views?.clear();
  place.host?.remove();
  place.picture.after(host);
  place.host = host;
  place.views = await Bokeh.embed.embed_item(item, host);
  followLinks(place.views);
}

async function turn(place, on) {
  if (place.busy || on === place.on) return;
  place.busy = true;
  place.button.textContent = "Loading …";
  try {
    if (on) await draw(place);
    place.on = on;
    place.frame.classList.toggle("live", on);
  } catch (error) {
    place.frame.dataset.fault = error.message;
  }
  place.busy = false;
  place.button.setAttribute("aria-pressed", String(place.on));
  place.button.textContent = place.frame.dataset.fault ?? (place.on ? "Picture" : "Zoom");
}

function prepare(frame) {
  const place = { frame, picture: frame.querySelector("svg.plot"), button: document.createElement("button"), on: false };
  place.button.type = "button";
  place.button.className = "quiet zoom";
  place.button.textContent = "Zoom";
  place.button.setAttribute("aria-pressed", "false");
  place.button.addEventListener("click", () => { delete frame.dataset.fault; turn(place, !place.on); });
  place.picture.before(place.button);
  let waiting;
  place.picture.addEventListener("pointerenter", (event) => {
    if (event.pointerType === "mouse") waiting = setTimeout(() => turn(place, true), DWELL_MS);
  });
  place.picture.addEventListener("pointerleave", () => clearTimeout(waiting));
  dark.addEventListener("change", () => { if (place.on) draw(place); });
}
for (const frame of document.querySelectorAll("[data-figure]")) prepare(frame);
