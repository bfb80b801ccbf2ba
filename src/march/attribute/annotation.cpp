#include "march/attribute/annotation.h"

#include "march/brick/cell_root.h"
#include "march/file/grid_axes.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace stratum::march {

namespace {

class GridSamples final : public SampleReader {
public:
    explicit GridSamples(const openvdb::FloatGrid& grid) : accessor_(grid.getConstAccessor()) {}
    float at(const openvdb::Coord& place) override { return accessor_.getValue(place); }

private:
    openvdb::FloatGrid::ConstAccessor accessor_;
};

// Caches the leaves used last: a megabyte, allocated on first use.
class FieldReader final : public SampleReader {
public:
    explicit FieldReader(const LeafField& field) : field_(field) {}
    float at(const openvdb::Coord& place) override {
        if (leaves_.empty()) leaves_.resize(std::size_t{kSide} * kSide * kSide);
        const openvdb::Coord origin = place & ~(kEdge - 1);
        const auto part = [&origin](int axis) { return static_cast<unsigned>(origin[axis]) / kEdge % kSide; };
        Leaf& leaf = leaves_[(part(0) * kSide + part(1)) * kSide + part(2)];
        if (leaf.origin != origin) {
            leaf.origin = openvdb::Coord::max();  // invalid if sampling throws
            leaf.uniform = !field_.samples(origin, leaf.samples);
            leaf.origin = origin;
        }
        if (leaf.uniform) return field_.background();
        const openvdb::Coord in = place - origin;
        const auto n = static_cast<unsigned>((in[0] * kEdge + in[1]) * kEdge + in[2]);
        return leaf.samples.leaf[n];
    }

private:
    static constexpr int kEdge = 8;
    static constexpr unsigned kSide = 8;
    struct Leaf {
        openvdb::Coord origin = openvdb::Coord::max();
        bool uniform = false;  // background, all of it
        FieldSamples samples;
    };
    const LeafField& field_;
    std::vector<Leaf> leaves_;
};

}  // namespace

SmoothNormal::SmoothNormal(const openvdb::math::Transform& transform, std::unique_ptr<SampleReader> samples)
    : map_(transform.baseMap()), samples_(std::move(samples)), to_index_(glm::inverse(GridAxes(transform).edges)) {}

SmoothNormal::SmoothNormal(const openvdb::FloatGrid& grid)
    : SmoothNormal(grid.transform(), std::make_unique<GridSamples>(grid)) {}

SmoothNormal::SmoothNormal(const LeafField& field)
    : SmoothNormal(field.transform(), std::make_unique<FieldReader>(field)) {}

double SmoothNormal::field(const glm::dvec3& p) {
    const openvdb::Coord cell = openvdb::Coord::floor(openvdb::Vec3d(p.x, p.y, p.z));
    Corners corners;
    for (int c = 0; c < 8; ++c)
        corners[static_cast<std::size_t>(c)] =
            static_cast<double>(samples_->at(cell.offsetBy(c >> 2, c >> 1 & 1, c & 1)));
    return interpolate(corners, p - glm::dvec3(cell[0], cell[1], cell[2]));
}

glm::dvec3 SmoothNormal::at(const glm::dvec3& position, const glm::dvec3& geometric) {
    const openvdb::Vec3d i = map_->applyInverseMap(openvdb::Vec3d(position.x, position.y, position.z));
    const glm::dvec3 p(i[0], i[1], i[2]);
    const double here = field(p);
    glm::dvec3 central;
    double bend = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = 1.0;
        const double after = field(p + step);
        const double before = field(p - step);
        central[axis] = 0.5 * (after - before);
        bend = std::max(bend, std::abs(after + before - 2.0 * here));
    }
    const double slope = glm::length(central);
    const glm::dvec3 world = central * to_index_;
    const double length = glm::length(world);
    if (!(slope > 0.0) || !(length > 0.0)) return geometric;
    // Across a crease the slopes of the two sides partly cancel; relative to the remaining slope the curvature is
    // larger.
    const double t = std::clamp((bend / slope - kSmooth) / (kCrease - kSmooth), 0.0, 1.0);
    const double sharp = t * t * (3.0 - 2.0 * t);
    const glm::dvec3 mixed = (1.0 - sharp) * (world / length) + sharp * geometric;
    const double size = glm::length(mixed);
    return size > 0.0 && glm::dot(mixed, geometric) > 0.0 ? mixed / size : geometric;
}

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
