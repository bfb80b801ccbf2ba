#include "study/picture/picture_subject.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "march/reference/sphere_intersector.h"
#include "march/reference/vdb_intersector.h"
#include "study/print.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <fmt/format.h>

#include <vector>

namespace stratum::study {

struct PictureSubject::Print {
    gcode::Toolpath toolpath;
    std::vector<std::uint32_t> beads;
    std::map<int, openvdb::FloatGrid::Ptr> grids;

    openvdb::FloatGrid::Ptr grid(int per_layer) {
        openvdb::FloatGrid::Ptr& known = grids[per_layer];
        if (!known) known = voxelize::voxelize(toolpath, beads, latticeOf(toolpath, beads, per_layer));
        return known;
    }
};

PictureSubject::PictureSubject(const std::string& print, int width, int height, int scene_per_layer)
    : print_(std::make_unique<Print>()), width_(width), height_(height), scene_per_layer_(scene_per_layer) {
    print_->toolpath = readPrint(print);
    print_->beads = voxelize::selectBeads(print_->toolpath, {});
}

PictureSubject::~PictureSubject() = default;

const trace::Intersector& PictureSubject::intersector(int per_layer, const std::string& march) {
    auto& known = intersectors_[{per_layer, march}];
    if (known) return *known;
    const openvdb::FloatGrid::Ptr grid = print_->grid(per_layer);
    if (march == "brick")
        known = march::makeBrickIntersector(*grid);
    else if (march == "brick floats")
        known = march::makeBrickIntersector(*grid, march::BrickValues::Float32);
    else if (march == "sphere")
        known = march::makeSphereIntersector(grid);
    else if (march == "vdb")
        known = march::makeVdbIntersector(grid);
    else
        throw UsageError(fmt::format("{}: no such intersector", march));
    return *known;
}

// The same for all level sets: of theirs it would differ by the boxes of their narrow bands, and a hair in the bed's
// height.
const shade::SceneDescription& PictureSubject::scene(const PictureKind& kind) {
    const std::string key = fmt::format("{} {} {}", kind.scene.brdf, kind.scene.env, kind.scene.bed);
    const auto known = scenes_.find(key);
    if (known != scenes_.end()) return known->second;
    shade::SceneDescription scene =
        shade::makeScene(kind.scene, intersector(scene_per_layer_, "brick"), width_, height_);
    if (kind.backdrop) scene.backdrop = shade::Backdrop{*kind.backdrop, *kind.backdrop};
    return scenes_.emplace(key, std::move(scene)).first->second;
}

shade::RenderResult PictureSubject::render(const PictureKind& kind, int spp, std::uint32_t seed,
                                           shade::RenderOptions options) {
    options.width = width_;
    options.height = height_;
    options.spp = spp;
    options.seed = seed;
    options.integrator = kind.integrator;
    return shade::render(intersector(kind.per_layer, kind.march), scene(kind), options);
}

}  // namespace stratum::study
