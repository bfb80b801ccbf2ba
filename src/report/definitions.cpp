#include "report/definitions.h"

#include <array>

namespace stratum::report {
namespace {

constexpr std::string_view kMaterial = "Material, cost and time";
constexpr std::string_view kVolume = "Volume and porosity";
constexpr std::string_view kMass = "Balance";
constexpr std::string_view kWalls = "Walls and surface";
constexpr std::string_view kSupport = "What layers rest on";

constexpr std::array kNumbers{
    Definition{"time", kMaterial, "Time to print", "s",
               "The machine's motion of the whole program by its limits, travel included; heating and homing are not."},
    Definition{"mass", kMaterial, "Mass", "g", "Deposited volume times density, tool by tool."},
    Definition{"cost", kMaterial, "Cost of the filament", "",
               "Mass times price, tool by tool; in the currency of the price."},
    Definition{
        "filament_length", kMaterial, "Filament", "mm",
        "What the beads take of the filament as the file counts it; of a selection, in proportion to its volume."},
    Definition{"deposited_volume", kVolume, "Deposited volume", "mm^3",
               "What was fed: the sum of all beads, section area times length. Overlaps count twice."},
    Definition{"plastic_volume", kVolume, "Plastic volume", "mm^3",
               "The union of the beads, from their heights over 400 points a mm^2 of the plan (fewer where layers are "
               "higher than 0.4 mm): the same for every voxel size."},
    Definition{
        "enclosed_volume", kVolume, "Enclosed volume", "mm^3",
        "Plastic and pores: the outer hull, filled. The outside is what a ball reaches from around the part whose "
        "radius is half the height of a layer (half a voxel if that is more, and at most what the band of the level "
        "set tells), and the grooves that it touches: grooves between layers are outside, gaps too narrow for the "
        "ball are pores. No less than the plastic."},
    Definition{"porosity", kVolume, "Porosity", "%",
               "What of the enclosed volume is not plastic; infill's hollows are pores."},
    Definition{"open_porosity", kVolume, "Open porosity", "%",
               "Pores that are joined to the outside by gaps of any width that the voxels resolve, as a share of the "
               "enclosed volume. Channels between beads join most of them: a print is not airtight."},
    Definition{"closed_porosity", kVolume, "Closed porosity", "%",
               "Pores without such a way out, as a share of the enclosed volume."},
    Definition{"center_of_mass", kMass, "Centre of mass", "mm",
               "x, y and z of the plastic's centroid, in the coordinates of the G-code; density is taken as uniform."},
    Definition{
        "inertia", kMass, "Inertia tensor", "g mm^2",
        "About the centre of mass, axes of the G-code: integrals of density times (r^2 I - r r^T) over the plastic, "
        "with its mean density."},
    Definition{"inertia_of_volume", kMass, "Inertia tensor of the volume", "mm^5",
               "The same for a density of 1: times a density in g/mm^3 it is the inertia tensor."},
    Definition{"thinnest_wall", kWalls, "Thinnest wall", "mm",
               "Across the middle of each bead with the outside beside it, at half of its height: the least length of "
               "plastic in a row. Not of skirts, brims, supports and prime towers."},
    Definition{"outer_surface", kWalls, "Outer surface", "mm^2",
               "Area of the plastic's surface that the outside reaches, with the grooves between layers."},
    Definition{"inner_surface", kWalls, "Inner surface", "mm^2", "Area of the plastic's surface towards pores."},
    Definition{
        "roughness_ra", kWalls, "Roughness Ra of walls", "um",
        "Up outer walls, along vertical lines at even distances along the outer perimeters: mean absolute deviation "
        "from the least squares line of each sampling length (0.25, 0.8 or 2.5 mm by layer height, whole layers, up "
        "to five a line), without another filter. Mean of all lines. The model's beads have smooth sides: it is the "
        "part of the layers alone."},
    Definition{"roughness_rz", kWalls, "Roughness Rz of walls", "um",
               "On the same lines: highest peak to lowest valley of each sampling length. Mean of all lines."},
    Definition{"bed_contact", kSupport, "Contact with the bed", "mm^2",
               "Area of the flat undersides of beads that lie on z = 0."},
    Definition{"bed_outline", kSupport, "Outline on the bed", "mm^2",
               "Area of the plan that beads lying on the bed cover at their widest."},
    Definition{
        "bonding_least", kSupport, "Least bonding of a layer", "%",
        "The least over all layers above the bed of the layer's area that rests on the layer below, as a share of its "
        "area; areas are of the plan, of beads at their widest."},
    Definition{"bonding_mean", kSupport, "Mean bonding", "%", "The same share of all layers above the bed together."},
    Definition{"unsupported", kSupport, "Unsupported area", "mm^2",
               "Area of the plan, summed over all layers above the bed, with nothing directly below: overhangs of any "
               "angle and "
               "bridges, inside too."},
    Definition{
        "overhang_45", kSupport, "Overhanging beyond 45 degrees", "mm^2",
        "Of the unsupported area, what is farther beyond the layer below than its height times tan 45: a cone of that "
        "angle from the vertical does not carry it."},
    Definition{"overhang_60", kSupport, "Overhanging beyond 60 degrees", "mm^2", "The same for tan 60."},
    Definition{"overhang_75", kSupport, "Overhanging beyond 75 degrees", "mm^2",
               "The same for tan 75: bridges, and starts in the air."},
};

constexpr std::array kLayers{
    Definition{"deposited_volume", kMaterial, "Deposited volume", "mm^3", "What was fed in the layer."},
    Definition{"time", kMaterial, "Time", "s", "Of the layer, with the travel before its beads."},
    Definition{"bonding", kSupport, "Bonding", "%",
               "Share of the layer's area that rests on the layer below; none for layers on the bed."},
    Definition{
        "touching", kSupport, "Touching flats", "%",
        "Share of the layer's area where flat undersides of beads touch flat tops of beads below. Sides of beads are "
        "round, so it is less than the bonding."},
    Definition{"unsupported", kSupport, "Unsupported", "mm^2", "Area of the layer with nothing directly below."},
    Definition{"overhang_45", kSupport, "Beyond 45 degrees", "mm^2",
               "Of it, what a cone of 45 degrees does not carry."},
    Definition{"overhang_75", kSupport, "Beyond 75 degrees", "mm^2",
               "Of it, what a cone of 75 degrees does not carry."},
};

constexpr std::array kSlabs{
    Definition{"plastic_volume", kVolume, "Plastic volume", "mm^3", "Between the layer's planes."},
    Definition{"porosity", kVolume, "Porosity", "%",
               "Pores as a share of what is enclosed between the layer's planes."},
    Definition{"closed_porosity", kVolume, "Closed porosity", "%", "Of it, pores without a way out."},
};

}  // namespace

std::span<const Definition> numberDefinitions() { return kNumbers; }
std::span<const Definition> layerDefinitions() { return kLayers; }
std::span<const Definition> slabDefinitions() { return kSlabs; }

}  // namespace stratum::report
