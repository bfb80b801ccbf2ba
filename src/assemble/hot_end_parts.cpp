#include "assemble/hot_end_parts.h"

#include "trace/convex_solid.h"

namespace stratum::assemble {
namespace {

// Reflectances at normal incidence: brass, aluminium and iron as in "Physically Based" (physicallybased.info, 2023).
constexpr std::string_view kBrass = "metal:0.91,0.78,0.42,0.25";
constexpr std::string_view kAluminium = "metal:0.91,0.92,0.92,0.35";
constexpr std::string_view kSteel = "metal:0.53,0.51,0.49,0.3";

HotEndPart cylinder(double low, double height, double diameter, std::string_view metal) {
    return {trace::makeConeSolid(low, 0.5 * diameter, low + height, 0.5 * diameter), metal};
}

std::vector<HotEndPart> slender() {
    return {{trace::makeConeSolid(0, 0.5, 3, 3.0), kBrass},
            {trace::makeHexagonSolid(7, 3, 6), kBrass},
            {trace::makeBoxSolid({-6, -6, 6}, {9, 6, 14}), kSteel},
            cylinder(14, 3, 3.2, kSteel),
            cylinder(17, 10, 10, kAluminium)};
}

// Heat break and heat sink of a V6, above a block that ends at `block_top`.
void addColdEnd(std::vector<HotEndPart>& parts, double block_top) {
    constexpr double kGap = 2.1;  // of the heat break, which is free there
    constexpr int kFins = 11;
    constexpr double kFinPitch = 2.5;
    const double sink = block_top + kGap;
    parts.push_back(cylinder(block_top, kGap, 2.96, kSteel));
    parts.push_back(cylinder(sink, 30, 9, kAluminium));
    for (int fin = 0; fin < kFins; ++fin)
        parts.push_back(cylinder(sink + fin * kFinPitch, 1, fin == 0 ? 22.3 : 22.0, kAluminium));
    parts.push_back(cylinder(sink + 27.5, 1, 16, kAluminium));
    // The groove that it is held by.
    parts.push_back(cylinder(sink + 30, 3, 16, kAluminium));
    parts.push_back(cylinder(sink + 33, 6, 12, kAluminium));
    parts.push_back(cylinder(sink + 39, 3.7, 16, kAluminium));
}

std::vector<HotEndPart> v6() {
    std::vector<HotEndPart> parts = {{trace::makeConeSolid(0, 0.5, 2, 2.5), kBrass},
                                     {trace::makeHexagonSolid(7, 2, 5), kBrass},
                                     cylinder(5, 1, 5, kBrass),
                                     {trace::makeBoxSolid({-15, -8, 6}, {8, 8, 17.5}), kAluminium}};
    addColdEnd(parts, 17.5);
    return parts;
}

std::vector<HotEndPart> volcano() {
    std::vector<HotEndPart> parts = {{trace::makeConeSolid(0, 0.5, 3, 3.0), kBrass},
                                     {trace::makeHexagonSolid(7, 2, 5), kBrass},
                                     cylinder(5, 2, 5, kBrass),
                                     {trace::makeBoxSolid({-4.5, -4.5, 6}, {7, 15.5, 24.5}), kAluminium},
                                     {trace::makeBoxSolid({-4.5, -4.5, 24.5}, {7, 7.5, 26}), kAluminium}};
    addColdEnd(parts, 26);
    return parts;
}

}  // namespace

std::vector<HotEndPart> makeHotEndParts(HotEndShape shape) {
    switch (shape) {
        case HotEndShape::v6:
            return v6();
        case HotEndShape::volcano:
            return volcano();
        case HotEndShape::slender:
            break;
    }
    return slender();
}

}  // namespace stratum::assemble
