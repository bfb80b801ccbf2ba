// Finds a text, a line, a time or a layer of the program, and goes there.
import { linesOf, secondsOf } from "./answer.js";
import { byId } from "./elements.js";

const HINTS = { text: "M106", line: "1200", time: "1:25:00", layer: "12" };

export class Finder {
  #line = 0; // that was found last

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    page.connection.on("found", (found) => this.#take(found));
    byId("find").addEventListener("submit", (event) => (event.preventDefault(), this.#ask(false)));
    byId("find-back").addEventListener("click", () => this.#ask(true));
    byId("find-what").addEventListener("change", () => {
      byId("find-for").placeholder = HINTS[byId("find-what").value];
      byId("find-back").disabled = byId("find-what").value !== "text";
      this.say("");
    });
  }

  open() {
    byId("find-group").open = true;
    byId("find-for").focus();
    byId("find-for").select();
  }
  /** Another program. */
  reset() {
    this.#line = 0;
    this.say("");
  }

  /** Below the field. */
  say(text) {
    byId("find-result").textContent = text;
  }
  #ask(back) {
    const what = byId("find-what").value;
    const wanted = byId("find-for").value.trim();
    if (!wanted) return;
    if (what === "text") return this.page.connection.send({ type: "find", text: wanted, line: this.#line, back });
    const number = what === "time" ? secondsOf(wanted) : /^\d+$/.test(wanted) ? Number(wanted) : NaN;
    if (!(number >= 0 && number < 1e9) || (what === "line" && !number)) return this.say(`That is no ${what}: write it as ${HINTS[what]}.`);
    if (what === "layer") return this.#askLayer(number);
    this.page.connection.send({ type: "find", [what === "time" ? "seconds" : "line"]: number });
  }

  #askLayer(number) {
    const count = this.page.controls.layerCount;
    if (number < 1 || number > count) return this.say(`The print has layers 1 to ${count}.`);
    this.page.controls.goTo(number);
    this.say(`layer ${number}`);
  }

  /** What the server has found. */
  #take(found) {
    if (found.matches === 0) return this.say("The program has no such text.");
    this.#line = found.line;
    const over = byId("find-what").value === "time" && found.bead === this.page.motion.facts?.beads - 1;
    this.say(`${found.matches ? `${found.match} of ${found.matches}: ` : over ? "The print is over by then: " : ""}line ${found.line}, layer ${found.layer}`);
    this.page.controls.goTo(found.layer);
    this.page.motion.go(found.bead, linesOf(found.lines, found.line));
  }
}
