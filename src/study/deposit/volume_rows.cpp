// Volume: how much of what was fed the level set holds.
#include "deposit/printer.h"
#include "gcode/container/input_bytes.h"
#include "study/cost/own_process.h"
#include "study/deposit/deposit_parts.h"
#include "study/deposit/made_programs.h"
#include "study/deposit/published.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/enclosed_volume.h"
#include "voxelize/grid/voxelizer.h"

#include "base/error.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace stratum::study {
namespace {

const Row kVolumeColumns{"print",   "sha256",   "layers",      "beads_are",   "per_layer",      "voxel_mm",
                         "fed_mm3", "laid_mm3", "surplus_mm3", "surface_mm3", "of_fed_percent", "rest_percent"};
constexpr std::size_t kVolumeKeys = 5;
enum VolumeColumn : std::size_t {
    kVolumePrint,
    kVolumeHash,
    kVolumeLayers,
    kVolumeModel,
    kVolumeCount,
    kVolumeVoxel,
    kVolumeFed,
    kVolumeLaid,
    kVolumeSurplus,
    kVolumeSurface,
    kVolumeOfFed,
    kVolumeRest
};

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

// In the child. The cells after the key.
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
    return {fmt::format("{:.6g}", lattice.voxel_size),
            fmt::format("{:.7g}", fed),
            fmt::format("{:.7g}", laid),
            fmt::format("{:.7g}", surplus),
            fmt::format("{:.7g}", surface),
            fmt::format("{:.4f}", (surface / fed - 1) * 100),
            fmt::format("{:.4f}", (surface + surplus - laid) / laid * 100)};
}

class VolumeRows {
public:
    VolumeRows(const StudyOptions& common, ResultTable& table) : common_(common), table_(table) {}

    void add(const Row& head, const ReadModel& read, std::span<const BeadModel> models,
             const std::vector<int>& counts) {
        for (const BeadModel& model : models)
            for (const int count : counts) {
                Row key = head;
                key.insert(key.end(), {model.name, std::to_string(count)});
                if (table_.find(key) == nullptr) table_.add(measured(key, read, model, count));
            }
    }

private:
    Row measured(Row row, const ReadModel& read, const BeadModel& model, int count) const {
        const Outcome outcome = inOwnProcess([&] {
            const tbb::global_control limit(
                tbb::global_control::max_allowed_parallelism,
                static_cast<std::size_t>(common_.threads > 0 ? common_.threads : tbb::info::default_concurrency()));
            const std::string line = csvLine(volumesOf(read, model, row[kVolumeLayers], count));
            return line.substr(0, line.size() - 1);
        });
        if (!outcome.failure.empty())
            throw InputError(
                fmt::format("{}: {} at {} voxels a layer: {}", row[kVolumePrint], model.name, count, outcome.failure));
        const Row cells = parseCsvLine(outcome.text);
        row.insert(row.end(), cells.begin(), cells.end());
        return row;
    }

    const StudyOptions& common_;
    ResultTable& table_;
};

constexpr const char* kTileName = "VOLCO's tile";

void writeVolume(Page& page, const ResultTable& table) {
    page.heading("Volume");
    page.paragraph(
        "Fed is what the program extrudes in these layers. Laid is what the model lets flow out there: all of it, but "
        "for a lag that carries some on. The surplus overlaps with other beads of its layer and has no place (for a "
        "union: the lenses between neighbours). The surface is the volume that the trilinear level set encloses. What "
        "is left unexplained, (surface + surplus - laid) / laid, is the voxels' error, and that of overlaps between "
        "layers, sloped beads and pinholes.");
    page.paragraph(fmt::format(
        "{} has {} lines of {:g} mm in {} layers, {:g} x {:g} mm, at the spacing of the slicers: {:.3f} mm\u00b3 fed. "
        "VOLCO, a voxel simulator that conserves volume, makes {:.3f} mm\u00b3 of it where all lines run side by side "
        "and {:.3f} where the layers cross (bench/volco.py, 2026-11-22).",
        kTileName, Tile::kLines * Tile::kLayers, Tile::kLength, Tile::kLayers, Tile::kWidth, Tile::kHeight, tileFed(),
        kVolcoParallel, kVolcoCrossed));
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const Row& row : table.rows()) {
        const auto with = [&](VolumeColumn column, const char* format) {
            return fmt::format(fmt::runtime(format), numberIn(row, column));
        };
        cells.push_back({row[kVolumePrint], row[kVolumeLayers], row[kVolumeModel], row[kVolumeVoxel],
                         with(kVolumeFed, "{:.3f}"), with(kVolumeLaid, "{:.3f}"), with(kVolumeSurplus, "{:.3f}"),
                         with(kVolumeSurface, "{:.3f}"), with(kVolumeOfFed, "{:+.2f}"), with(kVolumeRest, "{:+.2f}"),
                         row.back()});
        lines.push_back(table.lineOf(row));
    }
    page.table({"print", "layers", "beads are", "voxel mm", "fed mm\u00b3", "laid mm\u00b3", "surplus mm\u00b3",
                "surface mm\u00b3", "of fed %", "unexplained %", "run"},
               cells, {}, lines, "deposit_volume");
}

}  // namespace

deposit::PrintRead readByModel(const std::string& path, const BeadModel& model, bool timed) {
    const gcode::InputBytes file(path);
    gcode::ReadOptions options;
    model.set(options);
    return deposit::readPrint(file.bytes(), file.name(), options, timed);
}

PartTable studyVolume(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    auto table = std::make_unique<ResultTable>(common, "deposit_volume.csv", kVolumeColumns, kVolumeKeys);
    VolumeRows rows(common, *table);
    double done = 0;
    const auto step = [&] {
        if (common.progress) common.progress(++done / static_cast<double>(options.prints.size() + 2));
    };
    for (const bool crossed : {false, true}) {
        rows.add(
            {fmt::format("{}, {}", kTileName, crossed ? "crossed" : "parallel"), "-", "all"},
            [crossed](const BeadModel& model) {
                gcode::ReadOptions read;
                model.set(read);
                return deposit::readPrint(tileProgram(crossed), "tile", read, false).toolpath;
            },
            kTileModels, common.quick ? std::vector<int>{4} : std::vector<int>{4, 8});
        step();
    }
    for (const std::string& print : options.prints) {
        rows.add(
            {std::filesystem::path(print).filename().string(), shortHash(print),
             options.layers.empty() ? "1:20" : options.layers},
            [&print](const BeadModel& model) { return readByModel(print, model).toolpath; }, kPrintModels,
            common.quick ? std::vector<int>{2} : std::vector<int>{2, 4});
        step();
    }
    writeVolume(page, *table);
    return table;
}

}  // namespace stratum::study
