// Grids of bead attributes: layer, feature, tool, etc. of the bead nearest to each voxel.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::voxelize {

/// One grid each, with the name written here and with the surface's transform and active voxels; a voxel has the value
/// of the bead whose surface is nearest.
enum class Attribute : std::uint8_t {
    layer,     ///< Int32: 1, 2, ...
    time,      ///< float: seconds from the program's start to the bead (Toolpath::timing); without a plan, of extruding
    feature,   ///< Int32: see gcode::Feature; metadata "names" lists them
    tool,      ///< Int32: T number
    object,    ///< Int32: index of the labelled object, 0 is none; metadata "names" lists them
    width,     ///< float: mm
    height,    ///< float: mm, of the bead's section
    speed,     ///< float: mm/s, the bead's length over its time (Toolpath::timing); without a plan, the programmed one
    flow,      ///< float: mm^3/s, mean of the simulated flow (Toolpath::flow); without it, section times speed
    overfill,  ///< float: share of the bead's plastic that has no place in its layer: overfillOfBeads()
    layer_time,        ///< float: seconds that its layer takes, see gcode::layerSeconds()
    temperature,       ///< float: degrees Celsius of the nozzle, as the program asks for them
    fan,               ///< float: per cent, of the fan that cools the part
    acceleration,      ///< float: mm/s^2, as the program asks for it
    pressure_advance,  ///< float: s, of the tool, as the program asks for it
    color,             ///< Vec3f: linear sRGB of the filament from the file's settings, 0.8 gray where it has none
};

constexpr std::size_t kAttributeCount = static_cast<std::size_t>(Attribute::color) + 1;

/// Parses "surface,layer,tool". The surface is always written and may be named. Throws UsageError with the names.
std::vector<Attribute> parseGrids(std::string_view text);
std::string_view attributeName(Attribute attribute);
/// Of all of them.
std::vector<std::string_view> attributeNames();
/// Of a grid of gcode2vdb of that name, `deviation` included: "mm", "mm/s"; empty if it has none.
std::string_view attributeUnit(std::string_view name);
/// Bytes of memory for each leaf of a surface: of the surface and of these grids beside it.
double bytesPerLeaf(std::span<const Attribute> attributes);
/// Whether its values follow from a plan of the motion where there is one.
bool usesTiming(Attribute attribute);

/// The value type of its grid: Int32, float or Vec3f.
enum class AttributeKind : std::uint8_t { integer, number, color };
AttributeKind attributeKind(Attribute attribute);

/// A value of every bead for every attribute; made once, read by all threads.
class BeadAttributes {
public:
    /// `overfill`: overfillOfBeads(); only with Attribute::overfill. Throws InputError if the program never sets a
    /// temperature or a fan that is asked for.
    BeadAttributes(const gcode::Toolpath& toolpath, std::span<const Attribute> attributes,
                   std::vector<float> overfill = {});

    std::int32_t integer(Attribute attribute, std::uint32_t bead) const;
    float number(Attribute attribute, std::uint32_t bead) const {
        return numbers_[static_cast<std::size_t>(attribute)][bead];
    }
    openvdb::Vec3f color(std::uint32_t bead) const;
    /// Of memory.
    std::size_t bytes() const;

private:
    const gcode::Toolpath& toolpath_;
    std::array<std::vector<float>, kAttributeCount> numbers_;  // by attribute and bead; of what was asked for
    std::vector<openvdb::Vec3f> color_;                        // by bead; if asked for, and filaments change
};

/// Empty grids of the right types over the active voxels of `surface`, with names and metadata, in the given order.
std::vector<openvdb::GridBase::Ptr> makeAttributeGrids(const gcode::Toolpath& toolpath,
                                                       std::span<const Attribute> attributes,
                                                       const openvdb::FloatGrid& surface);

/// Fills the leaf of `grid` at `origin`, if there is one: the voxels that have a bead in `ranks`.
void fillLeaf(openvdb::GridBase& grid, Attribute attribute, const openvdb::Coord& origin, const BeadAttributes& values,
              std::span<const std::uint32_t> beads_of_voxels);

}  // namespace stratum::voxelize
