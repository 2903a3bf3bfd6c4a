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

// An exploration that goes on: the page follows it, unless somebody looks at an earlier step.
function follow(place) {
  const events = new EventSource(place.dataset.live);
  events.onmessage = async (event) => {
    const now = JSON.parse(event.data);
    if (new URLSearchParams(location.search).has("step")) {
      place.textContent = now.stop ? "It has ended." : `It goes on: ${now.lines} steps by now.`;
    } else {
      const page = new DOMParser().parseFromString(await (await fetch(location.href)).text(), "text/html");
      for (const part of document.querySelectorAll("[data-part]")) {
        const other = page.querySelector(`[data-part=${part.dataset.part}]`);
        if (other) part.replaceWith(other);
      }
      place.textContent = now.stop ? `It ended because ${now.stop}.` : `Step ${now.lines} has come.`;
    }
    if (now.stop) events.close();
  };
  events.onerror = () => {
    if (events.readyState === EventSource.CLOSED) place.textContent = "The server does not answer any more: load the page again.";
  };
}
for (const place of document.querySelectorAll("[data-live]")) follow(place);
