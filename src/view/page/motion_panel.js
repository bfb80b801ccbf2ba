// Beside the picture: what the machine does besides beads, the layer's height and time, and its moves with their lines.
import { clock, linesOf } from "./answer.js";
import { byId, checkbox, element, follow, setText, swatch } from "./elements.js";
import { withOrWithout } from "./state.js";
import { KINDS } from "./move_table.js";

export class MotionPanel {
  #layers = null; // of the server: heights and times
  #asked = false; // for them
  #bead = -1; // whose line was asked for last
  #waits = false; // for its answer
  #listed = {}; // beads of the layer

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    this.own = page.own;
    byId("also").replaceChildren(...[...KINDS, ["bed and grid of 10 mm", "#1973cc"]].map(([name, color]) =>
      checkbox(name, (on) => this.toggle(name, on), swatch(color), name, element("output"))));
    byId("layers-group").addEventListener("focusin", () => this.#askLayers());
    byId("layers-group").addEventListener("input", () => this.#askLayers());
    byId("moves-group").addEventListener("toggle", () => this.show());
    follow(byId("moves"), (move, moving) => this.#move(move, moving));
    page.connection.on("layers", (layers) => {
      this.#layers = layers;
      this.show();
    });
    page.connection.on("program", (program) => this.#setProgram(program));
    page.connection.on("refused", () => this.#setProgram(null)); // that may be what was asked for
    page.connection.on("hello", () => this.#restart()); // what was asked for before gets no answer
  }

  /** The file was read, perhaps anew. */
  setFacts(facts) {
    this.facts = facts.print;
    this.#layers = null;
    this.#listed = {};
    this.#restart();
    byId("also").lastChild.hidden = !facts.print?.bed;
    this.show();
  }
  #restart() {
    this.#asked = this.#layers !== null;
    this.#waits = false;
    this.#bead = -1;
  }
  get planned() {
    return this.#layers?.seconds.reduce((sum, each) => sum + each, 0);
  }
  #setProgram(program) {
    this.#waits = false;
    if (program) byId("program").replaceChildren(linesOf(program.lines, program.line));
    this.#follow();
  }

  toggle(name, on = !this.page.state.also.includes(name)) {
    this.page.change({ also: withOrWithout(this.page.state.also, name, on) });
  }

  #askLayers() {
    if (this.#asked || !this.facts) return;
    this.#asked = true;
    this.page.connection.send({ type: "layers" });
  }

  /** How many beads are printed, and the layer of the last one; 0: all of them. */
  get #printed() {
    const { table } = this.own;
    const end = table?.complete ? table.end(this.page.state) : Infinity;
    return { end, working: end < table?.count ? table.layerOf(Math.max(0, end - 1)) : 0 };
  }
  get #last() {
    return this.page.state.layers[1] || this.facts?.layers || 0;
  }
  /** Of those that are shown. */
  get #layer() {
    const { working } = this.#printed;
    return working ? Math.max(this.page.state.layers[0] || 1, Math.min(this.#last, working)) : this.#last;
  }
  /** Beads of the layer in front: its moves. */
  get #beads() {
    const { table } = this.own;
    const layer = this.#layer;
    if (!table?.complete) return [];
    if (this.#listed.layer !== layer || this.#listed.table !== table) this.#listed = { layer, table, beads: table.ofLayers(layer, layer) };
    return this.#listed.beads;
  }
  /** The last move of the layer that is printed, from 1. */
  get move() {
    const { end } = this.#printed;
    return this.#beads.filter((bead) => bead < end).length;
  }
  step(by) {
    byId("moves-group").open = true;
    this.#move(this.move + by, false);
  }

  /** What is printed up to a bead, with these lines of the program. */
  go(bead, lines) {
    byId("moves-group").open = true;
    this.#bead = bead; // whose lines these are
    byId("program").replaceChildren(lines);
    this.page.change({ beads: bead + 1, printed: 100 });
  }

  #move(move, moving) {
    const beads = this.#beads;
    if (!beads.length) return;
    move = Math.max(1, Math.min(beads.length, move));
    const all = move === beads.length && this.#layer === this.#last;
    this.page.select({ beads: all ? null : beads[move - 1] + 1, printed: 100 }, moving);
  }

  // The newest line that is wanted; one answer at a time.
  #follow() {
    const bead = this.#beads[Math.max(1, this.move) - 1];
    if (this.#waits || bead === undefined || bead === this.#bead || !byId("moves-group").open) return;
    this.#bead = bead;
    this.#waits = true;
    this.page.connection.send({ type: "program", bead });
  }

  /** The state in the panel. `rests`: it is not being moved, so that there is time to ask for what is missing. */
  show(rests = false) {
    const { also } = this.page.state;
    const needs = KINDS.some(([name]) => also.includes(name));
    const counts = needs ? this.own.counts() : null;
    [...byId("also").children].forEach((label, n) => {
      const box = label.querySelector("input");
      box.checked = also.includes(box.value);
      box.disabled = !this.own.ready;
      if (counts && n < KINDS.length) label.hidden = !this.own.moves.totals[n];
      setText(label.querySelector("output"), counts && box.checked && n < KINDS.length ? String(counts[n]) : "");
    });
    byId("also-none").hidden = this.own.ready;
    const { layers, printed } = this.page.state;
    if (rests && (layers[0] || layers[1] || printed < 100)) this.#askLayers();
    const layer = this.#layer;
    const times = this.#layers?.seconds;
    const done = times?.slice(0, layer + 1).reduce((a, b) => a + b, 0);
    setText(byId("layer-info"), times && layer ? `Layer ${layer}: z ${this.#layers.z[layer].toFixed(2)} mm, takes ${clock(times[layer])}, done after ${clock(done)}` : "");
    const count = this.#beads.length;
    const now = printed < 100 && times && layer === this.#printed.working ? `, ${clock(done - times[layer] * (1 - this.move / count))}` : "";
    setText(byId("printed-value"), `${printed} %${now}`);
    byId("moves-group").hidden = !count;
    byId("moves").max = count;
    byId("moves").value = this.move;
    setText(byId("moves-value"), `move ${this.move} of ${count} in layer ${layer}`);
    this.#follow();
  }
}
