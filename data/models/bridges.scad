// bridges.scad -- a toy castle gatehouse, about 42 x 38 x 38 mm, made of all
// the things that have nothing underneath them.
//
// What it exercises: flat bridges of two lengths (the window heads), a ceiling
// bridged from wall to wall, round arches, round holes lying on their side,
// corbels at 45 degrees, turret caps that lean out at 30, 40, 50 and 60 degrees
// from upright, and battlements that split one layer into many islands.
// No supports: the slicer marks its bridges and overhangs.

W = 30; D = 26; H = 23;   // walls
wall = 1.8;      // four lines of a 0.4 mm nozzle
$fn = 40;

module gate(r) { translate([-r, 0]) square([2*r, 6]); translate([0, 6]) circle(r = r); }

module shell() {
    difference() {
        translate([-W/2, -D/2, 0]) cube([W, D, H]);
        translate([-W/2 + wall, -D/2 + wall, 1.5]) cube([W - 2*wall, D - 2*wall, H - 3.5]);       // room with a flat ceiling
        // gate: a round arch, front and back
        translate([0, 0, 1.5]) rotate([90, 0, 0]) linear_extrude(D + 2, center = true) {
            gate(5);
        }
        // windows in the sides: bridges of 3 and 7 mm
        for (w = [[-6.6, 3], [0, 7], [6.6, 3]]) translate([0, w[0], 14]) cube([W + 2, w[1], 5], center = true);
        for (y = [-5.8, 0, 5.8]) translate([0, y, 6.2]) rotate([0, 90, 0]) cylinder(d = 4.4, h = W + 2, center = true); // lying holes
        // arrow slits above the gate
        for (x = [-8.4, 8.4]) translate([x, 0, 11]) cube([1.6, D + 2, 8], center = true);
        for (x = [-8.4, 8.4]) translate([x, 0, 11]) cube([3.8, D + 2, 1.6], center = true);
        for (x = [-4.2, 0, 4.2]) translate([x, 0, 16.3]) rotate([90, 0, 0]) cylinder(d = 2.8, h = D + 2, center = true);
    }
    // the gate's surround
    difference() {
        translate([0, 0, 1.5]) rotate([90, 0, 0]) linear_extrude(D + 2.4, center = true) {
            gate(6.5); translate([-6.5, -1.5]) square([13, 2]);
        }
        translate([0, 0, 1.5]) rotate([90, 0, 0]) linear_extrude(D + 4, center = true) {
            gate(5);
        }
        translate([0, 0, H/2 + 1.5]) cube([W - 2*wall, D - 2*wall, H], center = true);
    }
}

module walk() { // parapet resting on corbels
    over = 3;
    difference() {
        union() {
            hull() { translate([-W/2, -D/2, H - over]) cube([W, D, 0.1]); translate([-W/2 - over, -D/2 - over, H]) cube([W + 2*over, D + 2*over, 0.1]); }
            translate([-W/2 - over, -D/2 - over, H]) cube([W + 2*over, D + 2*over, 5.5]);
        }
        translate([-W/2, -D/2, H - over - 1]) cube([W, D, over + 1]);
        translate([-W/2 - over + wall, -D/2 - over + wall, H + 0.01]) cube([W + 2*(over - wall), D + 2*(over - wall), 9]);
        for (k = [-1:1]) translate([k*6.4, 0, H + 5]) cube([3, D + 20, 4.4], center = true);
        for (k = [-1:1]) translate([0, k*6, H + 5]) cube([W + 20, 3, 4.4], center = true);
    }
}

module turret(angle) { // eight-sided; its cap leans out by this angle
    d = 9.4; e = 1.7; h = e/tan(angle); $fn = 8;
    rotate(22.5) {
        cylinder(d = d, h = H + 5);
        translate([0, 0, H + 3 - h]) cylinder(d1 = d, d2 = d + 2*e, h = h);
        translate([0, 0, H + 3]) cylinder(d = d + 2*e, h = 3);
        translate([0, 0, H + 6]) cylinder(d1 = d + 2*e, d2 = 1.2, h = 9);
    }
}

shell();
translate([-W/2, -D/2, H - 2]) cube([W, D, 2]);
walk();
translate([-W/2, -D/2]) turret(30);
translate([ W/2, -D/2]) turret(40);
translate([ W/2,  D/2]) turret(50);
translate([-W/2,  D/2]) turret(60);
