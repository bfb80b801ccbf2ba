#include "compare/another_model.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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
// Of the residual of the model as it is: a coarse fit of another size that is farther is not refined.
constexpr double kHopeful = 0.8;
// Of the distance a step before: a better scale comes nearer.
constexpr double kNearer = 0.95;

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

TriangleMesh changed(const TriangleMesh& model, double scale, bool mirrored) {
    TriangleMesh mesh = model;
    for (glm::dvec3& p : mesh.points) p *= glm::dvec3(mirrored ? -scale : scale, scale, scale);
    if (mirrored)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

// By how much a model that lies right is too small: the scale about its middle that brings it nearest to the print.
double growthOf(const PrintedSurface& print, const ClosedModel& model, const Comparison& found, double rough) {
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
        const Nearest nearest = print.tree().nearest(at, hint, rough);
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
        scale_ = spreadOf(print.sampled(kTrialSamples)) / spreadOf(sampleSurface(model.mesh(), kTrialSamples));
        for (const Unit& unit : kUnits)
            if (std::abs(scale_ / unit.mm - 1) < kNearUnit) scale_ = unit.mm, exact_ = true;
    }

    /// `found`: of the model as it is.
    Trial best(const Comparison& found) const {
        const bool near = !exact_ && std::abs(scale_ - 1) < kNearUnit;
        const SurfaceSamples samples = print_.sampled(kTrialSamples);
        const double as_it_is = roughResidual(model_, samples, found.model_to_print);
        Trial best =
            near ? run({1, false, kNever}, found.model_to_print) : place({scale_, false, kNever}, samples, as_it_is);
        if (best.apart <= options_.line_width) return best;
        const Trial mirrored = place({near ? 1 : scale_, true, kNever}, samples, as_it_is);
        return mirrored.apart < 0.5 * best.apart ? mirrored : best;
    }

private:
    static constexpr double kNever = std::numeric_limits<double>::infinity();

    // A trial from no known placement. The print is shrunk and mirrored instead of the model, whose tree is there. A
    // first coarse fit that is hardly better than that of the model as it is decides that nothing else would be.
    Trial place(const Trial& trial, SurfaceSamples samples, double as_it_is) const {
        const glm::dvec3 change(trial.mirrored ? -trial.scale : trial.scale, trial.scale, trial.scale);
        for (glm::dvec3& p : samples.points) p /= change;
        std::optional<Rigid> placement = roughFit(model_, samples, kHopeful * as_it_is / trial.scale);
        if (!placement) return trial;
        if (trial.mirrored) {
            const glm::dmat3 mirror(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
            placement->turn = mirror * placement->turn * mirror;
        }
        placement->move *= change;
        return run(trial, *placement);
    }

    // Towards the scale that fits, while that brings both surfaces nearer.
    Trial run(Trial trial, Rigid placement) const {
        Trial best = trial;
        for (int step = 0; step < kScaleSteps; ++step) {
            const ClosedModel model(changed(model_.mesh(), trial.scale, trial.mirrored), "--compare");
            const Comparison found = measureDeviations(print_, model, options_, &placement);
            trial.apart = apart(found);
            const bool nearer = trial.apart < kNearer * best.apart;
            if (trial.apart < best.apart) best = trial;
            const double growth = exact_ ? 0 : growthOf(print_, model, found, options_.line_width);
            if (!nearer || std::abs(growth) < 1e-4) break;
            trial.scale *= 1 + growth;
            // The middle of the print stays where it is.
            placement = found.model_to_print;
            placement.move += placement.turn * (middleOf(model.mesh()) * -growth);
        }
        return best;
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
        doubts.push_back(
            fmt::format("{} of its {} triangles repeat others, as of bodies in one place; leave one of them",
                        model.repeated(), model.mesh().triangles.size()));
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
        // By the same rule as for the model as it is: what is merely nearer is another model, too.
        text += trial.apart <= options.line_width
                    ? fmt::format("; {}, within {:.2g} mm", describe(trial), trial.apart)
                    : "; no other size fits, nor its mirror image: it seems the model of another print";
    } else {
        text += "; without --compare-at bed it is placed where it fits";
    }
    doubts.push_back(std::move(text));
    return doubts;
}

}  // namespace stratum::compare
