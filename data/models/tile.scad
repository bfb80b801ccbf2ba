// tile.scad -- a 16 mm key-fob tile with a stepped top, 4.8 mm high.
//
// What it exercises: the smallest piece of the set, for tests and for
// comparing settings: the same tile is sliced with relative, absolute and
// volumetric E, with firmware retraction, and by both slicers. All its heights
// are whole numbers of 0.2 mm layers and of 0.3 mm layers.

size = 16;
step = 1.2;     // height of each step
$fn  = 48;

module block(s, r, h) { linear_extrude(h, convexity = 4) offset(r) square(s - 2*r, center = true); }

difference() {
    union() {
        block(size, 3, 2*step);
        intersection() { block(size - 5, 0.5, 3*step); rotate(45) block(size - 5, 0.5, 3*step); } // octagon
        cylinder(d = 7.8, h = 4*step);
    }
    translate([0, 0, 1.8]) cylinder(d = 4.2, h = 10);                                   // blind hole
    for (s = [-1, 1]) translate([s*(size/2 - 2.4), s*(size/2 - 2.4), -1]) cylinder(d = 2, h = 9); // through holes
}
