#include "compare/another_model.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::compare {
namespace {

constexpr std::size_t kTrialSamples = 5'000;
constexpr int kScaleSteps = 4;
// Of the scale that the surfaces' spreads tell, which inner surfaces disturb, and of the one that fits.
constexpr double kNearUnit = 0.1;
constexpr double kSameSize = 0.003;
constexpr double kOrder = 10;

struct Unit {
    double mm;
    std::string_view name;
};
constexpr std::array kUnits{Unit{0.001, "micrometres"}, Unit{10, "centimetres"}, Unit{25.4, "inches"},
                            Unit{304.8, "feet"}, Unit{1000, "metres"}};

// mm: 95 % of both surfaces are within it of the other one.
double apart(const Comparison& found) {
    return std::max(found.print_to_model.all.within_95, found.model_to_surface.all.within_95);
}

double medianOf(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Half of the surface is nearer than this to its middle: a point far away changes neither.
double spreadOf(const TriangleMesh& mesh) {
    const SurfaceSamples samples = sampleSurface(mesh, kTrialSamples);
    std::vector<double> values(samples.points.size());
    glm::dvec3 middle(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = samples.points[n][axis];
        middle[axis] = medianOf(values);
    }
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = glm::length(samples.points[n] - middle);
    return medianOf(values);
}

TriangleMesh changed(const TriangleMesh& model, double scale, bool mirrored) {
    TriangleMesh mesh = model;
    for (glm::dvec3& p : mesh.points) p *= glm::dvec3(mirrored ? -scale : scale, scale, scale);
    if (mirrored)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

// By how much a model that lies right is too small: the scale about its middle that brings it nearest to the print.
double growthOf(const PrintedSurface& print, const ClosedModel& model, const Comparison& found) {
    const SurfaceSamples samples = sampleSurface(model.mesh(), kTrialSamples);
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& p : samples.points) middle += found.model_to_print(p);
    middle /= static_cast<double>(samples.points.size());
    double up = 0;
    double down = 0;
    std::uint32_t hint = Nearest::kNone;
    for (std::size_t n = 0; n < samples.points.size(); ++n) {
        const glm::dvec3 at = found.model_to_print(samples.points[n]);
        const glm::dvec3 normal = found.model_to_print.turn * model.normal(samples.triangles[n]);
        const Nearest nearest = print.tree().nearest(at, hint);
        hint = nearest.triangle;
        const double lever = glm::dot(at - middle, normal);
        up += lever * glm::dot(nearest.point - at, normal);
        down += lever * lever;
    }
    return down > 0 ? std::clamp(up / down, -0.1, 0.1) : 0;
}

struct Trial {
    double scale = 1;
    bool mirrored = false;
    double apart = 0;  // mm
};

class Trials {
public:
    Trials(const PrintedSurface& print, const ClosedModel& model, const CompareOptions& options)
        : print_(print), model_(model), options_(options) {
        options_.samples = std::min(options.samples, kTrialSamples);
        scale_ = spreadOf(print.mesh()) / spreadOf(model.mesh());
        for (const Unit& unit : kUnits)
            if (std::abs(scale_ / unit.mm - 1) < kNearUnit) scale_ = unit.mm, exact_ = true;
    }

    /// `found`: of the model as it is.
    Trial best(const Comparison& found) const {
        const bool near = !exact_ && std::abs(scale_ - 1) < kNearUnit;
        Trial best = run(near ? 1 : scale_, false, near ? &found : nullptr);
        if (best.apart <= options_.line_width) return best;
        const Trial mirrored = run(near ? 1 : scale_, true, nullptr);
        return mirrored.apart < 0.5 * best.apart ? mirrored : best;
    }

private:
    // From a scale, and where the model lies at it, if that is known.
    Trial run(double scale, bool mirrored, const Comparison* known) const {
        Trial trial{scale, mirrored, 0};
        std::optional<Rigid> placement;
        for (int step = 0; step < kScaleSteps; ++step) {
            const ClosedModel model(changed(model_.mesh(), trial.scale, mirrored), "--compare");
            const Comparison found =
                step == 0 && known != nullptr
                    ? *known
                    : measureDeviations(print_, model, options_, placement ? &*placement : nullptr);
            trial.apart = apart(found);
            const double growth = exact_ ? 0 : growthOf(print_, model, found);
            if (std::abs(growth) < 1e-4 || step + 1 == kScaleSteps) break;
            trial.scale *= 1 + growth;
            // The middle of the print stays where it is.
            placement = found.model_to_print;
            placement->move += placement->turn * (middleOf(model.mesh()) * -growth);
        }
        return trial;
    }

    static glm::dvec3 middleOf(const TriangleMesh& mesh) {
        glm::dvec3 low = mesh.points.front();
        glm::dvec3 high = low;
        for (const glm::dvec3& p : mesh.points) low = glm::min(low, p), high = glm::max(high, p);
        return 0.5 * (low + high);
    }

    const PrintedSurface& print_;
    const ClosedModel& model_;
    CompareOptions options_;
    double scale_ = 1;
    bool exact_ = false;  // a unit's
};

std::string describe(const Trial& trial) {
    const char* image = trial.mirrored ? "its mirror image" : "it";
    for (const Unit& unit : kUnits)
        if (trial.scale == unit.mm)
            return fmt::format("{} fits if its numbers are {} ({:g} mm)", image, unit.name, unit.mm);
    if (std::abs(trial.scale - 1) < kSameSize) return fmt::format("{} fits", image);
    if (trial.scale > 1.5 || trial.scale < 0.67)
        return fmt::format("{} fits {:.4g} times as large", image, trial.scale);
    return fmt::format("{} fits at {:.1f} % of its size: it is {:.1f} % too {}", image, 100 * trial.scale,
                       100 * std::abs(1 / trial.scale - 1), trial.scale < 1 ? "large" : "small");
}

}  // namespace

std::vector<std::string> doubtsOf(const PrintedSurface& print, const ClosedModel& model, const Comparison& found,
                                  const CompareOptions& options) {
    std::vector<std::string> doubts;
    if (2 * model.repeated() >= model.mesh().triangles.size())
        doubts.push_back(fmt::format("{} of its {} triangles are there twice, as of bodies in one place; remove one",
                                     model.repeated(), model.mesh().triangles.size() - model.repeated()));
    const double ratio = found.model_mm3 / found.print_mm3;
    if (found.print_mm3 > 0 && (ratio > kOrder || ratio < 1 / kOrder))
        doubts.push_back(
            fmt::format("it holds {:.3g} mm3, and the print's surface {:.3g} mm3", found.model_mm3, found.print_mm3));
    if (apart(found) <= options.line_width) return doubts;
    std::string text =
        fmt::format("5 % of the surfaces are farther apart than {:.2g} mm, more than a line of {:.2g} mm", apart(found),
                    options.line_width);
    if (options.placement == ModelPlacement::fit) {
        const Trial trial = Trials(print, model, options).best(found);
        text += trial.apart <= std::max(options.line_width, 0.5 * apart(found)) && trial.apart < 0.75 * apart(found)
                    ? fmt::format("; {}, within {:.2g} mm", describe(trial), trial.apart)
                    : "; no other size fits, nor its mirror image: it seems the model of another print";
    } else {
        text += "; without --compare-at bed it is placed where it fits";
    }
    doubts.push_back(std::move(text));
    return doubts;
}

}  // namespace stratum::compare
