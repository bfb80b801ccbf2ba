#include "march/brick/macro_cell.h"

#include "base/parallel_for.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace stratum::march {
namespace {

// One octant. The largest cube from a macro cell is one larger than the least of those from the seven next to it.
class EmptyCubes {
public:
    EmptyCubes(std::span<MacroCell> macros, const std::array<int, 3>& count, Octant octant)
        : macros_(macros), count_(count), octant_(octant), stride_{std::ptrdiff_t{count[1]} * count[2], count[2], 1} {
        for (std::size_t axis = 0; axis < 3; ++axis) step_[axis] = (octant & 4U >> axis) != 0 ? -1 : 1;
    }

    // From the far end on.
    void measure() {
        std::array<int, 3> n{};
        for (n[0] = 0; n[0] < count_[0]; ++n[0])
            for (n[1] = 0; n[1] < count_[1]; ++n[1])
                for (n[2] = 0; n[2] < count_[2]; ++n[2]) measure(n);
    }

private:
    // `n`: steps from the far end, and so how many there are ahead.
    void measure(const std::array<int, 3>& n) {
        std::ptrdiff_t at = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            at += stride_[axis] * (step_[axis] > 0 ? count_[axis] - 1 - n[axis] : n[axis]);
        MacroCell& macro = macros_[static_cast<std::size_t>(at)];
        if (macro.bricks != 0) return;
        int least = std::numeric_limits<std::uint8_t>::max() - 1;
        for (unsigned some = 1; some < 8; ++some) {
            std::ptrdiff_t next = at;
            bool within = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if ((some >> axis & 1) == 0) continue;
                next += stride_[axis] * step_[axis];
                within = within && n[axis] > 0;
            }
            if (!within) continue;
            const MacroCell& other = macros_[static_cast<std::size_t>(next)];
            least = std::min(least, other.bricks != 0 ? 0 : other.emptyAhead(octant_));
        }
        macro.rest[octant_] = static_cast<std::uint8_t>(least + 1);
    }

    const std::span<MacroCell> macros_;
    const std::array<int, 3> count_;
    const Octant octant_;
    const std::array<std::ptrdiff_t, 3> stride_;
    std::array<int, 3> step_;
};

}  // namespace

void measureEmptySpace(std::span<MacroCell> macros, const std::array<int, 3>& count) {
    parallelFor(8, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t octant = first; octant != last; ++octant)
            EmptyCubes(macros, count, static_cast<Octant>(octant)).measure();
    });
}

}  // namespace stratum::march
