// Work that is divided among processes: nothing twice, nothing left out, sums of any order the same.
#include "base/error.h"
#include "base/shard.h"
#include "shade/film/exact_sums.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"
#include "voxelize/grid/leaf_share.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace stratum::study {
namespace {

// Of the blocks of a print, those that no shard or more than one has.
double wrongBlocks(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice, int shards) {
    const auto beads = allBeads(toolpath);
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, beads);
    const std::size_t all = voxelize::shareOf(toolpath, stack, lattice, {0, 1}).blocks.end;
    std::size_t next = 0;
    double wrong = 0;
    for (int n = 0; n < shards; ++n) {
        const voxelize::BlockRange blocks = voxelize::shareOf(toolpath, stack, lattice, {n, shards}).blocks;
        wrong += std::abs(static_cast<double>(blocks.first) - static_cast<double>(next));
        wrong += blocks.end < blocks.first ? 1 : 0;
        next = blocks.end;
    }
    return wrong + std::abs(static_cast<double>(next) - static_cast<double>(all));
}

gcode::Toolpath oneMetre() {
    gcode::Toolpath toolpath;
    addBead(toolpath, -300, -400, kBeadHeight, 300, 400, kBeadHeight, kBeadWidth, kBeadHeight);
    return toolpath;
}

// Sums that differ when their values are added in another order, or by several processes.
double sumsThatDiffer(const std::vector<double>& values) {
    constexpr int kOrders = 20;
    shade::ExactSums first(1);
    for (const double v : values) first.add(0, v);
    double differ = 0;
    std::mt19937_64 random(7);
    std::vector<double> order = values;
    for (int n = 0; n < kOrders; ++n) {
        std::shuffle(order.begin(), order.end(), random);
        std::array<shade::ExactSums, 3> parts{shade::ExactSums(1), shade::ExactSums(1), shade::ExactSums(1)};
        for (std::size_t k = 0; k < order.size(); ++k) parts.at(k % parts.size()).add(0, order[k]);
        for (std::size_t k = 1; k < parts.size(); ++k) parts[0].add(0, parts.at(k), 0);
        differ +=
            std::bit_cast<std::uint64_t>(parts[0].value(0)) == std::bit_cast<std::uint64_t>(first.value(0)) ? 0 : 1;
    }
    return differ;
}

std::vector<double> mixedValues(double least, double most, bool signs) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> exponent(std::log10(least), std::log10(most));
    std::vector<double> values;
    values.reserve(3000);
    for (int n = 0; n < 3000; ++n) {
        const double v = std::pow(10.0, exponent(random));
        values.push_back(signs && n % 2 == 1 ? -v : v);
    }
    return values;
}

}  // namespace

std::vector<StabilityCase> shardCases() {
    std::vector<StabilityCase> cases;
    for (const int shards : {1, 2, 7, 1000}) {
        cases.push_back({"shards", fmt::format("a small print among {}", shards), "blocks twice or left out", 0,
                         "all blocks are somebody's, and one's alone", [shards] {
                             return wrongBlocks(crossedLines(kBeadWidth, kBeadHeight), plainLattice(0.05, kBeadHeight),
                                                shards);
                         }});
        cases.push_back({"shards", fmt::format("a metre in one bead among {}", shards), "blocks twice or left out", 0,
                         "all blocks are somebody's, and one's alone",
                         [shards] { return wrongBlocks(oneMetre(), plainLattice(0.1, kBeadHeight), shards); }});
    }
    struct Range {
        const char* name;
        double least, most;
        bool signs;
    };
    for (const Range& range :
         {Range{"values alike", 1, 2, false}, Range{"30 orders of magnitude", 1e-15, 1e15, false},
          Range{"30 orders, both signs", 1e-15, 1e15, true}, Range{"300 orders, both signs", 1e-150, 1e150, true}})
        cases.push_back({"shards", fmt::format("sums of samples: {}", range.name), "orders with another sum", 0,
                         "sums have no rounding, so that no order matters",
                         [range] { return sumsThatDiffer(mixedValues(range.least, range.most, range.signs)); }});
    const std::vector<std::pair<const char*, const char*>> texts{
        {"no text", ""},
        {"a number alone", "1"},
        {"a part beyond the last", "3/3"},
        {"a part before the first", "-1/2"},
        {"of nothing", "0/0"},
        {"of less than nothing", "1/-2"},
        {"letters behind", "0/2x"},
        {"an exponent", "1e0/2"},
        {"of more than there are numbers", "0/99999999999999999999"},
        {"letters alone", "a/b"}};
    for (const auto& [name, text] : texts)
        cases.push_back({"shards", fmt::format("--shard, {}", name), "accepted (1) or refused with a message (0)", 0,
                         "what is no part of a whole is refused", [text = text] {
                             try {
                                 (void)parseShard(text);
                             } catch (const UsageError&) {
                                 return 0.0;
                             }
                             return 1.0;
                         }});
    return cases;
}

}  // namespace stratum::study
