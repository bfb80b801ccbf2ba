// Another of the inputs beside the first: the same camera and selection, and what of the beads differs.
import { Connection } from "./connection.js";
import { amount, onlyIn } from "./difference.js";
import { byId, setOptions } from "./elements.js";
import { OwnPicture } from "./own_picture.js";
import { initial, toMessage } from "./state.js";

const GREY = [0.35, 0.35, 0.35];
const [GONE, NEW] = [[0.75, 0.03, 0.02], [0.02, 0.45, 0.05]];

export class SecondPrint {
  #connection = null;
  #own = null;
  #asked = ""; // of the look
  #number = 0;
  #failed = false; // and the server has said why
  #masks = null; // of what only one of the two has

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
    byId("second").addEventListener("change", () => this.#open());
    byId("differs").addEventListener("change", () => {
      this.#compare();
      page.ask(false);
    });
    page.own.addEventListener("changed", () => this.shown && this.#compare());
  }

  get shown() {
    return this.#connection !== null;
  }
  /** Its OwnPicture; null: none was shown yet. */
  get own() {
    return this.#own;
  }

  /** The inputs, of which one is shown. */
  setFiles(names, file) {
    const list = byId("second");
    const chosen = list.value; // stays, also when the server comes back
    setOptions(list, [["nothing", ""], ...names.map((name, n) => [name, n]).filter(([, n]) => n !== file)]);
    list.value = list.querySelector(`[value="${chosen}"]`) ? chosen : "";
    byId("second-group").hidden = names.length < 2;
    if (this.shown) this.#open();
  }

  #open() {
    this.#connection?.close();
    const file = byId("second").value;
    this.#connection = null;
    this.#masks = null;
    this.#asked = "";
    this.#failed = false;
    byId("stage").classList.toggle("two", file !== "");
    this.#say("");
    this.page.own.paintOver(null);
    if (file === "") {
      this.#own?.refuse("no file is chosen"); // gives its memory back
      return this.page.ask(false);
    }
    const connection = (this.#connection = new Connection(this.page.connection.url));
    if (!this.#own) {
      this.#own = new OwnPicture(byId("second-beads"));
      this.#own.addEventListener("changed", () => {
        if (!this.#own.ready) this.#asked = ""; // it has no light
        this.#compare();
        this.page.ask(false);
      });
    }
    const own = this.#own;
    connection.on("hello", () => connection.send({ type: "open", file: Number(file) }));
    own.listen(connection);
    connection.on("no-beads", ({ text }) => this.#failed || this.#say(`It can't be shown here: ${text}.`));
    for (const type of ["look", "loading"]) connection.on(type, () => (this.#failed = false));
    connection.on("look", (look) => own.illuminate(look));
    connection.on("loading", ({ step }) => own.ready || this.#say(`${step} …`));
    connection.on("failed", ({ text }) => {
      byId("second-beads").hidden = this.#failed = true;
      this.#say(text);
    });
    connection.on("picture", () => connection.send({ type: "shown" }));
    this.page.ask(false);
  }

  #say(text) {
    byId("second-info").textContent = text;
  }

  // The colours of what only one of the two has.
  #compare() {
    const [a, b] = [this.page.own, this.#own];
    if (!this.shown || !byId("differs").checked || !a.table?.complete || !b?.table?.complete) {
      a.paintOver(null);
      return b?.paintOver(null);
    }
    if (this.#masks?.from !== a.table || this.#masks.of !== b.table)
      this.#masks = { from: a.table, of: b.table, gone: onlyIn(a.table, b.table), fresh: onlyIn(b.table, a.table) };
    a.paintOver([this.#masks.gone, [GREY, GONE]]);
    b.paintOver([this.#masks.fresh, [GREY, NEW]]);
  }

  /** Beside the first print, of the same state. */
  draw(camera, state, size, moving) {
    if (!this.shown) return;
    // Numbers of beads, objects and tools are those of the first, and what is drawn besides beads.
    const its = { ...state, beads: null, objects: [], tools: [], also: [] };
    this.#askLook(its);
    byId("second-beads").hidden = this.#failed || !this.#own.ready; // nothing rather than what was there before
    if (byId("second-beads").hidden) return;
    this.#own.draw(camera, its, size, moving);
    if (!byId("differs").checked) this.#say("");
    else if (!moving && this.#masks) {
      const [gone, fresh] = [amount(this.page.own.table, this.#masks.gone, state), amount(this.#own.table, this.#masks.fresh, its)];
      const text = ({ beads, length }) => `${beads} ${beads === 1 ? "bead" : "beads"}, ${(length / 1000).toFixed(2)} m`;
      this.#say(`Red, gone: ${text(gone)}. Green, new: ${text(fresh)}.`);
    }
  }

  // Light and colours; the server's picture is not wanted, and small.
  #askLook(state) {
    const first = initial();
    const look = { ...state, layers: first.layers, printed: 100, hidden_features: [], clip: null, spp: 1 };
    const key = JSON.stringify({ ...look, camera: null, also: null });
    if (!this.#connection.ready || !this.#own.table?.complete || this.#own.why || key === this.#asked) return;
    this.#asked = key;
    this.#connection.send({ type: "show", number: ++this.#number, moving: false, own: true, state: toMessage(look, [16, 16]) });
  }
}
