// The printer's bed as the file states it, and areas of it that stay free: outlines, and a grid in each.

export const BED_TINTS = [[0.45, 0.5, 0.56], [0.1, 0.45, 0.8]]; // of the grid, of the outline
export const EXCLUDED_TINTS = [[0.75, 0.3, 0.25], [0.8, 0.15, 0.1]];

/** Records as those of a MoveTable: kind 0 the grid, with lines every `step` mm, 1 the outline. `outlines` are lists of
 * [x, y] in mm. */
export function bedLines(outlines, step) {
  const lines = [];
  const add = (kind, from, to) => lines.push([kind, ...from, 0, ...to, 0]);
  for (const corners of outlines) {
    for (const axis of [0, 1]) {
      const along = corners.map((corner) => corner[axis]);
      for (let at = step * Math.floor(Math.min(...along) / step + 1); at < Math.max(...along) && lines.length < 20000; at += step) {
        // Where the line enters and leaves the outline.
        const cuts = [];
        corners.forEach((a, n) => {
          const b = corners[(n + 1) % corners.length];
          if (a[axis] <= at !== b[axis] <= at) cuts.push(a[1 - axis] + ((at - a[axis]) / (b[axis] - a[axis])) * (b[1 - axis] - a[1 - axis]));
        });
        cuts.sort((a, b) => a - b);
        const place = (other) => (axis === 0 ? [at, other] : [other, at]);
        for (let n = 0; n + 1 < cuts.length; n += 2) add(0, place(cuts[n]), place(cuts[n + 1]));
      }
    }
    corners.forEach((corner, n) => add(1, corner, corners[(n + 1) % corners.length]));
  }
  const words = new Uint32Array(8 * lines.length);
  const floats = new Float32Array(words.buffer);
  lines.forEach(([kind, ...ends], n) => {
    floats.set(ends, 8 * n);
    words[8 * n + 7] = kind << 28;
  });
  return words;
}
