// Files of this computer: chosen or dropped on the page, sent to the server, and shown as further inputs.
import { byId } from "./elements.js";

export class Sending {
  #queue = []; // the first one is on its way
  #most = 0; // bytes of a file; 0: the server takes none

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    page.connection.on("hello", ({ takes }) => {
      this.#most = takes;
      byId("open").hidden = !takes;
    });
    const chosen = byId("chosen");
    byId("open").addEventListener("click", () => chosen.click());
    chosen.addEventListener("change", () => {
      this.#add([...chosen.files]);
      chosen.value = ""; // the same may be chosen again
    });
    const carriesFiles = (event) => event.dataTransfer?.types.includes("Files");
    const mark = (on) => document.body.classList.toggle("dropping", on);
    // Without an answer here the browser would leave the page for the file.
    addEventListener("dragover", (event) => {
      if (!carriesFiles(event)) return;
      event.preventDefault();
      mark(true);
    });
    addEventListener("dragleave", (event) => event.relatedTarget === null && mark(false));
    addEventListener("drop", (event) => {
      mark(false);
      if (!carriesFiles(event)) return;
      event.preventDefault();
      this.#add([...event.dataTransfer.files]);
    });
  }

  #add(files) {
    if (!this.#most) return this.page.trouble("This server takes no files from pages: name them on its command line.");
    const sends = this.#queue.length > 0;
    this.#queue.push(...files.map((file, n) => ({ file, shown: n === 0 }))); // the others can be chosen
    if (!sends) this.#sendNext();
  }

  #sendNext() {
    if (!this.#queue.length) return;
    const [{ file, shown }] = this.#queue;
    const request = new XMLHttpRequest();
    const end = (problem) => {
      this.#queue.shift();
      this.page.say("");
      if (problem) this.page.trouble(`${file.name} was not opened: ${problem}`);
      else if (shown) this.#show(Number(request.response));
      this.#sendNext();
    };
    if (file.size > this.#most) return end(`it has more than ${Math.floor(this.#most / 1e6)} MB; name it on the command line.`);
    request.open("PUT", `${location.pathname}files/${encodeURIComponent(file.name)}`);
    request.upload.addEventListener("progress", ({ loaded, total }) => this.page.say(`sending ${file.name} … ${Math.round((100 * loaded) / total)} %`));
    request.addEventListener("load", () => end(request.status === 200 ? "" : request.response.trim()));
    request.addEventListener("error", () => end("it can't be read, or the connection was lost."));
    request.send(file);
  }

  // When the list of inputs has come, which takes another way.
  #show(number) {
    if (byId("file").options.length > number) this.page.openFile(number);
    else this.page.connection.addEventListener("files", () => this.#show(number), { once: true });
  }
}
