#include "compare/best_fit.h"

#include "base/error.h"
#include "base/parallel_for.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace stratum::compare {
namespace {

constexpr std::size_t kCoarseSamples = 300;
constexpr std::size_t kMediumSamples = 2000;
constexpr std::size_t kFineSamples = 20000;
constexpr int kCoarseSteps = 12;
constexpr int kFineSteps = 60;
constexpr int kTurns = 24;
constexpr std::size_t kRefined = 4;
// A search that is often in vain: of another size of a model, or of its mirror image.
constexpr std::size_t kRoughSamples = 150;
constexpr int kRoughTurns = 12;
constexpr int kRoughSteps = 8;
constexpr std::size_t kRoughRefined = 2;
constexpr int kRoughFineSteps = 24;
constexpr int kPatience = 6;  // steps
// Triangles and boxes that a search looks at: 60 to 250 of models that are whole, 300 and more of damaged ones. And the
// searches that tell.
constexpr double kUsualWork = 250;
constexpr std::size_t kProbes = 64;
constexpr std::size_t kLeastAffordable = 32;
// Of the print's size: a smaller residual is that of a model that fits.
constexpr double kFits = 0.01;
constexpr double kOtherSize = 2;
// Samples farther than this count for nothing: of the distance that nine tenths keep, or of the print's size if that is
// more. A share of the samples instead would be taken from one side when the other is nearer: walls are printed a
// little inside the model, and a shift would feed itself.
constexpr double kMostOfUsual = 3;
constexpr double kLeastOfSize = 2e-3;

// The placement of a print in the model's space, and how well it fits.
struct Candidate {
    Rigid print_to_model;
    double residual = 0;
};

using Row = std::array<double, 7>;

// Solves six equations of six unknowns by Gauss with pivots; unknowns that nothing determines (a sphere's turn) are 0.
std::array<double, 6> solve(std::array<Row, 6> rows) {
    double largest = 0;
    for (std::size_t n = 0; n < 6; ++n) largest = std::max(largest, rows[n][n]);
    std::array<double, 6> x{};
    // Levenberg's term keeps what is undetermined at 0, and changes what is determined by a millionth.
    for (std::size_t n = 0; n < 6; ++n) rows[n][n] += 1e-9 * largest + 1e-300;
    for (std::size_t n = 0; n < 6; ++n) {
        std::size_t pivot = n;
        for (std::size_t m = n + 1; m < 6; ++m)
            if (std::abs(rows[m][n]) > std::abs(rows[pivot][n])) pivot = m;
        std::swap(rows[n], rows[pivot]);
        for (std::size_t m = n + 1; m < 6; ++m) {
            const double factor = rows[m][n] / rows[n][n];
            for (std::size_t c = n; c < 7; ++c) rows[m][c] -= factor * rows[n][c];
        }
    }
    for (std::size_t n = 6; n-- > 0;) {
        double sum = rows[n][6];
        for (std::size_t c = n + 1; c < 6; ++c) sum -= rows[n][c] * x[c];
        x[n] = sum / rows[n][n];
    }
    return x;
}

class Fitting {
public:
    Fitting(const ClosedModel& model, const SurfaceSamples& samples, double size)
        : model_(model), points_(samples.points), hints_(points_.size(), Nearest::kNone), size_(size) {}

    Candidate run(Candidate candidate, int steps) {
        std::fill(hints_.begin(), hints_.end(), Nearest::kNone);
        double before = std::numeric_limits<double>::infinity();
        for (int step = 0; step < steps; ++step) {
            const Rigid moved = improve(candidate);
            // A placement that is far off and hardly gets nearer is not that of this model. Of a damaged model a few
            // samples come and go with each step, and it never rests.
            if (step % kPatience == kPatience - 1) {
                const double hardly = candidate.residual > kFits * size_ ? 0.98 : 1;
                if (candidate.residual >= hardly * before) break;
                before = candidate.residual;
            }
            const double turned = angleOf(moved.turn) * size_;
            if (turned + glm::length(moved.move) < 1e-5) break;
        }
        measure(candidate);
        return candidate;
    }

private:
    struct Pair {
        glm::dvec3 at;  // in the model's space
        ModelDistance nearest;
    };

