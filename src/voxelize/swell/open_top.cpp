#include "voxelize/swell/open_top.h"

#include <algorithm>

namespace stratum::voxelize {

void coverTops(const LayerStack& stack, std::vector<OpenTop>& tops) {
    for (const OpenTop& upper : tops) {
        auto weld = std::lower_bound(stack.welds.begin(), stack.welds.end(), upper.layer,
                                     [](const Weld& pair, std::uint32_t layer) { return pair.upper < layer; });
        for (; weld != stack.welds.end() && weld->upper == upper.layer; ++weld) {
            const auto lower =
                std::lower_bound(tops.begin(), tops.end(), weld->lower,
                                 [](const OpenTop& top, std::uint32_t layer) { return top.layer < layer; });
            if (lower != tops.end() && lower->layer == weld->lower) lower->open &= ~upper.solid;
        }
    }
}

}  // namespace stratum::voxelize
