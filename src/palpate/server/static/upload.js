// The form works without this; with it files can be dropped, and are looked at before they are sent.
const KNOWN = [".zip", ".json", ".csv", ".tsv", ".toml", ".mcap", ".db3", ".bag", ".jsonl", ".yaml"];
const LARGEST_PARSED = 32 << 20;

const ending = (name) => (name.includes(".") ? name.slice(name.lastIndexOf(".")).toLowerCase() : "");
function readable(bytes) {
  if (bytes < 1024) return bytes === 1 ? "1 byte" : `${bytes} bytes`;
  return bytes < 1 << 20 ? `${Math.ceil(bytes / 1024)} KiB` : `${(bytes / (1 << 20)).toFixed(1)} MiB`;
}

// What will be said of a file; nothing where nothing is wrong as far as can be told here.
async function remark(file, names) {
  const kind = ending(file.name);
  if (!file.size) return "is empty";
  if (kind === ".json" && file.size <= LARGEST_PARSED) {
    try {
      // programs of robots write numbers that are none
      JSON.parse((await file.text()).replace(/([[:,]\s*)(NaN|-?Infinity)(?=\s*[,\]}])/g, "$1null"));
    } catch (fault) {
      return `is no JSON: ${fault.message}`;
    }
  }
  if (kind === ".zip" && (await file.slice(0, 2).text()) !== "PK") return "is no zip file";
  if (kind === ".mcap" && (await file.slice(1, 5).text()) !== "MCAP") return "is no MCAP file";
  const needsMap = [".csv", ".tsv", ".mcap", ".bag", ".db3"].includes(kind);
  if (needsMap && !names.some((name) => ending(name) === ".toml")) return "needs a map (.toml) beside it";
  if (!KNOWN.includes(kind)) return "is kept only where another file names it";
  return "";
}

function prepare(form) {
  const field = form.querySelector("input[type=file]");
  const list = form.querySelector(".chosen");
  const button = form.querySelector("button");

  function choose(files) {
    const held = new DataTransfer();
    for (const file of files) held.items.add(file);
    field.files = held.files;
    show();
  }

  async function show() {
    const files = [...field.files];
    const names = files.map((file) => file.name);
    const size = files.reduce((sum, file) => sum + file.size, 0);
    const rows = await Promise.all(files.map(async (file) => row(file, await remark(file, names))));
    const faults = [];
    if (size > Number(form.dataset.largest)) faults.push(`These are ${readable(size)}; ${readable(Number(form.dataset.largest))} can be sent at once.`);
    if (files.length > Number(form.dataset.most)) faults.push(`These are ${files.length} files; ${form.dataset.most} can be sent at once.`);
    list.replaceChildren(...faults.map((text) => item(text, "fault")), ...rows);
    button.disabled = faults.length > 0;
  }

  function item(text, kind) {
    const found = document.createElement("li");
    found.textContent = text;
    found.className = kind;
    return found;
  }

  function row(file, told) {
    const found = item(`${file.name}, ${readable(file.size)}${told ? `: ${told}` : ""}`, told ? "odd" : "");
    const remove = document.createElement("button");
    remove.type = "button";
    remove.className = "quiet";
    remove.textContent = "Remove";
    remove.setAttribute("aria-label", `Remove ${file.name}`);
    remove.addEventListener("click", () => choose([...field.files].filter((one) => one !== file)));
    found.append(" ", remove);
    return found;
  }

  field.addEventListener("change", show);
  for (const name of ["dragenter", "dragover"]) {
    form.addEventListener(name, (event) => {
      event.preventDefault();
      form.classList.add("over");
    });
  }
  for (const name of ["dragleave", "drop"]) form.addEventListener(name, () => form.classList.remove("over"));
  form.addEventListener("drop", (event) => {
    event.preventDefault();
    choose([...field.files, ...event.dataTransfer.files]);
  });
  form.addEventListener("submit", () => {
    button.textContent = "Reading …";
  });
  window.addEventListener("pageshow", () => {
    button.textContent = "Show what is in them";
    if (field.files.length) show();
  });
}
for (const form of document.querySelectorAll("form.drop")) prepare(form);
