// knot.scad -- a trefoil knot of rope, lying down, its underside cut flat.
//
// What it exercises: one closed tube that passes over and under itself, with
// no vertical wall anywhere; islands that meet and part again as the layers
// rise; steep overhangs, and so supports, which the slicer adds under the
// three crossings. The rope's strands show as grooves that wind around.

size  = 6.2;    // scale of the curve, mm
lift  = 4.6;    // rise and fall of the curve, mm
tube  = 3.7;    // mean radius of the rope
lobes = 3;      // strands
turns = 13;     // thirds of a turn that the strands make along the knot
P     = 120;    // sections along the curve
Q     = 24;     // points around the tube, a multiple of lobes
sink  = 1.2;    // depth cut off below, so that it sits on the bed

function c(t)  = [size*(sin(t) + 2*sin(2*t)), size*(cos(t) - 2*cos(2*t)), -lift*sin(3*t)];
function d(t)  = [size*(cos(t) + 4*cos(2*t)), size*(-sin(t) + 4*sin(2*t)), -3*lift*cos(3*t)];
function unit(v) = v/norm(v);
function side(t) = unit(cross(d(t), [0, 0, 1]));        // level, to the right
function up(t)   = unit(cross(side(t), d(t)));
function rr(a)   = tube*(0.84 + 0.21*pow(abs(sin(lobes*a/2)), 0.8));
// the points follow the strands, so that the grooves stay smooth
function pt(t, q) = let (a = 360*q/Q, w = a + turns*t/lobes) c(t) + rr(a)*(cos(w)*side(t) + sin(w)*up(t));
// after one round the strands have moved on by this many points
shift = (turns*Q/lobes) % Q;
function id(p, q) = p < P ? p*Q + q % Q : (q + shift) % Q;

translate([0, 0, lift + tube - sink]) difference() {
    polyhedron(
        points = [for (p = [0:P-1]) for (q = [0:Q-1]) pt(360*p/P, q)],
        faces = [for (p = [0:P-1]) for (q = [0:Q-1])
            let (a = id(p, q), b = id(p, q + 1), e = id(p + 1, q), f = id(p + 1, q + 1))
            each [[a, b, e], [b, f, e]]],
        convexity = 10);
    translate([0, 0, -50 - lift - tube + sink]) cube([200, 200, 100], center = true);
}
