// What a click has found: the bead, its line of G-code, and the distance of two clicks. Marks follow the picture.
import { byId, element, pixelRatio } from "./elements.js";
import { project, sub, size, times } from "./camera.js";

const fixed = (value, digits = 2) => value.toFixed(digits);
const point = (p) => p.map((v) => fixed(v)).join(", ");

export function clock(seconds) {
  const whole = Math.round(seconds);
  const two = (n) => String(n).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

/** Of "1:25:13", "25:13" or "13". NaN: it is no such text. */
export function secondsOf(text) {
  if (!/^\d+(:[0-5]?\d){0,2}(\.\d+)?$/.test(text)) return NaN;
  return text.split(":").reduce((sum, part) => 60 * sum + Number(part), 0);
}

function rowsOf(found, mm) {
  const rows = found.position ? [["Position, mm", point(times(found.position, mm))]] : [];
  const bead = found.bead;
  if (!bead) return rows;
  rows.push(["Layer", bead.layer], ["Feature", bead.feature.replaceAll("-", " ")], ["Tool", `T${bead.tool}`]);
  if (bead.object) rows.push(["Object", bead.object]);
  rows.push(["Width", `${fixed(bead.width_mm, 3)} mm`], ["Height", `${fixed(bead.height_mm, 3)} mm`]);
  if (bead.length_mm === undefined) return rows;
  rows.push(["Length", `${fixed(bead.length_mm)} mm`]);
  if (bead.speed_mm_s !== undefined) rows.push(["Speed", `${fixed(bead.speed_mm_s, 1)} mm/s (asked ${fixed(bead.feed_rate_mm_s, 0)})`]);
  else rows.push(["Speed", `${fixed(bead.feed_rate_mm_s, 0)} mm/s asked`]);
  if (bead.time_s !== undefined) rows.push(["Printed at", clock(bead.time_s)]);
  return rows;
}

/** Lines of G-code as a list, one of them marked by its number. */
export function linesOf(lines, here) {
  const item = ({ number, text }) => element("li", { className: number === here ? "this" : "" }, element("span", { textContent: number }), text);
  return element("ol", { ariaLabel: "Lines of G-code" }, ...lines.map(item));
}

/** A nozzle whose tip is at a place of the canvas. */
function drawHead(context, place, ratio) {
  if (!place) return;
  const [x, y] = place;
  context.beginPath();
  [[0, 0], [-5, -9], [-5, -20], [5, -20], [5, -9]].forEach(([right, up]) => context.lineTo(x + right * ratio, y + up * ratio));
  context.closePath();
  context.lineWidth = 1.5 * ratio;
  context.strokeStyle = "#111";
  context.fillStyle = "#e8a13a";
  context.fill();
  context.stroke();
}

export class Answer {
  points = []; // that are marked, of the print
  mm = 1; // a unit of the input's lengths
  lines = null; // see LineRenderer.alone(), for the finished picture, which has none
  measuring = false;
  head = null; // where the nozzle is
  #place = byId("answer");

  /** page: see main.js. */
  constructor(page) {
    this.page = page;
  }

  clear() {
    this.points = [];
    this.#place.hidden = true;
    this.draw();
  }
  /** Another input. */
  reset() {
    this.lines = this.head = null;
    this.clear();
  }

  show(found) {
    if (!found.hit) {
      if (!this.measuring) this.clear();
      return;
    }
    if (!this.measuring || this.points.length >= 2) this.points = [];
    if (found.position) this.points.push(found.position);
    const title = this.measuring ? (this.points.length === 2 ? "Distance" : "Click the second point") : found.bead ? "Bead" : "Surface";
    const close = element("button", { textContent: "Close" });
    close.addEventListener("click", () => this.clear());
    const rows = this.#rows(found).flatMap(([name, value]) => [element("dt", { textContent: name }), element("dd", { textContent: value })]);
    this.#place.replaceChildren(element("header", {}, element("h2", { textContent: title }), close), element("dl", {}, ...rows));
    if (found.lines && !this.measuring) this.#place.append(linesOf(found.lines, found.bead.line));
    this.#place.hidden = false;
  }

  #rows(found) {
    if (!this.measuring) return rowsOf(found, this.mm);
    if (this.points.length < 2) return [["From", point(times(this.points[0], this.mm))]];
    const mm = (p) => times(p, this.mm);
    const way = mm(sub(this.points[1], this.points[0]));
    return [["Distance", `${fixed(size(way), 3)} mm`], ["In x, y, z", point(way)], ["From", point(mm(this.points[0]))], ["To", point(mm(this.points[1]))]];
  }

  /** On top of the picture. */
  draw() {
    const { camera, aspect } = this.page;
    const canvas = byId("marks");
    const context = canvas.getContext("2d");
    const wanted = this.lines || (camera && (this.head || this.points.length));
    if (!wanted && canvas.hidden) return;
    canvas.hidden = !wanted; // an empty canvas costs a pass over the picture, too
    if (!wanted) return context.clearRect(0, 0, canvas.width, canvas.height);
    const ratio = pixelRatio();
    canvas.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = Math.round(canvas.clientHeight * ratio);
    if (this.lines) {
      context.scale(1, -1);
      context.drawImage(this.lines, 0, -canvas.height, canvas.width, canvas.height);
      context.resetTransform();
    }
    if (!camera) return;
    if (this.head) drawHead(context, project(camera, aspect, this.head)?.map((v, n) => v * [canvas.width, canvas.height][n]), ratio);
    if (!this.points.length) return;
    const places = this.points.map((p) => project(camera, aspect, p)).filter((p) => p !== null).map(([x, y]) => [x * canvas.width, y * canvas.height]);
    const stroke = (path) => {
      for (const [width, color] of [[5 * ratio, "rgba(0,0,0,.65)"], [2.5 * ratio, "#ffd23f"]]) {
        context.lineWidth = width;
        context.strokeStyle = color;
        context.beginPath();
        path();
        context.stroke();
      }
    };
    if (places.length === 2) stroke(() => { context.moveTo(...places[0]); context.lineTo(...places[1]); });
    for (const [x, y] of places) stroke(() => context.arc(x, y, 7 * ratio, 0, 2 * Math.PI));
  }
}