    std::vector<Pair> pairs(const Rigid& placement) {
        std::vector<Pair> found(points_.size());
        parallelFor(points_.size(), 1024, [&](std::size_t first, std::size_t last) {
            for (std::size_t n = first; n < last; ++n) {
                found[n].at = placement(points_[n]);
                found[n].nearest = model_.distance(found[n].at, hints_[n], size_);
                hints_[n] = found[n].nearest.triangle;
            }
        });
        const auto usual = static_cast<std::ptrdiff_t>(found.size() * 9 / 10);
        std::vector<double> distances;
        distances.reserve(found.size());
        for (const Pair& pair : found) distances.push_back(std::abs(pair.nearest.distance));
        std::nth_element(distances.begin(), distances.begin() + usual, distances.end());
        const double most = std::max(kMostOfUsual * distances[static_cast<std::size_t>(usual)], kLeastOfSize * size_);
        std::erase_if(found, [most](const Pair& pair) { return std::abs(pair.nearest.distance) > most; });
        return found;
    }

    // One step; what it changes. The residual is that from before.
    Rigid improve(Candidate& candidate) {
        const std::vector<Pair> found = pairs(candidate.print_to_model);
        candidate.residual = residualOf(found);
        glm::dvec3 middle(0.0);
        for (const Pair& pair : found) middle += pair.at;
        middle /= static_cast<double>(found.size());
        std::array<Row, 6> rows{};
        for (const Pair& pair : found) {
            const glm::dvec3 normal = model_.normal(pair.nearest.triangle);
            // Lengths of turns are scaled by the size, so that the unknowns are alike.
            const glm::dvec3 lever = glm::cross(pair.at - middle, normal) / size_;
            const std::array<double, 6> slope{lever.x, lever.y, lever.z, normal.x, normal.y, normal.z};
            const double off = -glm::dot(pair.at - pair.nearest.point, normal);
            for (std::size_t r = 0; r < 6; ++r) {
                for (std::size_t c = 0; c < 6; ++c) rows[r][c] += slope[r] * slope[c];
                rows[r][6] += slope[r] * off;
            }
        }
        const std::array<double, 6> x = solve(rows);
        Rigid moved;
        moved.turn = turnBy(glm::dvec3(x[0], x[1], x[2]) / size_);
        moved.move = glm::dvec3(x[3], x[4], x[5]);
        const Rigid about_middle{moved.turn, middle + moved.move - moved.turn * middle};
        candidate.print_to_model = about_middle.after(candidate.print_to_model);
        return moved;
    }

    static double residualOf(const std::vector<Pair>& found) {
        double sum = 0;
        for (const Pair& pair : found) sum += pair.nearest.distance * pair.nearest.distance;
        return std::sqrt(sum / static_cast<double>(found.size()));
    }
    void measure(Candidate& candidate) { candidate.residual = residualOf(pairs(candidate.print_to_model)); }

    const ClosedModel& model_;
    const std::vector<glm::dvec3>& points_;
    std::vector<std::uint32_t> hints_;
    const double size_;  // mm, of the print
};

// The centroid, without what lies farther from it than kStranger times the median: a single point far away.
glm::dvec3 middleOf(const std::vector<glm::dvec3>& points) {
    constexpr double kStranger = 4;
    constexpr int kSteps = 20;
    std::vector<double> distances(points.size());
    glm::dvec3 middle(0.0);
    double most = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
        glm::dvec3 sum(0.0);
        std::size_t count = 0;
        for (const glm::dvec3& p : points) {
            if (step > 0 && glm::length(p - middle) > most) continue;
            sum += p;
            ++count;
        }
        if (count == 0) break;
        middle = sum / static_cast<double>(count);
        double farthest = 0;
        for (std::size_t n = 0; n < points.size(); ++n) {
            distances[n] = glm::length(points[n] - middle);
            farthest = std::max(farthest, distances[n]);
        }
        const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
        std::nth_element(distances.begin(), half, distances.end());
        most = kStranger * *half;
        if (farthest <= most) break;
    }
    return middle;
}

