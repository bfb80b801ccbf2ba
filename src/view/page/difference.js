// Which beads two prints have in common: same ends and width, to a hundredth of a millimetre. Numbers, no drawing.

const NEAR = 0.01; // mm
const CELL = [0.5, 0.5, 0.05]; // mm, of the map that finds a bead by its middle

/** Six coordinates of the ends, and the width, of each bead of a table. */
function endsOf(table) {
  const ends = new Float64Array(7 * table.count);
  for (let n = 0; n < table.count; ++n) ends.set([...table.ends(n).flat(), table.width(n)], 7 * n);
  return ends;
}

const keyOf = ([x, y, z]) => ((x + 8192) * 16384 + y + 8192) * 65536 + z + 4096;

/** By bead of the first table: 1 where the second has no such bead. */
export function onlyIn(table, other) {
  const [mine, theirs] = [endsOf(table), endsOf(other)];
  const middle = (ends, n, axis) => (ends[7 * n + axis] + ends[7 * n + 3 + axis]) / 2;
  const first = new Map();
  const next = new Int32Array(other.count).fill(-1);
  for (let n = 0; n < other.count; ++n) {
    const key = keyOf(CELL.map((size, axis) => Math.floor(middle(theirs, n, axis) / size)));
    next[n] = first.get(key) ?? -1;
    first.set(key, n);
  }
  const same = (n, m) => {
    const near = (from) => [0, 1, 2, 3, 4, 5].every((k) => Math.abs(mine[7 * n + k] - theirs[7 * m + ((k + from) % 6)]) <= NEAR);
    return Math.abs(mine[7 * n + 6] - theirs[7 * m + 6]) <= NEAR && (near(0) || near(3)); // in either direction
  };
  const found = (n) => {
    // A middle near the border of a cell may be beyond it.
    const places = CELL.map((size, axis) => [-1, 1].map((side) => Math.floor((middle(mine, n, axis) + side * NEAR) / size)));
    for (const x of new Set(places[0]))
      for (const y of new Set(places[1]))
        for (const z of new Set(places[2]))
          for (let m = first.get(keyOf([x, y, z])) ?? -1; m >= 0; m = next[m]) if (same(n, m)) return true;
    return false;
  };
  return Uint16Array.from({ length: table.count }, (_, n) => Number(!found(n)));
}

/** Beads and mm of a mask of onlyIn(), of what the state shows. */
export function amount(table, only, state) {
  let [beads, length] = [0, 0];
  table.each(state, (bead) => {
    if (!only[bead]) return;
    ++beads;
    length += table.length(bead);
  });
  return { beads, length };
}
