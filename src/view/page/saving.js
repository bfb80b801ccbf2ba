// The button that saves a finished picture: asks for it, tells how far it is, and hands the file to the browser.
import { element } from "./elements.js";

export class Saving {
  #goesOn = false;
  #number = 0; // of its own, since the view that was asked for last stays that

  /** ask(): the state of the picture as a message for the server; send, say as those of the page; name(): of the input. */
  constructor(button, { ask, send, say, name }) {
    Object.assign(this, { button, say, name });
    button.addEventListener("click", () => {
      if (this.#goesOn) {
        send({ type: "cancel" });
        this.#set(false);
        return say("not saved");
      }
      this.#set(true);
      say("saving …");
      send({ type: "save", number: ++this.#number, state: ask() });
    });
  }

  #set(on) {
    this.#goesOn = on;
    this.button.textContent = on ? "Cancel saving" : "Save picture";
  }
  /** The server knows nothing of it any more. */
  forget() {
    this.#set(false);
  }
  progress({ done }) {
    if (this.#goesOn) this.say(`saving … ${Math.round(done * 100)} %`);
  }
  take(blob) {
    this.#set(false);
    window.vdbviewSaved = blob;
    const name = this.name().replace(/\.[^.]*$/, "") || "picture";
    const link = element("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    this.say("saved");
  }
}
