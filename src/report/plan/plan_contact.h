// What layers rest on, from their plan fields: the bed, the layer below, nothing.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"
#include "voxelize/beads/plan_bins.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stratum::report {

// Which pixels of the plan lie within the outline of each layer: a bit a pixel, where there are any.

/// Columns of 8 x 8 pixels; bit x * 8 + y of a word.
class PlanBits {
public:
    /// `bins` must outlive it.
    explicit PlanBits(const voxelize::PlanBins& bins) : bins_(bins), entries_(bins.size()) {}

    struct Entry {
        std::uint32_t layer = 0;
        std::uint64_t bits = 0;
    };

    /// Layers of a column ascend. Columns may be filled by several threads.
    void add(std::size_t column, std::uint32_t layer, std::uint64_t bits) { entries_[column].push_back({layer, bits}); }
    std::size_t columnCount() const { return entries_.size(); }
    std::span<const Entry> of(std::size_t column) const { return entries_[column]; }

    /// How many pixels of an entry are farther from all pixels of the layers `below` than each reach (pixels,
    /// ascending).
    template <std::size_t N>
    std::array<std::int64_t, N> countBeyond(std::size_t column, const Entry& entry,
                                            std::span<const std::uint32_t> below,
                                            const std::array<double, N>& reach) const {
        std::array<std::int64_t, N> counts{};
        forEachGap(column, entry, below, static_cast<int>(std::ceil(reach.back())), [&](double distance2) {
            for (std::size_t n = 0; n < N; ++n) counts[n] += distance2 > reach[n] * reach[n] ? 1 : 0;
        });
        return counts;
    }

private:
    std::uint64_t bitsOf(std::size_t column, std::span<const std::uint32_t> layers) const;
    /// Calls visit(squared distance) of each pixel that is in none of the layers below: to the nearest that is, or
    /// infinite beyond `most` pixels (up to kMost are looked at).
    template <typename Visit>
    void forEachGap(std::size_t column, const Entry& entry, std::span<const std::uint32_t> below, int most,
                    const Visit& visit) const {
        const std::uint64_t free = entry.bits & ~bitsOf(column, below);
        if (free == 0) return;
        const Window window(*this, column, below, most);
        for (std::uint64_t rest = free; rest != 0; rest &= rest - 1) {
            const int p = __builtin_ctzll(rest);
            visit(window.distance2(p >> 3, p & 7));
        }
    }

    // Pixels: a layer 30 times as high as the usual one.
    static constexpr int kMost = 512;
    // Rows of pixels along y around a column: bit y + margin_ of a row of words.
    class Window {
    public:
        Window(const PlanBits& bits, std::size_t column, std::span<const std::uint32_t> below, int most);
        double distance2(int x, int y) const;

    private:
        std::uint64_t* row(int x) { return rows_.data() + static_cast<std::size_t>(x + margin_) * words_; }
        const std::uint64_t* row(int x) const { return rows_.data() + static_cast<std::size_t>(x + margin_) * words_; }
        int steps(const std::uint64_t* row, int y) const;

        int most_, margin_;  // pixels; the margin is whole columns
        std::size_t words_;
        std::vector<std::uint64_t> rows_;
    };

    const voxelize::PlanBins& bins_;
    std::vector<std::vector<Entry>> entries_;
};

/// Angles from the vertical, degrees, of the cones of PlanContact::unsupported.
constexpr std::array<double, 3> kConeAngles = {45, 60, 75};

/// Areas of the plan, mm^2. A layer's outline is that of its beads at their widest.
struct LayerContact {
    double area = 0;       ///< within the outline
    double supported = 0;  ///< of it, within the outline of what lies directly below, or on the bed
    double contact = 0;    ///< of flats that touch flats below, or the bed
    /// Of the outline: what is farther beyond the outline below than height times the tangent of each cone's angle.
    std::array<double, kConeAngles.size()> beyond_cone{};
    bool on_bed = false;  ///< most of it lies on the bed
};

struct PlanContact {
    /// By Run::layer; of a layer without level beads all 0.
    std::vector<LayerContact> layers;
    double bed_contact = 0;  ///< flats on the bed, z = 0
    double bed_outline = 0;  ///< the outline of what lies on the bed
    double level_share = 0;  ///< of the volume of the beads, level pressed ones: sloped and round ones are not counted
};

/// Areas are sums over pixels of a quarter to a half of a layer height, each covered in part by what a straight edge at
/// its distance leaves; those beyond a cone
/// are shares of them, counted in whole pixels. Layers of one plane count apart by their numbers. Layers rest on layers
/// whose top plane is their bottom plane (LayerStack::welds). Parallel; the same areas for any number of threads.
PlanContact measureContact(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                           const voxelize::Lattice& lattice);

}  // namespace stratum::report
