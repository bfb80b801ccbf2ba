#include "report/plan/plan_contact.h"

#include "base/parallel_for.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/print_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

namespace stratum::report {

std::uint64_t PlanBits::bitsOf(std::size_t column, std::span<const std::uint32_t> layers) const {
    const std::vector<Entry>& entries = entries_[column];
    std::uint64_t bits = 0;
    for (const std::uint32_t layer : layers) {
        const auto found = std::lower_bound(entries.begin(), entries.end(), layer,
                                            [](const Entry& entry, std::uint32_t l) { return entry.layer < l; });
        if (found != entries.end() && found->layer == layer) bits |= found->bits;
    }
    return bits;
}

PlanBits::Window::Window(const PlanBits& bits, std::size_t column, std::span<const std::uint32_t> below, int most)
    : most_(std::min(most, kMost)),
      margin_((most_ + 7) / 8 * 8),
      words_(static_cast<std::size_t>(2 * margin_ + 8 + 63) / 64),
      rows_(static_cast<std::size_t>(2 * margin_ + 8) * words_) {
    const int columns = margin_ / 8;
    for (int di = -columns; di <= columns; ++di)
        for (int dj = -columns; dj <= columns; ++dj) {
            const std::size_t other = bits.bins_.find(bits.bins_.columnI(column) + di, bits.bins_.columnJ(column) + dj);
            if (other == voxelize::PlanBins::kNone) continue;
            const std::uint64_t word = bits.bitsOf(other, below);
            if (word == 0) continue;
            // Eight bits never lie across two words.
            const int bit = 8 * dj + margin_;
            for (int x = 0; x < 8; ++x) row(8 * di + x)[bit / 64] |= (word >> (8 * x) & 0xffU) << (bit % 64);
        }
}

// From y to the nearest bit of a row; more than `most_` if there is none within.
int PlanBits::Window::steps(const std::uint64_t* row, int y) const {
    const int at = y + margin_;
    int up = most_ + 1;
    for (int word = at / 64; word < static_cast<int>(words_) && 64 * word - at <= most_; ++word) {
        const std::uint64_t bits = word == at / 64 ? row[word] >> (at % 64) << (at % 64) : row[word];
        if (bits == 0) continue;
        up = 64 * word + std::countr_zero(bits) - at;
        break;
    }
    int down = most_ + 1;
    for (int word = at / 64; word >= 0 && at - (64 * word + 63) <= most_; --word) {
        const int left = 63 - at % 64;
        const std::uint64_t bits = word == at / 64 ? row[word] << left >> left : row[word];
        if (bits == 0) continue;
        down = at - (64 * word + 63 - std::countl_zero(bits));
        break;
    }
    return std::min(up, down);
}

double PlanBits::Window::distance2(int x, int y) const {
    double least = std::numeric_limits<double>::infinity();
    for (int dx = -most_; dx <= most_; ++dx) {
        const int dy = steps(row(x + dx), y);
        if (dy <= most_) least = std::min(least, static_cast<double>(dx * dx + dy * dy));
    }
    return least;
}

namespace {

using voxelize::kColumnSamples;
using voxelize::PlanField;

constexpr std::size_t kPlanGrain = 16;
constexpr float kFarPixels = 1e30F;  // nothing there
// Integers, because their sum does not depend on the order of threads; parts of a pixel.
constexpr double kUnit = 1.0 / (1 << 24);
std::int64_t unitsOf(double pixels) { return std::llround(pixels / kUnit); }

// Pixels with nothing below, and of them those beyond each cone.
using ConeCounts = std::array<std::int64_t, kConeAngles.size() + 1>;

struct Sums {
    explicit Sums(std::size_t layers) : area(layers), supported(layers), contact(layers) {}
    std::vector<std::int64_t> area, supported, contact;  // by layer of the stack
};

// What lies under each layer of the stack.
struct Under {
    std::vector<std::vector<std::uint32_t>> layers;
    std::vector<bool> bed;
};

Under underOf(const voxelize::LayerStack& stack) {
    Under under{std::vector<std::vector<std::uint32_t>>(stack.layers.size()), std::vector<bool>(stack.layers.size())};
    for (const voxelize::Weld& weld : stack.welds) under.layers[weld.upper].push_back(weld.lower);
    for (std::size_t n = 0; n < stack.layers.size(); ++n) {
        const voxelize::Layer& layer = stack.layers[n];
        under.bed[n] = std::abs(layer.center_z - layer.halfHeight()) <= voxelize::kWeldGap * 2 * layer.halfHeight();
    }
    return under;
}

// Pixels of the plan: a lattice whose columns the beads' outlines reach.
voxelize::Lattice pixelsOf(const voxelize::Lattice& lattice) {
    voxelize::Lattice pixels = lattice;
    if (lattice.layer_height > 0)
        pixels.voxel_size = std::clamp(lattice.voxel_size, lattice.layer_height / 4, lattice.layer_height / 2);
    pixels.half_width = 1;
    return pixels;
}

// Four pixels in a register, by the compiler: choices among them without branches, which are hard to foretell here.
using Four = float __attribute__((vector_size(16)));
constexpr std::size_t kFours = kColumnSamples / 4;

Four lesser(const Four& a, const Four& b) { return a < b ? a : b; }
Four greater(const Four& a, const Four& b) { return a > b ? a : b; }
Four clamped(const Four& a) { return lesser(greater(a, Four{}), Four{1, 1, 1, 1}); }
float sumOf(const Four& a) { return (a[0] + a[1]) + (a[2] + a[3]); }
Four pixelsAt(const PlanField& d, std::size_t four, float per_pixel) {
    Four v;
    std::memcpy(&v, d.v + 4 * four, sizeof v);
    return v * per_pixel;
}

// The share of a pixel that lies within an edge at this distance of its middle, in pixels; exact on average over the
// places that an edge may have, whatever its direction.
Four covered(const Four& distance) { return clamped(0.5F - distance); }

// The fields of a column's layers, while those above may rest on them.
class ColumnFields {
public:
    explicit ColumnFields(const voxelize::LayerStack& stack) : at_(stack.layers.size(), kNone) {}

