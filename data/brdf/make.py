"""Writes the tables of filament materials: MODELS, NOT MEASUREMENTS.

Each is what a surface of pigmented plastic should look like by textbook optics: a rough dielectric interface over a body
that scatters, at the angles a Mini-Diff scatterometer would have been set to (0, 20, 40 and 60 degrees, three
wavelengths), in its text format. Nothing here was measured on a filament.

  interface  Fresnel reflectance of the index of refraction, GGX facets of roughness alpha with height-correlated
             masking (Walter et al., EGSR 2007; Heitz, JCGT 2014).
  body       Lambert below the interface: light passes it twice and is partly reflected back inside (Saunderson, JOSA
             1942): rho T(i) T(o) / (1 - Ri rho). T is what the rough interface does not reflect of a direction (that of
             a smooth one would be too little at grazing angles), Ri the diffuse reflectance from inside.
  silk       gloss additives are modelled as a second, broader, coloured lobe of flakes below the interface.

Indices of refraction at 589 nm: PLA 1.465 (Hutchinson et al., "Optical properties of polylactides", J. Polym. Environ.
2006), PETG 1.57 (suppliers' data sheets of PETG, 1.567 to 1.57). Colours: makers' hex codes as collected in SpoolmanDB
(MIT), taken as the total reflectance in sRGB. Roughness: alpha 0.10 to 0.25, chosen to look like the flank of a bead
(PETG glossier than PLA); a guess, as no published measurement of a single bead was found.

python3 make.py [FOLDER]   writes NAME.bsdf.gz for all materials, always the same bytes.
"""

import gzip
import io
import math
import sys
from pathlib import Path

FOLDER = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent)
INCIDENCES = (0.0, 20.0, 40.0, 60.0)
AZIMUTHS = [10.0 * i for i in range(37)]
RADIALS = [2.0 * i for i in range(46)]
WAVELENGTHS = (630, 525, 465)
MATERIALS = {  # index of refraction, colour, alpha, where the colour is from; silk: share and alpha of the flakes
    "pla-blue": (1.465, "003776", 0.20, "Polymaker Panchroma Regular Blue", None),
    "pla-green": (1.465, "06924D", 0.20, "Polymaker Panchroma Regular Green", None),
    "pla-red": (1.465, "E72F1D", 0.20, "Polymaker Panchroma Regular Red", None),
    "pla-white": (1.465, "E2DEDB", 0.22, "Polymaker Panchroma Regular White", None),
    "pla-yellow": (1.465, "F3B400", 0.20, "Polymaker Panchroma Regular Yellow", None),
    "petg-black": (1.57, "101820", 0.12, "Polymaker PolyLite PETG Black", None),
    "petg-orange": (1.57, "FF671F", 0.12, "Polymaker PolyLite PETG Orange", None),
    "silk-pink": (1.465, "EEB1C1", 0.15, "Bambu Lab Silk Pink", (0.45, 0.35)),
}


def linear(byte):
    c = byte / 255.0
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def fresnel(cosine, eta):
    t2 = 1.0 - (1.0 - cosine * cosine) / (eta * eta)
    if t2 <= 0.0:
        return 1.0
    t = math.sqrt(t2)
    a = (eta * cosine - t) / (eta * cosine + t)
    b = (cosine - eta * t) / (cosine + eta * t)
    return 0.5 * (a * a + b * b)


def facets(alpha, i, o):
    """D G2 / (4 cos cos), and the cosine to the facet."""
    h = [a + b for a, b in zip(i, o)]
    length = math.sqrt(sum(a * a for a in h))
    h = [a / length for a in h]
    a2 = alpha * alpha
    k = a2 * h[2] ** 2 + h[0] ** 2 + h[1] ** 2
    lam = lambda w: math.sqrt(w[2] ** 2 + a2 * (1.0 - w[2] ** 2))
    visible = 0.5 / max(lam(o) * i[2] + lam(i) * o[2], 1e-9)
    return a2 / (math.pi * k * k) * visible, sum(a * b for a, b in zip(h, i))


def direction(polar, azimuth):
    p, a = math.radians(polar), math.radians(azimuth)
    return math.sin(p) * math.cos(a), math.sin(p) * math.sin(a), max(math.cos(p), 1e-4)


