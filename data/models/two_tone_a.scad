// two_tone_a.scad -- medallion "sun over waves", first part: the disc.
//
// What it exercises: together with two_tone_b.scad, a print with two tools.
// Both parts are in the same coordinates and fit without gap or overlap: the
// disc has the picture sunk into it, two_tone_b.scad fills it and stands a
// little proud. The disc has a reeded edge, a raised rim and a ring to hang it by.

dia    = 40;
thick  = 3.0;    // disc, without the rim
sunk   = 1.2;    // depth of the inlay
proud  = 0.6;    // how far it stands above the disc
$fn    = 72;

module wave(y, amp, w, len = 50) { // a band w wide along a sine
    polygon(concat([for (x = [-len/2 : 1.25 : len/2]) [x, y + amp*sin(x*360/11.5)]],
                   [for (x = [len/2 : -1.25 : -len/2]) [x, y - w + amp*sin(x*360/11.5)]]));
}

module sun() {
    circle(r = 6.6);
    for (k = [1:11]) let (out = k % 2 == 0 ? 6.6 : 4.4)
        rotate(15*k) translate([8.4, 0]) polygon([[0, -0.75], [out, -1.05], [out + 1, 0], [out, 1.05], [0, 0.75]]);
}

module picture() { // flat shape of the inlay
    offset(0.35, $fn = 16) offset(-0.35) intersection() {                            // the offsets drop slivers
        circle(d = dia - 6.4);
        union() {
            difference() { translate([0, 0.5]) sun(); wave(1.5, 1.1, 40); }
            for (k = [0:2]) wave(0.2 - 5*k, 1.1, 2.9 - 0.2*k);
        }
    }
}

module disc() {
    difference() {
        union() {
            cylinder(d = dia - 1.6, h = thick + 0.6);
            for (k = [0:35]) rotate(10*k) translate([dia/2 - 1.0, 0, 0]) cylinder(d = 2, h = thick + 0.6, $fn = 12);
            translate([0, dia/2 + 1.4, 0]) cylinder(d = 8, h = thick, $fn = 48);
        }
        translate([0, dia/2 + 2.2, -1]) cylinder(d = 4, h = thick + 4, $fn = 40);
        translate([0, 0, thick]) cylinder(d = dia - 4.8, h = 2);
        translate([0, 0, thick - sunk]) linear_extrude(5, convexity = 8) picture();
    }
}

module inlay() { translate([0, 0, thick - sunk]) linear_extrude(sunk + proud, convexity = 8) picture(); }

disc();
