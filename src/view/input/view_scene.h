// What is in front of the camera of one page: kept from picture to picture, and made anew where a plan differs.
#pragma once

#include "assemble/ready_scene.h"
#include "shade/integrator/bare_light.h"
#include "view/asked/picture_plan.h"
#include "view/input/document.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <optional>
#include <string>

namespace stratum::view {

/// A scene for shade::render().
struct ViewedPicture {
    std::shared_ptr<const trace::Intersector> print;
    shade::SceneDescription scene;
    shade::ToneOptions tone;
    std::shared_ptr<const shade::BareLight> bare_light;  ///< of its light; null for exact pictures
};

class ViewScene {
public:
    explicit ViewScene(Document& document) : document_(document) {}

    /// Whether the objects of the plan are there, so that a picture of it needs no reading.
    bool has(const PicturePlan& plan) const;
    /// Whether objects of this document are there that can stand for those of the plan while it moves: all of the
    /// print, cut flat at the planes of its layers.
    bool canStandIn(const PicturePlan& plan) const;

    /// The objects of the plan, read and built if they must be. Throws InputError and UsageError.
    void makeObjects(const PicturePlan& plan, const assemble::ReadEvents& events);
    /// Seconds that this took last, if it was more than looking up.
    double buildSeconds() const { return build_seconds_; }

    /// How exactly light follows the camera that it stands beside (the studio's does): a studio takes as long to make
    /// as a small picture to trace, so while a view moves it follows in steps of a few degrees.
    enum class Light { exact, near };
    /// A picture of the plan in another size, of its own objects.
    ViewedPicture picture(const PicturePlan& plan, int width, int height, Light light = Light::exact);
    /// The light of the last picture, by normal; made when it is first asked for.
    const shade::BareLight& bareLight();
    /// The same of what stands in for them.
    ViewedPicture standIn(const PicturePlan& plan, const ViewState& state, int width, int height);

    /// Of the last makeObjects().
    const assemble::TracedObjects& objects() const { return objects_->traced; }
    std::shared_ptr<const assemble::TracedObjects> sharedObjects() const { return {objects_, &objects_->traced}; }
    bool empty() const { return !objects_; }
    /// Gives back what it holds.
    void forget();
    /// Legends, warnings and the box, for the page.
    nlohmann::json describe() const;

private:
    struct Objects {
        assemble::TracedObjects traced;
        std::string key;
        std::uint64_t generation = 0;
        std::optional<double> bed_height;
    };
    ViewedPicture stage(Objects& objects, const PicturePlan& plan, std::shared_ptr<const trace::Intersector> print,
                        std::optional<double> bed_height, int width, int height, Light light);
    ViewedPicture staged(std::shared_ptr<const trace::Intersector> print, const PicturePlan& plan, Light light);
    bool lightFits(const shade::Camera& camera, const std::string& env, Light light) const;

    Document& document_;
    std::shared_ptr<Objects> objects_;
    std::shared_ptr<Objects> whole_;  // the last ones without a selection of layers
    double build_seconds_ = 0.0;
    // The last stage, for light that doesn't turn with the camera.
    std::string light_key_;
    std::optional<assemble::Stage> stage_;
    const Objects* staged_ = nullptr;
    std::optional<double> staged_bed_;
    std::shared_ptr<const shade::BareLight> bare_light_;  // of stage_, when it was first asked for
};

}  // namespace stratum::view