def interface_albedo(cosine, eta, alpha):
    """Share of the light of a direction that the rough interface reflects: facets that are seen from there, by the
    distribution of visible normals (Heitz, JCGT 2018), with the masking of what leaves them."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    x, z = alpha * sine, cosine
    length = math.hypot(x, z)
    x, z = x / length, z / length
    steps = 48
    total = 0.0
    for a in range(steps):
        r = math.sqrt((a + 0.5) / steps)
        for b in range(steps):
            phi = 2.0 * math.pi * (b + 0.5) / steps
            t1, t2 = r * math.cos(phi), r * math.sin(phi)
            s = 0.5 * (1.0 + z)
            t2 = (1.0 - s) * math.sqrt(1.0 - t1 * t1) + s * t2
            up = math.sqrt(max(1.0 - t1 * t1 - t2 * t2, 0.0))
            h = (alpha * (up * x - t2 * z), alpha * t1, max(up * z + t2 * x, 1e-9))
            norm = math.sqrt(sum(v * v for v in h))
            h = [v / norm for v in h]
            c = max(sine * h[0] + cosine * h[2], 0.0)
            out = 2.0 * c * h[2] - cosine
            if out > 0.0:
                lam = lambda w: 0.5 * (math.sqrt(1.0 + alpha * alpha * (1.0 / (w * w) - 1.0)) - 1.0)
                total += fresnel(c, eta) * (1.0 + lam(cosine)) / (1.0 + lam(cosine) + lam(out))
    return total / steps**2


class Interface:
    """What a rough interface lets through: of directions, by linear interpolation of 181 cosines, and of diffuse light."""

    def __init__(self, eta, alpha):
        n = 180
        self.through = [1.0 - interface_albedo(max(k / n, 1e-4), eta, alpha) for k in range(n + 1)]
        self.out = sum(self.of((k + 0.5) / n) * 2.0 * (k + 0.5) / n / n for k in range(n))
        self.inner = 1.0 - self.out / (eta * eta)  # by reciprocity

    def of(self, cosine):
        place = min(cosine, 1.0) * (len(self.through) - 1)
        k = min(int(place), len(self.through) - 2)
        return self.through[k] + (place - k) * (self.through[k + 1] - self.through[k])


def brdf(material, interface, channel, i, o):
    eta, colour, alpha, _, silk = material
    gloss, cosine = facets(alpha, i, o)
    ri = interface.inner
    # The pigment's own reflectance, of which the colour is what leaves the plastic again.
    total = linear(int(colour[2 * channel : 2 * channel + 2], 16))
    rho = min(total / (interface.out * (1.0 - ri) + ri * total), 0.97)  # no pigment reflects all of it
    through = interface.of(i[2]) * interface.of(o[2])
    body = rho * through / (eta * eta * math.pi * (1.0 - ri * rho))
    if silk is not None:
        share, flake_alpha = silk
        flakes, _ = facets(flake_alpha, i, o)
        body = (1.0 - share) * body + share * total * through * flakes
    return fresnel(cosine, eta) * gloss + body


def table(name):
    material = MATERIALS[name]
    eta, colour, alpha, source, _ = material
    interface = Interface(eta, alpha)
    out = io.StringIO()
    out.write("# MODEL, NOT A MEASUREMENT: computed by data/brdf/make.py from optical constants\n")
    out.write(f"# {name}: eta {eta}, colour #{colour} ({source}), GGX alpha {alpha}\n")
    out.write("Source\tModel\nSymmetry\tAsymmetric\nSpectralContent\tMonochrome\n")
    out.write(f"ScatterAzimuth\t{len(AZIMUTHS)}\n" + "\t".join(f"{a:g}" for a in AZIMUTHS) + "\n")
    out.write(f"ScatterRadial\t{len(RADIALS)}\n" + "\t".join(f"{r:g}" for r in RADIALS) + "\nDataBegin\n")
    for incidence in INCIDENCES:
        light = direction(incidence, 0.0)
        for channel, wavelength in enumerate(WAVELENGTHS):
            rows = [[brdf(material, interface, channel, light, direction(r, a)) for r in RADIALS] for a in AZIMUTHS]
            tis = 0.0
            for row in rows[:-1]:
                for r, value in zip(RADIALS, row):
                    step = math.radians(2.0) * (0.5 if r in (0.0, 90.0) else 1.0) * math.radians(10.0)
                    tis += value * math.sin(math.radians(r)) * math.cos(math.radians(r)) * step
            out.write(f"\nAOI {incidence:g}\nPOI 0\nSide Front\nWavelength {wavelength}\nScatterType BRDF\nTIS {tis:.6f}\n")
            for row in rows:
                out.write("\t".join(f"{value:.4g}" for value in row) + "\n")
    out.write("DataEnd\n")
    return out.getvalue()


for name in MATERIALS:
    with open(FOLDER / f"{name}.bsdf.gz", "wb") as file:
        with gzip.GzipFile(filename="", mode="wb", fileobj=file, mtime=0, compresslevel=9) as packed:
            packed.write(table(name).encode())
    print(f"{name}.bsdf.gz: {(FOLDER / f'{name}.bsdf.gz').stat().st_size} bytes")
