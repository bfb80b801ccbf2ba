#include "voxelize/swell/open_top.h"

#include <algorithm>

namespace stratum::voxelize {

void coverTops(const LayerStack& stack, std::vector<OpenTop>& tops) {
    // Both lists ascend by the upper layer, and what it lies on is most often the top before it.
    auto weld = stack.welds.begin();
    for (auto upper = tops.begin(); upper != tops.end(); ++upper) {
        if (weld != stack.welds.end() && weld->upper < upper->layer)
            weld = std::lower_bound(weld, stack.welds.end(), upper->layer,
                                    [](const Weld& pair, std::uint32_t layer) { return pair.upper < layer; });
        for (; weld != stack.welds.end() && weld->upper == upper->layer; ++weld) {
            auto lower = upper == tops.begin() ? upper : upper - 1;
            if (lower->layer != weld->lower)
                lower = std::lower_bound(tops.begin(), tops.end(), weld->lower,
                                         [](const OpenTop& top, std::uint32_t layer) { return top.layer < layer; });
            if (lower != tops.end() && lower->layer == weld->lower) lower->open &= ~upper->solid;
        }
    }
}

}  // namespace stratum::voxelize
