// A finished picture, made band by band so that other work may come between.
#pragma once

#include "shade/integrator/render.h"
#include "view/input/view_scene.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace stratum::view {

/// The bytes of the .png that vdbtrace writes.
class StillPicture {
public:
    /// @param source   name of the input, for the file's metadata
    /// @param objects  of the picture, for the same: a viewport may show others by the time that it is finished
    StillPicture(ViewedPicture picture, const PicturePlan& plan, std::string source,
                 std::shared_ptr<const assemble::TracedObjects> objects);

    bool done() const { return next_row_ >= plan_.options.render.height; }
    /// 0..1
    double progress() const;
    /// Traces the next rows. What `check` throws, which is called after each tile, ends it: the rows are traced again
    /// by the next call.
    void traceBand(const std::function<void()>& check);

    /// Denoises if the plan says so. Throws what `check` throws, and then can be called again.
    void finish(const std::function<void()>& check);
    /// After finish(). As vdbtrace writes it.
    std::vector<std::uint8_t> png() const;
    const ViewedPicture& picture() const { return picture_; }
    const PicturePlan& plan() const { return plan_; }

private:
    ViewedPicture picture_;
    PicturePlan plan_;
    std::string source_;
    std::shared_ptr<const assemble::TracedObjects> objects_;
    shade::RenderResult whole_;
    std::shared_ptr<shade::RadianceCacheWork> cache_work_;
    int next_row_ = 0;
};

}  // namespace stratum::view
