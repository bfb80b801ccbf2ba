#include "march/file/level_set_file.h"

#include "base/error.h"
#include "base/input_file.h"
#include "march/file/grid_axes.h"
#include "march/file/vdb_check.h"
#include "march/file/vdb_walker.h"
#include "march/file/whole_grid.h"

#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numbers>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

namespace stratum::march {
namespace {

constexpr double kLeastHalfWidth = 2;
constexpr double kMostReturn = 0.01;  // largest error, in voxels, of the map and its inverse; far origins round
constexpr double kMostShear = 1e-5;   // rounding error of a transform from 32-bit floats

// The selected grid of a file.
struct Choice {
    const VdbGrid* grid = nullptr;
    openvdb::GridBase::ConstPtr head;  // no voxels
};

Choice chooseGrid(const VdbHeads& heads, const std::string& where, const std::string& name) {
    Choice choice;
    std::string seen;
    int candidates = 0;
    std::set<std::string> names;
    for (const VdbGrid& grid : heads.grids) {
        const std::string grid_name = nameOf(grid);
        // OpenVDB adds a number to duplicate names: name[0], name[1].
        const std::string plain = openvdb::io::GridDescriptor::stripSuffix(grid_name);
        const bool twice = !names.insert(plain.substr(0, plain.find('['))).second;
        if (twice && (name.empty() || plain.substr(0, plain.find('[')) == name))
            throw InputError(fmt::format("{}: has two grids named {}; name them apart, nobody can say which is meant",
                                         where, plain.substr(0, plain.find('['))));
        const openvdb::GridBase::Ptr head = headOf(heads, grid);
        seen += fmt::format("{}{} ({})", seen.empty() ? "" : ", ", grid_name, grid.type);
        if (grid_name == name) choice = {&grid, head};
        if (!head || head->getGridClass() != openvdb::GRID_LEVEL_SET || !head->isType<openvdb::FloatGrid>()) continue;
        if (name.empty() && grid_name == "surface") {
            choice = {&grid, head};
            candidates = 1;
            break;
        }
        ++candidates;
        if (name.empty()) choice = {&grid, head};
    }
    if (name.empty() && candidates > 1)
        throw InputError(
            fmt::format("{}: has {} level sets; say which with --grid NAME. It has: {}", where, candidates, seen));
    if (name.empty() && candidates == 0)
        throw InputError(fmt::format("{}: has no level set of floats; make one with gcode2vdb. It has: {}", where,
                                     seen.empty() ? "nothing" : seen));
    if (choice.grid == nullptr)
        throw InputError(fmt::format("{}: has no grid named {}. It has: {}", where, name, seen));
    if (!choice.head || !choice.head->isType<openvdb::FloatGrid>())
        throw InputError(fmt::format("{}: the grid {} does not hold floats. It has: {}", where, name, seen));
    return choice;
}

// Calls `read` with the heads of the file's grids, the selected one, whose tree has not been checked, and the file.
template <typename Read>
auto withGrid(const std::filesystem::path& path, const std::string& name, const Read& read) {
    const std::string where = path.string();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        throw InputError(fmt::format("{}: is not a file; check the name", where));
    InputFile input(path);
    VdbCursor cursor(input, where);
    const VdbHeads heads = walkVdbHeads(cursor);
    try {
        return read(heads, chooseGrid(heads, where, name), input);
    } catch (const InputError&) {
        throw;
    } catch (const std::bad_alloc&) {
        // Also of impossible counts in a damaged file.
        throw InputError(fmt::format("{}: is not a readable .vdb file, or there is not enough memory for it", where));
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: is not a readable .vdb file ({}); is it cut short?", where, error.what()));
    }
}

}  // namespace

openvdb::FloatGrid::Ptr readLevelSet(const std::filesystem::path& path, const std::string& name) {
    auto grid = withGrid(path, name, [&path](const VdbHeads& heads, const Choice& choice, const InputFile& input) {
        return openvdb::gridPtrCast<openvdb::FloatGrid>(
            readWholeGrid(heads, *choice.grid, *choice.head, input, path.string()));
    });
    requireTraceable(*grid, path.string());
    return grid;
}

std::shared_ptr<const LeafFile> openLevelSet(const std::filesystem::path& path, const std::string& name) {
    auto file = withGrid(path, name, [&path](const VdbHeads&, const Choice& choice, InputFile& input) {
        const std::string grid = nameOf(*choice.grid);
        checkVdb(input, VdbDepth::nodes, grid, path.string());
        return LeafFile::open(std::move(input), grid, *choice.head);
    });
    if (file) requireTraceable(file->head(), file->leafCount(), path.string());
    return file;
}

bool hasGrid(const std::filesystem::path& path, const std::string& name) {
    const std::string where = path.string();
    const InputFile input(path);
    VdbCursor cursor(input, where);
    const std::vector<VdbGrid> grids = walkVdbHeads(cursor).grids;
    return std::any_of(grids.begin(), grids.end(), [&name](const VdbGrid& grid) { return nameOf(grid) == name; });
}

void requireTraceable(const openvdb::FloatGrid& grid, const std::string& where) {
    requireTraceable(grid, grid.tree().leafCount(), where);
}

void requireTraceable(const openvdb::FloatGrid& grid, std::size_t leaves, const std::string& where) {
    if (grid.getGridClass() != openvdb::GRID_LEVEL_SET)
        throw InputError(
            fmt::format("{}: the grid {} is not a level set but a {}; make a level set with gcode2vdb or "
                        "OpenVDB's fog-to-level-set tools",
                        where, grid.getName(), grid.gridClassToMenuName(grid.getGridClass())));
    if (leaves == 0)
        throw InputError(
            fmt::format("{}: the level set {} is empty; there is no surface to trace", where, grid.getName()));
    if (!grid.transform().isLinear())
        throw InputError(
            fmt::format("{}: the voxels of {} lie in perspective (a frustum transform); resample it with a linear one",
                        where, grid.getName()));
    const GridAxes axes(grid.transform());
    // Written so that NaN is refused, too.
    if (!(axes.shortest() > 0 && std::isfinite(axes.longest())))
        throw InputError(fmt::format("{}: the voxels of {} have no size; mend its transform", where, grid.getName()));
    // A file has its transform and the inverse of it.
    const openvdb::math::MapBase& map = *grid.transform().baseMap();
    for (const openvdb::Vec3d& p : {openvdb::Vec3d(0, 0, 0), openvdb::Vec3d(100, -200, 300)})
        if (!((map.applyInverseMap(map.applyMap(p)) - p).length() <= kMostReturn))
            throw InputError(fmt::format("{}: the transform of {} leads elsewhere than its inverse comes from; mend it",
                                         where, grid.getName()));
    if (!(axes.shear() <= kMostShear))
        throw InputError(
            fmt::format("{}: the voxels of {} are sheared: their edges are {:.4g} degrees from perpendicular; resample "
                        "it on a lattice of boxes",
                        where, grid.getName(), std::asin(axes.shear()) * 180 / std::numbers::pi));
    const double half_width = static_cast<double>(grid.background()) / axes.shortest();
    if (!(half_width >= kLeastHalfWidth))
        throw InputError(
            fmt::format("{}: the narrow band of {} is {:.2f} voxels to each side, at least {} are needed; "
                        "make it again with --half-width 3",
                        where, grid.getName(), half_width, kLeastHalfWidth));
}

trace::Box narrowBandBounds(const openvdb::FloatGrid& grid) {
    return worldBounds(grid.transform(), grid.evalActiveVoxelBoundingBox());
}

trace::Box worldBounds(const openvdb::math::Transform& transform, const openvdb::CoordBBox& box) {
    trace::Box bounds{glm::dvec3(std::numeric_limits<double>::infinity()),
                      glm::dvec3(-std::numeric_limits<double>::infinity())};
    for (int corner = 0; corner < 8; ++corner) {
        openvdb::Coord index;
        for (int axis = 0; axis < 3; ++axis)
            index[axis] = (corner >> axis & 1) != 0 ? box.max()[axis] : box.min()[axis];
        const openvdb::Vec3d world = transform.indexToWorld(index);
        for (int axis = 0; axis < 3; ++axis) {
            bounds.min[axis] = std::min(bounds.min[axis], world[axis]);
            bounds.max[axis] = std::max(bounds.max[axis], world[axis]);
        }
    }
    return bounds;
}

}  // namespace stratum::march
