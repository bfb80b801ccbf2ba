// gear.scad -- a herringbone spur gear with true involute flanks.
//
// What it exercises: many short arcs and sharp corners on the outline, teeth
// that turn a little every layer and then turn back, round holes of three
// sizes, a keyed bore, a raised hub, and large solid areas whose infill runs
// from edge to edge. Sliced with a skirt and a brim.

teeth    = 16;
module_  = 2.4;     // pitch diameter per tooth, mm
pressure = 20;      // pressure angle, degrees
height   = 7.2;       // of the rim; the hub is 2.4 mm higher
helix    = 9;       // degrees of turn over half the height
bore     = 7;
S        = 3;       // points on each flank

rp = teeth*module_/2;             // pitch radius
rb = rp*cos(pressure);            // base radius
ra = rp + module_;                // tip radius
rf = rp - 1.2*module_;            // root radius

deg = 180/PI;
function inv(r) = let (c = acos(min(1, rb/r))) tan(c)*deg - c;         // involute angle at radius r
half = 90/teeth + inv(rp) - 0.25;                                        // half tooth angle at the base circle, less backlash
function flank(s) = [for (k = [0:S]) let (r = max(rb, rf) + (ra - max(rb, rf))*k/S, a = half - inv(r)) r*[cos(s*a), sin(s*a)]];
function tooth(n) = let (w = 360*n/teeth, rot = [[cos(w), -sin(w)], [sin(w), cos(w)]])
    [for (p = concat([rf*[cos(-half - 0.6), sin(-half - 0.6)]], flank(-1),
                     [for (k = [S:-1:0]) flank(1)[k]], [rf*[cos(half + 0.6), sin(half + 0.6)]])) rot*p];

module outline() { polygon([for (n = [0:teeth-1]) each tooth(n)]); }

module cutouts() {
    circle(d = bore, $fn = 28);
    translate([bore/2, 0]) square([2.4, 2.2], center = true);           // keyway
    for (k = [0:5]) rotate(60*k + 30) translate([11.2, 0]) circle(d = 6.4, $fn = 16);
    for (k = [0:5]) rotate(60*k) translate([13.0, 0]) circle(d = 2.4, $fn = 8);
}

module half_gear(s) { linear_extrude(height/2, twist = s*helix, slices = 5, convexity = 10) outline(); }

difference() {
    union() {
        rotate(helix) half_gear(1);
        translate([0, 0, height/2]) half_gear(-1);
        cylinder(d = 14.5, h = height + 2.4, $fn = 36);                    // hub
    }
    translate([0, 0, -1]) linear_extrude(height + 6, convexity = 10) cutouts();
    difference() {                                                       // dished face
        translate([0, 0, height - 2]) cylinder(r = rf - 2.0, h = 3, $fn = 48);
        cylinder(d = 14.5, h = height + 4, $fn = 36);
    }
    translate([0, 0, height + 1.6]) difference() {                       // chamfer on the hub
        cylinder(d = 20, h = 2, $fn = 36);
        translate([0, 0, -0.01]) cylinder(d1 = 14.5, d2 = 12.5, h = 1, $fn = 36);
    }
}
