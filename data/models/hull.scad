// hull.scad -- a stout little harbour tug, about 56 x 23 x 36 mm.
//
// What it exercises: double-curved sides that change every layer (flare at the
// bow, rounded stern), thin bulwarks with scuppers, bridged window openings,
// an overhanging cabin roof and wing visor, a raked hollow funnel, small
// islands (bollards, mast) that make the head travel, tyres that start in the
// air as little ears, and a flat solid deck.
// No supports needed. Sits on z = 0, bow towards +x.

L      = 56;    // length over all
B      = 24;    // greatest breadth
H      = 17;    // height of the loft, before the sheer line trims it
deck_z = 8.2;   // height of the working deck
wall   = 1.7;   // thickness of the bulwark
N      = 24;    // stations along each side
K      = 12;    // waterlines, bottom to top
$fn    = 36;

// --- lines of the ship ------------------------------------------------------
// t = 0 at the keel, 1 at the top of the loft; u = 0 at the stern, 1 at the bow
function fullness(u) = u < 0.36 ? pow(1 - pow(1 - u/0.36, 2.5), 1/2.5)
                                : pow(1 - pow((u - 0.36)/0.64, 2.2), 0.68);
function stern_x(t) = -L/2 * (0.80 + 0.20*pow(t, 0.55));
function bow_x(t)   =  L/2 * (0.74 + 0.26*pow(t, 0.9));
function half_b(u, t) = B/2 * fullness(u)
    * ((0.70 + 0.30*pow(t, 0.6)) - 0.16*(1 - t)*pow(u, 3));
function u_of(i) = (1 - cos(180*i/N))/2;          // stations crowd at the ends

// ring of points at waterline t, moved inwards by g
function ring(t, g, z) = let (a = stern_x(t) + g, b = bow_x(t) - 1.25*g) concat(
    [for (i = [0:N])     let (u = u_of(i)) [a + (b - a)*u, -max(half_b(u, t)*(1 - g/(B/2)) , 0.02), z]],
    [for (i = [N:-1:0])  let (u = u_of(i)) [a + (b - a)*u,  max(half_b(u, t)*(1 - g/(B/2)) , 0.02), z]]);

module loft(g = 0, z0 = 0) {
    M = 2*(N + 1);
    zs = [for (k = [0:K]) z0 + (H - z0)*k/K];
    polyhedron(
        points = [for (k = [0:K]) for (p = ring(zs[k]/H, g, zs[k])) p],
        faces = concat(
            [[for (i = [0:M-1]) i]],
            [for (k = [0:K-1]) for (i = [0:M-1]) let (a = k*M + i, b = k*M + (i+1)%M)
                each [[a, a + M, b], [b, a + M, b + M]]],
            [[for (i = [M-1:-1:0]) K*M + i]]),
        convexity = 6);
}

// side view of the top edge: low amidships, sweeping up to the bow
function sheer(x) = 11.0 + 5.2*pow(max(0, (x + 8)/(L/2 + 8)), 2) + 0.9*pow(max(0, -(x + 8)/(L/2 - 8)), 2);
module under_sheer(drop = 0) {
    rotate([90, 0, 0]) linear_extrude(B + 10, center = true) polygon(concat(
        [[-L, -1], [L, -1]], [for (x = [L/2 + 2 : -2 : -L/2 - 2]) [x, sheer(x) - drop]]));
}

// rubbing strake: the loft made a little fatter in a band under the sheer
module strake() {
    difference() {
        intersection() { loft(-0.8); under_sheer(1.6); }
        under_sheer(3.0);
        loft(wall, deck_z);
        translate([-L, -L, -1]) cube([2*L, 2*L, 2]);
    }
}

module hull_body() {
    difference() {
        union() { intersection() { loft(); under_sheer(); } strake(); }
        difference() { loft(wall, deck_z); translate([0, 0, deck_z - 10]) cube([2*L, 2*L, 20 - 0.01], center = true); }
        for (x = [-17, -12, -7]) translate([x, 0, deck_z + 0.9])          // scuppers
            rotate([90, 0, 0]) linear_extrude(B + 4, center = true) offset(0.55) square([2.2, 0.1], center = true);
        for (s = [-1, 1]) translate([20.5, s*5, 10.8]) rotate([0, 90, s*48]) // hawse pipes
            cylinder(d = 1.9, h = 12, center = true);
    }
}

