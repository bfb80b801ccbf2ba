// The solids that a hot end is drawn with.
#pragma once

#include "base/names.h"
#include "trace/intersector.h"

#include <memory>
#include <string_view>
#include <vector>

namespace stratum::assemble {

enum class HotEndShape {
    slender,  ///< no printer's: 27 mm high and 15 mm wide, so that a print stays in sight
    v6,       ///< E3D V6: 62.3 mm high
    volcano,  ///< E3D V6 with a Volcano block and nozzle: 70.8 mm high
};
inline constexpr Names<HotEndShape, 3> kHotEndShapes = {
    {{"slender", HotEndShape::slender}, {"v6", HotEndShape::v6}, {"volcano", HotEndShape::volcano}}};

/// A solid of closed form.
struct HotEndPart {
    std::shared_ptr<const trace::Intersector> solid;  ///< mm, from the middle of the nozzle's tip
    std::string_view metal;                           ///< for shade::makeBrdf()
};

/// From the tip upwards. Lengths of V6 and Volcano: from public models of the maker's drawings (wiki.e3d-online.com,
/// "E3D-v6 Documentation" and "E3D-v6 (Volcano) Documentation"), not from the drawings themselves; holes, threads,
/// wires and the fan are left out, and the cone of the heat sink's core is a cylinder of its mean diameter.
std::vector<HotEndPart> makeHotEndParts(HotEndShape shape);

}  // namespace stratum::assemble