// mm: the farthest point from the middle.
double sizeOf(const SurfaceSamples& samples, const glm::dvec3& middle) {
    double size = 1e-9;
    for (const glm::dvec3& p : samples.points) size = std::max(size, glm::length(p - middle));
    return size;
}

// Turns of the print that bring each of the model's six sides down, the way the file has it first.
std::vector<glm::dmat3> sidesDown() {
    constexpr double kQuarter = 0.5 * std::numbers::pi;
    return {glm::dmat3(1.0),           turnBy({2 * kQuarter, 0, 0}), turnBy({kQuarter, 0, 0}),
            turnBy({-kQuarter, 0, 0}), turnBy({0, kQuarter, 0}),     turnBy({0, -kQuarter, 0})};
}

// Whether two candidates fit equally well: a fiftieth, or what steps that have converged still differ by.
bool alike(double a, double b, double size) { return std::abs(a - b) <= 0.02 * std::max(a, b) + 1e-4 * size; }

double turnOf(const Candidate& candidate) { return angleOf(candidate.print_to_model.turn); }

// Better, or as good with less of a turn.
bool before(const Candidate& a, const Candidate& b, double size) {
    return alike(a.residual, b.residual, size) ? turnOf(a) < turnOf(b) : a.residual < b.residual;
}

// Those to go on with: of the best ones, which are alike, those with the smallest turns.
std::vector<Candidate> chosen(std::vector<Candidate> candidates, std::size_t most, double size) {
    double best = candidates.front().residual;
    for (const Candidate& candidate : candidates) best = std::min(best, candidate.residual);
    std::stable_sort(candidates.begin(), candidates.end(), [best, size](const Candidate& a, const Candidate& b) {
        const bool a_best = alike(a.residual, best, size);
        const bool b_best = alike(b.residual, best, size);
        if (a_best != b_best) return a_best;
        return a_best ? turnOf(a) < turnOf(b) : a.residual < b.residual;
    });
    candidates.resize(std::min(candidates.size(), most));
    return candidates;
}

// Starts from both middles, and the best of them refined.
class Placing {
public:
    /// @param coarse  samples of the starts
    Placing(const ClosedModel& model, const SurfaceSamples& print, std::size_t coarse)
        : coarse_(thinned(print, affordable(model, print, coarse))),
          medium_(thinned(print, affordable(model, print, kMediumSamples))),
          print_middle_(middleOf(medium_.points)),
          model_samples_(sampleSurface(model.mesh(), kMediumSamples)),
          model_middle_(middleOf(model_samples_.points)),
          size_(sizeOf(coarse_, print_middle_)),
          rough_(model, coarse_, size_),
          better_(model, medium_, size_) {}

    double size() const { return size_; }
    bool alikeInSize() const {
        const double print = spreadOf(medium_);
        const double model = spreadOf(model_samples_);
        return model < kOtherSize * print && print < kOtherSize * model;
    }
    Candidate middles() { return rough_.run({{glm::dmat3(1.0), model_middle_ - print_middle_}, 0}, 0); }

    std::vector<Candidate> starts(std::span<const glm::dmat3> sides, int turns, int steps) {
        std::vector<Candidate> starts;
        for (const glm::dmat3& side : sides)
            for (int n = 0; n < turns; ++n) {
                const glm::dmat3 turn = side * turnBy({0, 0, 2 * std::numbers::pi * n / turns});
                starts.push_back(rough_.run({{turn, model_middle_ - turn * print_middle_}, 0}, steps));
            }
        return starts;
    }

