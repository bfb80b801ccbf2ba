// What each frame of a film shows: the print so far, the camera, the hot end.
#pragma once

#include "animate/camera_path.h"
#include "assemble/hot_end.h"
#include "assemble/ready_scene.h"
#include "assemble/traced_objects.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace stratum::animate {

/// What moves while the frames pass.
struct Motion {
    std::size_t frames = 1;
    bool grow = false;            ///< the print grows: frame n is moment n of its series
    std::size_t held = 0;         ///< the last frames show the finished part alone, without a hot end
    double turns = 0.0;           ///< revolutions of the camera about the part, counter-clockwise as seen from above
    double ease = 0.0;            ///< of the turns: see paced()
    assemble::HotEndLook nozzle;  ///< stands at the end of the last bead
    std::vector<CameraKey> path;  ///< or the camera goes this way; empty: it does not
};

/// Light, bed and exposure are those of the whole print for all frames. Not while rays are traced.
class MovingScene {
public:
    /// @param stage    made for `objects`; for a camera that goes a way, with its first key
    /// @param options  of the stage; what keys leave open is taken from its camera
    /// Throws UsageError: a camera that can't look that way, with its frame; objects that don't fit the motion.
    MovingScene(assemble::TracedObjects objects, assemble::Stage stage, const assemble::StageOptions& options,
                Motion motion);

    /// Whether frame n shows what frame n - 1 shows.
    bool repeats(std::size_t n) const;
    /// Sets the scene to frame n. Cheapest in their order.
    void show(std::size_t n);

    /// Draws what stands before the frame that is shown, see assemble::HotEnd::drawOver().
    void drawOver(shade::Film& film, double white) const;

    /// With the intersector of the frame that is shown.
    const assemble::TracedObjects& objects() const { return objects_; }
    const shade::SceneDescription& scene() const { return scene_; }

private:
    void planCameras(const assemble::StageOptions& options);
    bool isHeld(std::size_t n) const { return n + motion_.held >= motion_.frames; }

    Motion motion_;
    std::size_t shown_ = 0;
    assemble::TracedObjects objects_;
    std::shared_ptr<assemble::LazyPrint> growing_;
    std::optional<assemble::HotEnd> hot_end_;
    shade::SceneDescription scene_;
    glm::dvec3 middle_;
    shade::Camera first_;
    std::vector<shade::Camera> cameras_;  // by frame, if the camera moves on a path
};

}  // namespace stratum::animate
