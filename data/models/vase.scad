// vase.scad -- a fluted vase whose flutes lean one way and then the other.
//
// What it exercises: spiral vase mode. The model is solid; the slicer keeps
// only its outer skin as one continuous wall whose z rises all along the turn,
// so that no layer is flat above the bottom. The sides lean out and in
// (overhang up to about 35 degrees) and no two layers are alike.

R      = 16.5;  // mean radius
H      = 54;    // height
flutes = 12;
depth  = 1.7;   // depth of the flutes
M      = 120;   // points around
K      = 90;    // rings, bottom to top

function belly(t) = R * (0.80 + 0.32*sin(180*pow(t, 0.85)) - 0.26*pow(sin(180*pow(t, 2.6)), 2) + 0.24*pow(t, 6));
function lean(t)  = 30*sin(175*t);                       // degrees of twist at height t
function flute(t) = depth * (0.30 + 0.70*sin(160*t + 15));
function r(a, t)  = belly(t) + flute(t)*(pow(abs(sin(flutes*a/2)), 0.8) - 0.5);

polyhedron(
    points = [for (k = [0:K]) let (t = k/K) for (i = [0:M-1]) let (a = 360*i/M)
        [r(a, t)*cos(a + lean(t)), r(a, t)*sin(a + lean(t)), H*t]],
    faces = concat(
        [[for (i = [0:M-1]) i]],
        [for (k = [0:K-1]) for (i = [0:M-1]) let (a = k*M + i, b = k*M + (i+1)%M)
            each [[a, a + M, b], [b, a + M, b + M]]],
        [[for (i = [M-1:-1:0]) K*M + i]]),
    convexity = 8);
