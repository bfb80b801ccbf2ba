// One print as many level sets under one camera: what pictures that are to be compared are made of.
#pragma once

#include "shade/integrator/render.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace stratum::study {

/// How a picture is made, but for its samples.
struct PictureKind {
    int per_layer = 2;            ///< voxels a layer
    std::string march = "brick";  ///< brick, brick floats, sphere, vdb
    shade::SceneOptions scene;
    std::optional<shade::Color> backdrop;  ///< instead of what makeScene() puts there
    shade::IntegratorOptions integrator;
};

/// Level sets and intersectors of a print, made when first asked for and kept. Not for several threads.
class PictureSubject {
public:
    /// @param scene_per_layer  voxels a layer of the level set that camera and bed are fitted to, for all others as
    /// well
    PictureSubject(const std::string& print, int width, int height, int scene_per_layer);
    ~PictureSubject();
    PictureSubject(const PictureSubject&) = delete;
    PictureSubject& operator=(const PictureSubject&) = delete;

    /// Throws UsageError for an unknown intersector.
    const trace::Intersector& intersector(int per_layer, const std::string& march);
    /// A picture, with `spp` samples a pixel of this seed. `aovs` and the like are for `options` to say; its size and
    /// integrator are set here.
    shade::RenderResult render(const PictureKind& kind, int spp, std::uint32_t seed, shade::RenderOptions options = {});
    int width() const { return width_; }
    int height() const { return height_; }

private:
    struct Print;
    const shade::SceneDescription& scene(const PictureKind& kind);

    std::unique_ptr<Print> print_;
    int width_, height_, scene_per_layer_;
    std::map<std::pair<int, std::string>, std::unique_ptr<trace::Intersector>> intersectors_;
    std::map<std::string, shade::SceneDescription> scenes_;
};

}  // namespace stratum::study
