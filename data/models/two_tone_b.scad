// two_tone_b.scad -- medallion "sun over waves", second part: the inlay.
//
// What it exercises: the second tool. It takes the shape and the measures from
// two_tone_a.scad, so the two always fit; printed by tool 1 while the disc is
// printed by tool 0.

use <two_tone_a.scad>

inlay();