    /// The best of one that was refined, if there is one, and of further starts.
    Candidate better(const std::optional<Candidate>& known, std::vector<Candidate> starts, std::size_t most,
                     int steps) {
        std::optional<Candidate> best = known;
        for (const Candidate& start : chosen(std::move(starts), most, size_)) {
            const Candidate refined = better_.run(start, steps);
            if (!best || before(refined, *best, size_)) best = refined;
        }
        return *best;
    }

private:
    const SurfaceSamples coarse_, medium_;
    const glm::dvec3 print_middle_;
    const SurfaceSamples model_samples_;
    const glm::dvec3 model_middle_;
    const double size_;  // mm, of the print
    Fitting rough_, better_;
};

}  // namespace

std::size_t affordable(const ClosedModel& model, const SurfaceSamples& print, std::size_t count) {
    const SurfaceSamples probes = thinned(print, kProbes);
    const glm::dvec3 move = middleOf(sampleSurface(model.mesh(), kProbes).points) - middleOf(probes.points);
    double work = 0;
    for (const glm::dvec3& p : probes.points) work += model.tree().nearest(p + move).looked_at;
    const double share = kUsualWork * static_cast<double>(probes.points.size()) / std::max(work, 1.0);
    if (share >= 1) return count;
    return std::max(kLeastAffordable, static_cast<std::size_t>(static_cast<double>(count) * share * share));
}

Fit fitModel(const ClosedModel& model, const SurfaceSamples& print) {
    if (print.points.size() < kFewestSamples)
        throw UsageError(
            fmt::format("--compare: {} points of the printed surface are too few to place the model; choose a "
                        "smaller --voxel-size",
                        print.points.size()));
    Placing placing(model, print, kCoarseSamples);
    if (!placing.alikeInSize()) {
        const Candidate middles = placing.middles();
        return {middles.print_to_model.inverse(), middles.residual, kCoarseSamples, false};
    }
    const std::vector<glm::dmat3> sides = sidesDown();
    const std::span all(sides);
    Candidate best = placing.better({}, placing.starts(all.first(1), kTurns, kCoarseSteps), kRefined, kFineSteps);
    // As it lies in the file: surfaces of beads are a tenth of a millimetre from the model, and hardly more.
    if (best.residual >= kFits * placing.size())
        best = placing.better(best, placing.starts(all.subspan(1), kTurns, kCoarseSteps), kRefined, kFineSteps);
    // Many samples are for models that fit.
    if (best.residual >= kFits * placing.size()) return {best.print_to_model.inverse(), best.residual, kMediumSamples};
    return refineFit(model, print, best.print_to_model.inverse());
}

std::optional<Rigid> roughFit(const ClosedModel& model, const SurfaceSamples& print, double near) {
    if (print.points.size() < kFewestSamples) return std::nullopt;
    Placing placing(model, print, kRoughSamples);
    std::vector<Candidate> starts = placing.starts(sidesDown(), kRoughTurns, kRoughSteps);
    const auto hopeful = [near](const Candidate& start) { return start.residual < near; };
    if (std::none_of(starts.begin(), starts.end(), hopeful)) return std::nullopt;
    return placing.better({}, std::move(starts), kRoughRefined, kRoughFineSteps).print_to_model.inverse();
}

double roughResidual(const ClosedModel& model, const SurfaceSamples& print, const Rigid& model_to_print) {
    const SurfaceSamples coarse = thinned(print, affordable(model, print, kCoarseSamples));
    return Fitting(model, coarse, sizeOf(coarse, middleOf(coarse.points)))
        .run({model_to_print.inverse(), 0}, 0)
        .residual;
}

Fit refineFit(const ClosedModel& model, const SurfaceSamples& print, const Rigid& model_to_print) {
    const SurfaceSamples fine = thinned(print, affordable(model, print, kFineSamples));
    Fitting exact(model, fine, sizeOf(fine, middleOf(fine.points)));
    const Candidate best = exact.run({model_to_print.inverse(), 0}, kFineSteps);
    return {best.print_to_model.inverse(), best.residual, fine.points.size()};
}

}  // namespace stratum::compare
