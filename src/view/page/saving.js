// The button that saves a finished picture: asks for it, tells how far it is, and hands the file to the browser.
import { byId, element } from "./elements.js";
import { toMessage } from "./state.js";

export class Saving {
  #goesOn = false;
  #number = 0; // of its own, since the view that was asked for last stays that

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    byId("save").addEventListener("click", () => this.#press());
    const { connection } = page;
    for (const type of ["hello", "failed"]) connection.on(type, () => this.stop()); // the server knows nothing of it any more
    connection.on("not-saved", ({ text }) => this.#goesOn && this.stop(`not saved: ${text}`));
    connection.on("saving", ({ done }) => this.#goesOn && page.say(`saving … ${Math.round(done * 100)} %`));
    connection.on("picture", ({ kind, file }) => kind === "saved" && this.#take(file));
  }

  /** What it waits for will not come. */
  stop(why = "not saved") {
    if (this.#goesOn) this.page.say(why);
    this.#set(false);
  }
  #press() {
    const { connection, say, state, pixels } = this.page;
    this.#set(!this.#goesOn);
    say(this.#goesOn ? "saving …" : "not saved");
    if (!this.#goesOn) return connection.send({ type: "cancel" });
    const chosen = byId("save-size").value;
    connection.send({ type: "save", number: ++this.#number, state: toMessage(state, chosen ? chosen.split("x").map(Number) : pixels()) });
  }
  #set(on) {
    this.#goesOn = on;
    byId("save").textContent = on ? "Cancel saving" : "Save picture";
  }
  #take(blob) {
    this.#set(false);
    window.vdbviewSaved = blob;
    const name = byId("file").selectedOptions[0].text.replace(/\.[^.]*$/, "") || "picture";
    const link = element("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    this.page.say("saved");
  }
}