// old tyres hung over the side
module tyres() {
    z = 6.6;
    for (x = [-2.5, 4, 10.5]) let (u = (x - stern_x(z/H))/(bow_x(z/H) - stern_x(z/H)), y = half_b(u, z/H))
        for (s = [-1, 1]) translate([x, s*(y + 0.35), z]) rotate([s*78, 0, 0]) rotate([0, 0, -s*x*0.9])
            rotate_extrude($fn = 24) translate([1.75, 0]) circle(0.85, $fn = 12);
}

// --- superstructure ---------------------------------------------------------
module slab(l, b, h, r = 2) { linear_extrude(h) offset(r) square([l - 2*r, b - 2*r], center = true); }

module window(w, h) { // pointed top so that only its last layers bridge
    linear_extrude(40, center = true) polygon([[-w/2, 0], [w/2, 0], [w/2, h - w/4], [w/4, h], [-w/4, h], [-w/2, h - w/4]]);
}

module cabin() {
    difference() {
        union() {
            translate([3, 0, deck_z - 0.5]) slab(21, 13, 7.7);            // deckhouse
            translate([3, 0, deck_z + 7.2]) {                              // its visor, 45 degrees below
                hull() { translate([0, 0, -1.2]) slab(21, 13, 0.1); slab(23.4, 15.4, 1.0, 2.6); }
            }
            translate([7, 0, deck_z + 8]) slab(11.5, 11, 9.2, 2.6);       // wheelhouse
            translate([7, 0, deck_z + 17.2]) hull() {                      // roof
                translate([0, 0, -1.4]) slab(11.5, 11, 0.1, 2.6);
                slab(15, 14.2, 0.9, 3.2);
                translate([0, 0, 2.2]) slab(8, 7, 0.2, 2.6);
            }
        }
        translate([7, 0, deck_z + 8.6]) slab(8.8, 8.3, 8.0, 1.6);          // room inside, bridged by the roof
        for (x = [4.1, 9.0]) translate([x, 0, deck_z + 10.6]) rotate([90, 0, 0]) window(3.2, 4.6);
        for (y = [-2.6, 2.6]) translate([12, y, deck_z + 10.6]) rotate([90, 0, 90])
            intersection() { window(3.4, 4.6); cube([10, 20, 8], center = true); }
        for (s = [-1, 1], x = [-3.5, 1.5, 6.5]) translate([x, s*7, deck_z + 3.9]) rotate([90, 0, 0])
            cylinder(d = 2.8, h = 2.2, center = true);                     // deckhouse ports
        translate([-7.6, 0, deck_z + 0.2]) rotate([90, 0, 90])             // door
            intersection() { window(3.6, 5.6); cube([10, 20, 2], center = true); }
    }
}

module funnel() {
    difference() {
        union() {
            multmatrix([[1, 0, -0.16, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) translate([-3.2, 0, deck_z + 7]) {
                cylinder(d = 6.4, h = 12.5);
                translate([0, 0, 7.0]) { cylinder(d1 = 6.4, d2 = 7.4, h = 0.5); translate([0, 0, 0.5]) cylinder(d = 7.4, h = 1.6);
                    translate([0, 0, 2.1]) cylinder(d1 = 7.4, d2 = 6.4, h = 0.5); }
            }
        }
        multmatrix([[1, 0, -0.16, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
            translate([-3.2, 0, deck_z + 11]) cylinder(d = 3.8, h = 20);
    }
}

module bollard(h) { cylinder(d = 2.4, h = h + 0.6); translate([0, 0, h]) { cylinder(d1 = 2.4, d2 = 3.4, h = 0.5); translate([0, 0, 0.5]) cylinder(d1 = 3.4, d2 = 2.4, h = 0.7); } }

module fittings() {
    translate([-15.5, 0, deck_z - 0.3]) {                                  // towing bitts
        for (s = [-1, 1]) translate([0, s*2.8, 0]) bollard(4.6);
        translate([0, 0, 2.9]) cube([1.6, 8.4, 1.4], center = true);
    }
    for (s = [-1, 1]) translate([-22, s*4.6, deck_z - 0.3]) bollard(2.6);
    translate([19.4, 0, deck_z - 0.3]) bollard(4.6);
    translate([7, 0, deck_z + 19]) cylinder(d1 = 2.6, d2 = 1.6, h = 9);    // mast and its lamp
    translate([7, 0, deck_z + 24.2]) { cylinder(d1 = 1.6, d2 = 3, h = 0.8); translate([0, 0, 0.8]) cylinder(d = 3, h = 0.8); }
}

hull_body();
tyres();
cabin();
funnel();
fittings();
