#include "march/file/vdb_check.h"

#include "march/file/leaf_file.h"
#include "march/file/vdb_walker.h"

#include <fmt/format.h>

#include <optional>
#include <set>
#include <vector>

namespace stratum::march {
namespace {

/// A name without the number that tells it from others of the same name.
std::string plainName(const std::string& name) { return name.substr(0, name.find_first_of("\x1e[")); }

class TreeCheck final : public VdbTreeVisitor {
public:
    TreeCheck(VdbCursor& cursor, const VdbGrid& grid, const VdbValueFormat& format)
        : cursor_(cursor), grid_(grid), format_(format) {}

    void run(bool leaves) {
        cursor_.moveTo(static_cast<std::int64_t>(grid_.tree));
        walkVdbTree(cursor_, format_, *this);
        if (grid_.listed && *grid_.listed != leaves_) cursor_.fail("a list of other leaves");
        if (leaves) (void)walkLeafPlaces(cursor_, format_, masks_);
    }

private:
    void lower(const VdbNode& /*node*/, std::string_view leaf_masks) override {
        masks_.push_back(leaf_masks);
        leaves_ += leaf_masks.size() / kLeafMaskBytes;
    }

    VdbCursor& cursor_;
    const VdbGrid& grid_;
    VdbValueFormat format_;
    std::uint64_t leaves_ = 0;
    std::vector<std::string_view> masks_;  // of the leaves below each lower node
};

}  // namespace

void checkVdb(const VdbBytes& bytes, VdbDepth depth, const std::string& name, const std::string& where) {
    VdbCursor cursor(bytes, where);
    const std::vector<VdbGrid> grids = walkVdbHeads(cursor).grids;
    if (depth == VdbDepth::heads) return;
    std::set<std::string> wanted = {plainName(name)};
    for (const VdbGrid& grid : grids)
        if (wanted.contains(plainName(grid.name)) && !grid.parent.empty()) wanted.insert(plainName(grid.parent));
    for (const VdbGrid& grid : grids) {
        const std::optional<VdbValueFormat> format = valueFormatOf(grid);
        if (!wanted.contains(plainName(grid.name)) || !grid.parent.empty()) continue;
        if (!format) cursor.fail(fmt::format("a grid of type {}", grid.type));
        TreeCheck(cursor, grid, *format).run(depth == VdbDepth::leaves);
    }
}

}  // namespace stratum::march