    void clear() {
        for (const std::uint32_t layer : layers_) at_[layer] = kNone;
        layers_.clear();
        fields_.clear();
    }
    void add(std::uint32_t layer, const PlanField& d) {
        at_[layer] = layers_.size();
        layers_.push_back(layer);
        fields_.push_back(d);
    }
    const PlanField* find(std::uint32_t layer) const { return at_[layer] == kNone ? nullptr : &fields_[at_[layer]]; }

private:
    static constexpr std::size_t kNone = ~std::size_t{0};
    std::vector<std::size_t> at_;
    std::vector<std::uint32_t> layers_;
    std::vector<PlanField> fields_;
};

class Measurement {
public:
    Measurement(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack, const voxelize::Lattice& lattice)
        : toolpath_(toolpath),
          stack_(stack),
          pixels_(pixelsOf(lattice)),
          under_(underOf(stack)),
          columns_(toolpath, stack, pixels_),
          bits_(columns_.bins()) {}

    PlanContact run() {
        const std::size_t count = stack_.layers.size();
        Sums sums(count);
        {
            PerThread<Sums> threads([count] { return Sums(count); });
            PerThread<ColumnFields> fields([this] { return ColumnFields(stack_); });
            columns_.forEach(voxelize::PrintColumns::kAllBeads, [&](std::size_t c, voxelize::LeafColumn& column) {
                measureColumn(c, column, fields.local(), threads.local());
            });
            for (const Sums& one : threads)
                for (std::size_t n = 0; n < count; ++n) {
                    sums.area[n] += one.area[n];
                    sums.supported[n] += one.supported[n];
                    sums.contact[n] += one.contact[n];
                }
        }
        return collect(sums, conesOf());
    }

private:
    void measureColumn(std::size_t c, voxelize::LeafColumn& column, ColumnFields& fields, Sums& sums) {
        fields.clear();
        column.forEachField([&](std::uint32_t layer, const PlanField& d) {
            const bool in_outline = measureLayer(c, layer, d, fields, sums);
            if (in_outline) fields.add(layer, d);
        });
    }

    // The flats and the edges of what lies below a layer, by pixel: the least distances to them, in pixels.
    struct Below {
        Four flat[kFours], edge[kFours];
    };
    void gatherBelow(std::uint32_t layer, const ColumnFields& fields, Below& below) const {
        const float none = under_.bed[layer] ? -kFarPixels : kFarPixels;
        for (std::size_t n = 0; n < kFours; ++n) below.flat[n] = below.edge[n] = Four{none, none, none, none};
        if (under_.bed[layer]) return;
        const auto per_pixel = static_cast<float>(1 / pixels_.voxel_size);
        for (const std::uint32_t lower : under_.layers[layer]) {
            const PlanField* field = fields.find(lower);
            if (field == nullptr) continue;
            const float radius = static_cast<float>(stack_.layers[lower].radius) * per_pixel;
            for (std::size_t n = 0; n < kFours; ++n) {
                const Four other = pixelsAt(*field, n, per_pixel);
                below.flat[n] = lesser(below.flat[n], other);
                below.edge[n] = lesser(below.edge[n], other - radius);
            }
        }
    }

