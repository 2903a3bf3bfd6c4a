// All pages read without this.
// Empty fields of a search stay out of the address.
for (const form of document.querySelectorAll("form[role=search], form.filters")) {
  form.addEventListener("submit", () => {
    for (const field of form.elements) {
      if (field.name && field.value === "") field.disabled = true;
    }
  });
}
// A page that comes back from the browser's memory would keep them disabled.
window.addEventListener("pageshow", () => {
  for (const field of document.querySelectorAll("form :disabled")) field.disabled = false;
});

// An exploration that goes on: the page follows it; who looks at an earlier step stays there, beside what is told of all.
const LOST_MS = 3000;
function follow(place) {
  const events = new EventSource(place.dataset.live);
  const following = !new URLSearchParams(location.search).has("step");
  let lost = 0;
  events.onopen = () => {
    clearTimeout(lost);
    lost = 0;
    if (place.dataset.lost) place.textContent = "";
    delete place.dataset.lost;
  };
  events.onmessage = (event) => {
    const now = JSON.parse(event.data);
    if (now.stop) events.close();
    renew(following, now.stop ? () => place.remove() : () => {});
  };
  // A stream ends now and then, and the browser asks again: only what lasts is worth a word.
  events.onerror = () => {
    if (events.readyState === EventSource.CLOSED) say("The server does not answer any more: load the page again.");
    else lost ||= setTimeout(() => say("The server does not answer; asking again."), LOST_MS);
  };
  function say(words) {
    place.dataset.lost = "yes";
    place.textContent = words;
  }
}

// Take what is new from the page as it is by now; again a little later where the server is away.
async function renew(following, then) {
  try {
    const answer = await fetch(location.href);
    if (!answer.ok) throw new TypeError(answer.statusText);
    const page = new DOMParser().parseFromString(await answer.text(), "text/html");
    for (const part of document.querySelectorAll("[data-part]")) {
      const other = page.querySelector(`[data-part=${part.dataset.part}]`);
      if (!other || (part.dataset.part === "step" && !following)) continue;
      if (part.getAttribute("role") === "log") {
        const lines = part.firstElementChild;
        lines.append(...[...other.firstElementChild.children].slice(lines.children.length));
      } else {
        replace(part, other);
      }
    }
    then();
  } catch {
    setTimeout(() => renew(following, then), LOST_MS);
  }
}

// Whoever is at a link by keyboard stays there.
function replace(part, other) {
  const at = part.contains(document.activeElement) ? document.activeElement.getAttribute("href") : null;
  part.replaceWith(other);
  if (at) other.querySelector(`a[href="${CSS.escape(at)}"]`)?.focus();
}
for (const place of document.querySelectorAll("[data-live]")) follow(place);

// Arrows lead from step to step.
document.addEventListener("keydown", (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || event.shiftKey || event.target.closest("input, select, textarea, audio, [tabindex]")) return;
  document.querySelector(`a[aria-keyshortcuts=${CSS.escape(event.key)}]`)?.click();
});
