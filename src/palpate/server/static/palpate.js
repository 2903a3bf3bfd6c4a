// All pages read without this: it keeps empty fields of a search out of the address.
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
