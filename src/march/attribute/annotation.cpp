#include "march/attribute/annotation.h"

#include "march/attribute/smooth_normal.h"

#include <algorithm>
#include <utility>

namespace stratum::march {
namespace {

class AnnotatedTracer final : public trace::Tracer {
public:
    AnnotatedTracer(std::unique_ptr<trace::Tracer> rays, const Annotation& annotation) : rays_(std::move(rays)) {
        if (annotation.smooth)
            smooth_.emplace(*annotation.smooth);
        else if (annotation.smooth_field)
            smooth_.emplace(*annotation.smooth_field);
        if (annotation.grain) grain_ = annotation.grain->makeLookup();
        for (const auto& source : annotation.attributes) attributes_.push_back(source ? source->makeLookup() : nullptr);
    }

    bool intersect(const trace::Ray& ray, trace::Hit& hit) override { return rays_->intersect(ray, hit); }
    bool occluded(const trace::Ray& ray) override { return rays_->occluded(ray); }
    void intersectStream(std::span<const trace::Ray> rays, std::span<trace::Hit> hits) override {
        rays_->intersectStream(rays, hits);
    }
    void occludedStream(std::span<const trace::Ray> rays, std::span<std::uint8_t> blocked) override {
        rays_->occludedStream(rays, blocked);
    }
    glm::dvec3 shadingNormal(const trace::Hit& hit) override {
        return smooth_ ? smooth_->at(hit.position, hit.normal) : hit.normal;
    }
    glm::dvec3 grain(const trace::Hit& hit) override {
        return grain_ ? glm::dvec3(grain_->at(hit.position).value_or(glm::vec3(0.0F))) : glm::dvec3(0.0);
    }
    std::optional<glm::vec3> attribute(const trace::Hit& hit, std::size_t which) override {
        if (which >= attributes_.size() || !attributes_[which]) return std::nullopt;
        return attributes_[which]->at(hit.position);
    }

private:
    std::unique_ptr<trace::Tracer> rays_;
    std::optional<SmoothNormal> smooth_;
    std::unique_ptr<AttributeLookup> grain_;
    std::vector<std::unique_ptr<AttributeLookup>> attributes_;
};

class AnnotatedIntersector final : public trace::Intersector {
public:
    AnnotatedIntersector(std::shared_ptr<const trace::Intersector> shape, Annotation annotation)
        : shape_(std::move(shape)), annotation_(std::move(annotation)) {}

    std::unique_ptr<trace::Tracer> makeTracer() const override {
        return std::make_unique<AnnotatedTracer>(shape_->makeTracer(), annotation_);
    }
    std::string_view name() const override { return shape_->name(); }
    trace::Box bounds() const override { return shape_->bounds(); }
    double voxelSize() const override { return shape_->voxelSize(); }
    double surfaceOffset() const override { return shape_->surfaceOffset(); }
    std::size_t bytes() const override {
        std::size_t sum = shape_->bytes();
        if (annotation_.smooth) sum += annotation_.smooth->memUsage();
        if (annotation_.grain) sum += annotation_.grain->bytes();
        for (const auto& source : annotation_.attributes)
            if (source) sum += source->bytes();
        return sum;
    }

private:
    std::shared_ptr<const trace::Intersector> shape_;
    Annotation annotation_;
};

}  // namespace

bool Annotation::empty() const {
    return !smooth && !smooth_field && !grain &&
           std::all_of(attributes.begin(), attributes.end(), [](const auto& source) { return !source; });
}

std::shared_ptr<const trace::Intersector> annotate(std::shared_ptr<const trace::Intersector> shape,
                                                   Annotation annotation) {
    if (annotation.empty()) return shape;
    return std::make_shared<AnnotatedIntersector>(std::move(shape), std::move(annotation));
}

}  // namespace stratum::march
