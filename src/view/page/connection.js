// The web socket: messages out, messages and pictures in; comes back when the server does.

export class Connection extends EventTarget {
  #socket = null;
  #wait = 250; // ms until the next attempt
  #timer = 0;
  #closed = false;

  constructor(url) {
    super();
    this.url = url;
    this.#open();
  }

  get ready() {
    return this.#socket !== null && this.#socket.readyState === WebSocket.OPEN;
  }

  send(message) {
    if (this.ready) this.#socket.send(JSON.stringify(message));
  }

  /** take(message) for each message of a type, or event of the connection. */
  on(type, take) {
    this.addEventListener(type, ({ detail }) => take(detail));
  }

  /** For good. */
  close() {
    this.#closed = true;
    this.#socket.close();
    clearTimeout(this.#timer);
  }

  #open() {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    let opened = false;
    socket.addEventListener("open", () => {
      opened = true;
      this.#wait = 250;
      this.#tell("open");
    });
    socket.addEventListener("message", (event) => this.#take(event.data));
    socket.addEventListener("close", async (event) => {
      if (this.#closed) return;
      this.#tell("gone", { reason: event.reason });
      // A server that was started anew has another token, and never lets this page in.
      const answer = await fetch(location.pathname, { method: "HEAD" }).catch(() => null);
      if (this.#closed) return;
      if (answer?.status === 403) return this.#tell("stranger");
      if (answer?.ok && !opened) this.#tell("gone", { reason: "too many pages are open; close one of them" });
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#open(), this.#wait);
      this.#wait = Math.min(5000, this.#wait * 2);
    });
  }

  #take(data) {
    if (this.#closed) return; // it was on its way
    if (typeof data === "string") {
      const message = JSON.parse(data);
      this.#tell(message.type, message);
      return;
    }
    // Four bytes, the head's length; the head; the file of a picture, or other bytes.
    const length = new DataView(data).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    const file = head.media ? new Blob([new Uint8Array(data, 4 + length)], { type: head.media }) : data.slice(4 + length);
    if (!head.media) this.send({ type: "shown" }); // a picture is shown later
    this.#tell(head.type, { ...head, file });
  }

  #tell(type, detail = null) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
