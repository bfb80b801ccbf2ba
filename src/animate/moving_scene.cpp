#include "animate/moving_scene.h"

#include "animate/pace.h"
#include "base/error.h"

#include <fmt/format.h>

#include <utility>

namespace stratum::animate {

MovingScene::MovingScene(assemble::TracedObjects objects, assemble::Stage stage, const assemble::StageOptions& options,
                         Motion motion)
    : motion_(std::move(motion)),
      objects_(std::move(objects)),
      scene_(std::move(stage.scene)),
      middle_(stage.middle),
      first_(scene_.camera) {
    if (motion_.grow) growing_ = assemble::growingPrint(objects_);
    if (motion_.grow && motion_.frames > 1 && (!growing_ || growing_->moments() != motion_.frames))
        throw UsageError("a film of a print that grows needs one print of G-code, and as many moments as frames");
    if (motion_.nozzle.kind != assemble::HotEndKind::none) hot_end_.emplace(objects_, scene_, motion_.nozzle);
    if (!motion_.path.empty()) planCameras(options);
}

void MovingScene::planCameras(const assemble::StageOptions& options) {
    const trace::Box box = options.frame_all || !objects_.part ? objects_.intersector->bounds() : *objects_.part;
    shade::CameraOptions camera = options.scene.camera;
    camera.mm_per_unit = objects_.mm_per_unit;
    const CameraPath path(motion_.path, middle_, camera.fov);
    cameras_.reserve(motion_.frames);
    for (std::size_t n = 0; n < motion_.frames; ++n) {
        const double share =
            motion_.frames > 1 ? static_cast<double>(n) / static_cast<double>(motion_.frames - 1) : 0.0;
        path.place(share, camera);
        try {
            cameras_.push_back(shade::Camera::make(camera, box, first_.width(), first_.height()));
        } catch (const UsageError& error) {
            throw UsageError(fmt::format("--camera-path: {:.3g} s after its begin (frame {} of {}): {}",
                                         share * durationOf(motion_.path), n + 1, motion_.frames, error.what()));
        }
    }
}

bool MovingScene::repeats(std::size_t n) const {
    if (n == 0 || motion_.turns != 0.0 || !motion_.path.empty()) return false;
    if (hot_end_ && isHeld(n) != isHeld(n - 1)) return false;
    return !growing_ || growing_->beadsAt(n) == growing_->beadsAt(n - 1);
}

void MovingScene::show(std::size_t n) {
    if (growing_) growing_->show(n);
    shown_ = n;
    if (hot_end_) objects_.intersector = isHeld(n) ? hot_end_->alone() : hot_end_->at(growing_ ? n : 0);
    if (!cameras_.empty())
        scene_.camera = cameras_[n];
    else if (motion_.turns != 0.0)
        scene_.camera = first_.turned(
            360.0 * motion_.turns * paced(static_cast<double>(n) / static_cast<double>(motion_.frames), motion_.ease),
            middle_);
}

void MovingScene::drawOver(shade::Film& film, double white) const {
    if (hot_end_ && !isHeld(shown_)) hot_end_->drawOver(growing_ ? shown_ : 0, scene_.camera, white, film);
}

}  // namespace stratum::animate
