#include "convert/elements_output.h"

#include "progress.h"

#include "base/error.h"
#include "base/human_text.h"
#include "base/text.h"
#include "gcode/toolpath/purpose.h"
#include "mechanics/elastic.h"
#include "mechanics/inp_file.h"
#include "mechanics/pieces.h"
#include "voxelize/grid/solid_check.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kMostNodes = std::size_t{1} << 31;

// More or less of the plastic than this share is a warning.
constexpr double kDoubt = 0.05;

std::string doubtOf(const mechanics::SolidElements& elements, const mechanics::Pieces& pieces,
                    const std::string& source) {
    const double kept = elements.volume() / elements.plastic;
    if (std::abs(kept - 1) <= kDoubt) return {};
    std::string text = fmt::format("{}: the elements hold {:.1f} % of the plastic", source, 100 * kept);
    if (kept > 1)
        text += fmt::format("; elements of {:g} mm are wider than walls; choose a smaller --voxel-size", elements.edge);
    else if (pieces.removed > 0)
        text += fmt::format("; {} pieces beside the largest are left out; --all-pieces keeps them", pieces.count - 1);
    return text;
}

}  // namespace

bool isElementsPath(const fs::path& path) {
    return lowerCase(path.extension().string()) == ".inp" || lowerCase(path.string()) == "-.inp";
}

void addElementOptions(CLI::App& app, ElementOptions& options) {
    const char* elements = "Elements (-o part.inp)";
    app.add_option("--elastic", options.elastic,
                   "Also a material: Young's modulus in MPa and Poisson's ratio, or nine engineering constants whose "
                   "first axis is along the beads (default: elements and sets alone)")
        ->type_name("E[,NU]|E1,...,G23")
        ->group(elements);
    app.add_option("--max-nodes", options.most_nodes, "Refuse more nodes than these (default 5000000)")
        ->check(CLI::Range(std::size_t{8}, kMostNodes))
        ->type_name("N")
        ->group(elements);
    app.add_flag("--all-pieces", options.all_pieces,
                 "Keep what no face joins to the part's largest piece, e.g. skirts and the other parts of a plate")
        ->group(elements);
}

void checkElementOptions(const ConvertCommand& o, const fs::path& output) {
    if (!isElementsPath(output)) {
        if (o.elements.all_pieces || !o.elements.elastic.empty())
            throw UsageError(fmt::format("{}: is for elements; write an .inp, not {}",
                                         o.elements.all_pieces ? "--all-pieces" : "--elastic", output.string()));
        return;
    }
    const auto refuse = [&output](const char* option, const char* why) {
        throw UsageError(fmt::format("{}: {} has {}; leave it out, or write a .vdb", option, output.string(), why));
    };
    if (!o.grids.empty()) refuse("--grids", "sets of layers, features and tools instead of grids");
    if (!o.snapshots.empty()) refuse("--snapshots", "one state of the print: choose it with --layers");
    if (!o.interior.empty()) refuse("--interior", "all solid elements");
    if (o.interior_distance) refuse("--interior-distance", "no distances");
    if (o.unit != "mm") refuse("--unit", "the solver's units, mm, N and MPa");
    if (o.up != "z") refuse("--up", "axes as printed");
    if (!o.elements.elastic.empty()) mechanics::parseElastic(o.elements.elastic);
}

Json writeElements(const ConvertCommand& o, const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                   const voxelize::Lattice& lattice, const voxelize::Placement& placement, const std::string& source,
                   const fs::path& output) {
    mechanics::SolidElements elements;
    {
        ProgressBar bar("elements", o.common.quiet);
        elements = mechanics::solidElements(toolpath, selection, lattice, {o.elements.most_nodes, bar.callback()});
    }
    mechanics::Pieces pieces;
    if (!o.elements.all_pieces) {
        const std::vector<gcode::Purpose> purposes = gcode::purposesOf(toolpath);
        pieces = mechanics::keepLargestPiece(
            elements, [&purposes](std::uint32_t bead) { return purposes[bead] == gcode::Purpose::part; });
    }
    const mechanics::Hexahedra mesh = mechanics::hexahedraOf(elements, o.elements.most_nodes);
    mechanics::InpOptions options;
    if (!o.elements.elastic.empty()) options.elastic = mechanics::parseElastic(o.elements.elastic);
    options.placement = placement;
    options.source = source;
    mechanics::InpReport report;
    {
        const ProgressNote note("writing", o.common.quiet);
        report = mechanics::writeInp(elements, mesh, toolpath, options, output);
    }
    const double laid = voxelize::depositedVolume(toolpath, selection);
    say(o.common,
        fmt::format("  {}: {} elements of {:g} mm, {} nodes, {} sets; {:.4g} cm3, {:.1f} % of the solid of the beads",
                    output.string(), humanCount(static_cast<double>(mesh.corners.size())), elements.edge,
                    humanCount(static_cast<double>(mesh.nodes.size())), report.element_sets + report.node_sets,
                    elements.volume() * 1e-3, 100 * elements.volume() / elements.plastic));
    if (pieces.removed > 0)
        say(o.common,
            fmt::format("  the largest of {} pieces; {} elements of the others are left out (--all-pieces keeps them)",
                        pieces.count, pieces.removed));
    if (const std::string doubt = doubtOf(elements, pieces, source); !doubt.empty() && !o.common.quiet)
        tellError(fmt::format("gcode2vdb: {}\n", doubt));
    return {{"path", output.string()},
            {"bytes", fs::is_regular_file(output) ? fs::file_size(output) : 0},
            {"elements", mesh.corners.size()},
            {"nodes", mesh.nodes.size()},
            {"edge_mm", elements.edge},
            {"solid_mm3", elements.plastic},
            {"written_mm3", elements.volume()},
            {"deposited_mm3", laid},
            {"pieces", o.elements.all_pieces ? Json(nullptr) : Json(pieces.count)},
            {"removed_elements", pieces.removed},
            {"element_sets", report.element_sets},
            {"node_sets", report.node_sets},
            {"directions", report.directions}};
}

}  // namespace stratum::tools