    // Whether some of the column lies within the layer's outline. In floats: a pixel's share is good to 1e-6.
    bool measureLayer(std::size_t c, std::uint32_t layer, const PlanField& d, const ColumnFields& fields, Sums& sums) {
        const auto per_pixel = static_cast<float>(1 / pixels_.voxel_size);
        const float radius = static_cast<float>(stack_.layers[layer].radius) * per_pixel;
        Four least{kFarPixels, kFarPixels, kFarPixels, kFarPixels};
        for (std::size_t n = 0; n < kFours; ++n) least = lesser(least, pixelsAt(d, n, per_pixel));
        if (!(std::min({least[0], least[1], least[2], least[3]}) - radius < 0.5F)) return false;
        Below below;
        gatherBelow(layer, fields, below);
        Four area{};
        Four supported{};
        Four contact{};
        std::uint64_t within = 0;
        for (std::size_t n = 0; n < kFours; ++n) {
            const Four flat = pixelsAt(d, n, per_pixel);
            const Four edge = flat - radius;
            area += covered(edge);
            supported += covered(greater(edge, below.edge[n]));
            contact += covered(greater(flat, below.flat[n]));
            for (std::size_t lane = 0; lane < 4; ++lane)
                within |= static_cast<std::uint64_t>(edge[lane] < 0) << (4 * n + lane);
        }
        sums.area[layer] += unitsOf(static_cast<double>(sumOf(area)));
        sums.supported[layer] += unitsOf(static_cast<double>(sumOf(supported)));
        sums.contact[layer] += unitsOf(static_cast<double>(sumOf(contact)));
        if (within != 0) bits_.add(c, layer, within);
        return true;
    }

    // By layer of the stack, pixels beyond each cone.
    std::vector<ConeCounts> conesOf() {
        using Counts = std::vector<ConeCounts>;
        const std::size_t count = stack_.layers.size();
        PerThread<Counts> threads([count] { return Counts(count); });
        parallelFor(bits_.columnCount(), kPlanGrain, [&](std::size_t first, std::size_t last) {
            Counts& counts = threads.local();
            for (std::size_t c = first; c != last; ++c)
                for (const PlanBits::Entry& entry : bits_.of(c)) {
                    if (under_.bed[entry.layer]) continue;
                    const double height = 2 * stack_.layers[entry.layer].halfHeight() / pixels_.voxel_size;
                    std::array<double, kConeAngles.size() + 1> reach{};
                    for (std::size_t a = 0; a < kConeAngles.size(); ++a)
                        // From the middle of a pixel to that of one within, whose outline is half a pixel farther.
                        reach[a + 1] = height * std::tan(kConeAngles[a] * std::numbers::pi / 180) + 0.5;
                    const auto beyond = bits_.countBeyond(c, entry, under_.layers[entry.layer], reach);
                    for (std::size_t a = 0; a < reach.size(); ++a) counts[entry.layer][a] += beyond[a];
                }
        });
        Counts sums(count);
        for (const Counts& one : threads)
            for (std::size_t n = 0; n < count; ++n)
                for (std::size_t a = 0; a < sums[n].size(); ++a) sums[n][a] += one[n][a];
        return sums;
    }

    PlanContact collect(const Sums& sums, const std::vector<ConeCounts>& cones) const {
        PlanContact contact;
        contact.layers.resize(toolpath_.layer_count + std::size_t{1});
        const double pixel = pixels_.voxel_size * pixels_.voxel_size;
        for (std::size_t n = 0; n < stack_.layers.size(); ++n) {
            const double area = static_cast<double>(sums.area[n]) * kUnit * pixel;
            const std::uint32_t bead = stack_.beads[stack_.layers[n].first];
            LayerContact& layer = contact.layers.at(toolpath_.runOf(toolpath_.beads[bead]).layer);
            layer.area += area;
            const double supported = static_cast<double>(sums.supported[n]) * kUnit * pixel;
            layer.supported += supported;
            layer.contact += static_cast<double>(sums.contact[n]) * kUnit * pixel;
            // Whole pixels share the area that was measured by parts of pixels.
            const double each = cones[n][0] > 0 ? (area - supported) / static_cast<double>(cones[n][0]) : 0;
            for (std::size_t a = 0; a < kConeAngles.size(); ++a)
                layer.beyond_cone[a] += static_cast<double>(cones[n][a + 1]) * each;
            if (!under_.bed[n]) continue;
            contact.bed_contact += static_cast<double>(sums.contact[n]) * kUnit * pixel;
            contact.bed_outline += area;
            layer.on_bed = true;
        }
        double level = 0;
        double all = 0;
        for (std::uint32_t rank = 0; rank < stack_.beads.size(); ++rank) {
            const double volume = gcode::laidVolume(toolpath_, stack_.beads[rank]);
            all += volume;
            if (rank < stack_.first_direct) level += volume;
        }
        contact.level_share = all > 0 ? level / all : 0;
        return contact;
    }

    const gcode::Toolpath& toolpath_;
    const voxelize::LayerStack& stack_;
    const voxelize::Lattice pixels_;
    const Under under_;
    const voxelize::PrintColumns columns_;
    PlanBits bits_;
};

}  // namespace

PlanContact measureContact(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                           const voxelize::Lattice& lattice) {
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, selection, voxelize::LayersBy::plane_and_number);
    return Measurement(toolpath, stack, lattice).run();
}

}  // namespace stratum::report
