// Volume: how much of what was fed the level set holds.
#include "deposit/printer.h"
#include "gcode/container/container.h"
#include "study/cost/own_process.h"
#include "study/deposit/deposit_parts.h"
#include "study/deposit/made_programs.h"
#include "study/deposit/published.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace stratum::study {
namespace {

constexpr const char* kVolumeColumns =
    "print,sha256,layers,beads_are,per_layer,voxel_mm,fed_mm3,laid_mm3,surplus_mm3,surface_mm3,of_fed_percent,"
    "rest_percent";
void asUnion(gcode::ReadOptions&) {}
void asSettled(gcode::ReadOptions& read) { read.deposit.beads = gcode::DepositModel::Beads::settled; }
void asTypical(gcode::ReadOptions& read) { deposit::usePrinter("typical", read); }
void asSettledFlow(gcode::ReadOptions& read) {
    asSettled(read);
    read.deposit.flow_lag = 0;
}

constexpr std::array<BeadModel, 3> kPrintModels{{{"union", "--beads capsule", asUnion},
                                                 {"settled", "--beads settled", asSettled},
                                                 {"typical", "--printer typical", asTypical}}};
// Lines end where their flow does: without that the half discs at their ends are more than was fed.
constexpr std::array<BeadModel, 3> kTileModels{{{"union", "--beads capsule", asUnion},
                                                {"settled", "--beads settled", asSettled},
                                                {"settled, flow", "--beads settled --flow-lag 0", asSettledFlow}}};

using ReadModel = std::function<gcode::Toolpath(const BeadModel&)>;

double sumLaid(const gcode::Toolpath& toolpath, const std::vector<std::uint32_t>& beads) {
    double sum = 0;
    for (const std::uint32_t bead : beads) sum += gcode::laidVolume(toolpath, bead);
    return sum;
}

// In a process of its own: the cells after the key.
Row volumesOf(const ReadModel& read, const BeadModel& model, const std::string& layers, int per_layer) {
    openvdb::initialize();
    voxelize::Selection selection;
    if (layers != "all") voxelize::parseLayers(layers, selection);
    const gcode::Toolpath commanded = read(kPrintModels.front());
    const double fed = sumLaid(commanded, voxelize::selectBeads(commanded, selection));
    const gcode::Toolpath toolpath = read(model);
    const auto beads = voxelize::selectBeads(toolpath, selection);
    const double laid = sumLaid(toolpath, beads);
    const voxelize::Lattice lattice = latticeOf(toolpath, beads, per_layer);
    voxelize::Voxelizer voxelizer(toolpath, beads, lattice);
    const double surface = voxelize::enclosedVolume(*voxelizer.printAll());
    const double surplus = voxelizer.balance().unplaced();
    return figures({lattice.voxel_size, fed, laid, surplus, surface, (surface / fed - 1) * 100,
                    (surface + surplus - laid) / laid * 100});
}

constexpr const char* kTileName = "VOLCO's tile";

}  // namespace

deposit::PrintRead readByModel(const std::string& path, const BeadModel& model, bool timed) {
    const gcode::InputBytes file(path);
    gcode::ReadOptions options;
    model.set(options);
    return deposit::readPrint(file.bytes(), file.name(), options, timed);
}

Table studyVolume(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    Table table(kVolumeColumns);
    double done = 0;
    // `head`: the cells before the model.
    const auto add = [&](const Row& head, const ReadModel& read, std::span<const BeadModel> models, int coarse) {
        for (const BeadModel& model : models)
            for (const int count : {coarse, 2 * coarse})
                if (count == coarse || !common.quick)
                    table.add(joined(
                        joined(head, {model.name, std::to_string(count)}),
                        rowInOwnProcess(fmt::format("{}: {} at {} voxels a layer", head[0], model.name, count),
                                        common.threads, [&] { return volumesOf(read, model, head[2], count); })));
        if (common.progress) common.progress(++done / static_cast<double>(options.prints.size() + 2));
    };
    for (const bool crossed : {false, true}) {
        const auto read = [crossed](const BeadModel& model) {
            gcode::ReadOptions by;
            model.set(by);
            return deposit::readPrint(tileProgram(crossed), "tile", by, false).toolpath;
        };
        add({fmt::format("{}, {}", kTileName, crossed ? "crossed" : "parallel"), "-", "all"}, read, kTileModels, 4);
    }
    for (const std::string& print : options.prints) {
        const auto read = [&print](const BeadModel& model) { return readByModel(print, model).toolpath; };
        add({std::filesystem::path(print).filename().string(), shortHash(print),
             options.layers.empty() ? "1:20" : options.layers},
            read, kPrintModels, 2);
    }
    page.heading("Volume");
    page.paragraph(
        "Fed is what the program extrudes in these layers. Laid is what the model lets flow out there: all of it, but "
        "for a lag that carries some on. The surplus overlaps with other beads of its layer and has no place (for a "
        "union: the lenses between neighbours). The surface is the volume that the trilinear level set encloses. What "
        "is left unexplained, the rest (surface + surplus - laid) / laid, is the voxels' error, and that of overlaps "
        "between layers, sloped beads and pinholes.");
    page.paragraph(fmt::format(
        "{} has {} lines of {:g} mm in {} layers, {:g} x {:g} mm, at the spacing of the slicers: {:.3f} mm\u00b3 fed. "
        "VOLCO, a voxel simulator that conserves volume, makes {:.3f} mm\u00b3 of it where all lines run side by side "
        "and {:.3f} where the layers cross (bench/volco.py, 2026-11-22).",
        kTileName, Tile::kLines * Tile::kLayers, Tile::kLength, Tile::kLayers, Tile::kWidth, Tile::kHeight, tileFed(),
        kVolcoParallel, kVolcoCrossed));
    page.table(table);
    return table;
}

}  // namespace stratum::study
