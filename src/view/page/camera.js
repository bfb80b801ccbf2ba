// A camera that turns about a point, and how mouse, touch and keys move it. Lengths are those of the print.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const size = (a) => Math.hypot(...a);
export const unit = (a) => times(a, 1 / (size(a) || 1));
/** To a millionth of a scale: short in a command line. */
export const roundedTo = (scale, v) => Number(v.toFixed(Math.max(0, Math.min(20, 6 - Math.floor(Math.log10(scale))))));

/** Of a box [x0, y0, z0, x1, y1, z1]. */
export const middleOf = (box) => times(add(box.slice(0, 3), box.slice(3)), 0.5);

export class OrbitCamera {
  target = [0, 0, 0];
  distance = 300;
  azimuth = -1; // radians, of the eye about the target
  elevation = 0.5;
  fov = 28; // degrees, vertical
  unit = 1; // the length of a millimetre

  /** From a camera of the server; the target is the point before it that is nearest to `middle`. */
  static from(camera, middle) {
    const orbit = new OrbitCamera();
    orbit.distance = Math.max(1e-6, dot(sub(middle, camera.eye), camera.forward));
    orbit.target = add(camera.eye, times(camera.forward, orbit.distance));
    orbit.elevation = Math.asin(Math.max(-1, Math.min(1, -camera.forward[2])));
    // Straight up or down, the azimuth is that of the picture's upper edge.
    const flat = Math.hypot(camera.forward[0], camera.forward[1]) < 1e-3;
    const way = flat ? times(camera.up, camera.forward[2] < 0 ? 1 : -1) : camera.forward;
    orbit.azimuth = Math.atan2(-way[1], -way[0]);
    orbit.fov = camera.fov;
    orbit.turn(0, 0);
    return orbit;
  }

  /** As the server describes one. */
  get camera() {
    const { eye, right, up, fov } = this;
    return { eye, forward: times(this.outward, -1), right, up, fov };
  }
  /** Of a part of the state. */
  static fromJSON({ eye, look_at, fov }) {
    return OrbitCamera.from({ eye, forward: unit(sub(look_at, eye)), up: [0, 0, 1], fov }, look_at);
  }
  toJSON() {
    const [eye, look_at] = [this.eye, this.target].map((place) => place.map((v) => roundedTo(this.distance, v)));
    return { eye, look_at, fov: this.fov };
  }

  get eye() {
    return add(this.target, times(this.outward, this.distance));
  }
  get outward() {
    const flat = Math.cos(this.elevation);
    return [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }
  get right() {
    return [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
  }
  get up() {
    return cross(this.outward, this.right);
  }

  turn(right, up) {
    this.azimuth -= right;
    const most = Math.PI / 2 - 0.002; // straight down has no upper edge
    this.elevation = Math.max(-most, Math.min(most, this.elevation + up));
  }

  /** By parts of the picture's height. */
  pan(right, up) {
    const height = 2 * this.distance * Math.tan((this.fov * Math.PI) / 360);
    this.target = add(this.target, add(times(this.right, -right * height), times(this.up, -up * height)));
  }

  /** Returns by how much of it: 0.05 mm are the nearest. */
  zoom(factor) {
    const before = this.distance;
    this.distance = Math.max(0.05 * this.unit, Math.min(1e5 * this.unit, before * factor));
    return this.distance / before;
  }

  /** All of a box, from the same side. */
  fit(box, aspect) {
    this.target = middleOf(box);
    const slope = Math.tan((this.fov * Math.PI) / 360) * 0.92;
    let distance = 0;
    for (let n = 0; n < 8; ++n) {
      const corner = sub([box[n & 1 ? 3 : 0], box[n & 2 ? 4 : 1], box[n & 4 ? 5 : 2]], this.target);
      const near = dot(corner, this.outward);
      distance = Math.max(distance, near + Math.abs(dot(corner, this.right)) / (slope * aspect), near + Math.abs(dot(corner, this.up)) / slope);
    }
    this.distance = distance;
  }
}

/** Where a point is in a picture that a camera of the server shows: 0 to 1 in each direction, or null. */
export function project(camera, aspect, point) {
  const way = sub(point, camera.eye);
  const depth = dot(way, camera.forward);
  if (depth <= 0) return null;
  const scale = 2 * depth * Math.tan((camera.fov * Math.PI) / 360);
  return [0.5 + dot(way, camera.right) / (scale * aspect), 0.5 - dot(way, camera.up) / scale];
}

/** Mouse, touch and keys on an element. Calls moved(moving) after each change of orbit(), and clicked(x, y) in 0..1.
 * key(event) returns whether another key is for the page. */
export function handleInput(element, { orbit, moved, clicked, key }) {
  const pointers = new Map();
  let travelled = 0;
  let timer = 0;
  /** It has moved by a step, of which more may follow. */
  const step = () => {
    moved(true);
    clearTimeout(timer);
    timer = setTimeout(() => moved(false), 180);
  };
  const place = (event) => [event.clientX, event.clientY];
  /** Of one pointer, or of two. */
  const spread = () => {
    const [a, b = a] = pointers.values();
    return { middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], distance: Math.hypot(a[0] - b[0], a[1] - b[1]) };
  };

  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    if (pointers.size === 1) travelled = 0;
    element.classList.add("turning");
  });
  element.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = spread();
    pointers.set(event.pointerId, place(event));
    const after = spread();
    const [dx, dy] = [0, 1].map((axis) => after.middle[axis] - before.middle[axis]);
    travelled += Math.abs(dx) + Math.abs(dy) + Math.abs(after.distance - before.distance);
    if (travelled < 4) return; // a click may tremble
    const height = element.clientHeight;
    const two = pointers.size === 2;
    if (two) orbit().zoom(before.distance / Math.max(1, after.distance));
    if (two || event.buttons & 6 || event.shiftKey) orbit().pan(dx / height, -dy / height);
    else orbit().turn((dx / height) * 3.2, (dy / height) * 3.2);
    moved(true);
  });
  const lifted = (event) => {
    if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
    element.classList.remove("turning");
    if (travelled >= 4) return moved(false);
    const box = element.getBoundingClientRect();
    if (event.type === "pointerup" && event.button === 0)
      clicked((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
  };
  element.addEventListener("pointerup", lifted);
  element.addEventListener("pointercancel", lifted);
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 30 : 1;
    const factor = orbit().zoom(Math.exp(Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0015));
    const area = element.getBoundingClientRect();
    const away = (1 - factor) / factor; // what is under the pointer stays there
    orbit().pan((-away * (event.clientX - area.left - area.width / 2)) / area.height, (away * (event.clientY - area.top - area.height / 2)) / area.height);
    step();
  }, { passive: false });

  const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const zooms = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 };
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const way = turns[event.key];
    if (way && event.shiftKey) orbit().pan(way[0] * 0.05, way[1] * 0.05);
    else if (way) orbit().turn(way[0] * 0.08, -way[1] * 0.08);
    else if (zooms[event.key]) orbit().zoom(zooms[event.key]);
    else return key(event) && event.preventDefault(); // else it would be typed where the focus goes
    event.preventDefault();
    step();
  });
}
