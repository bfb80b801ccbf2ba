// What of a move's E comes out: filament that was drawn back, for a retraction or another tool, comes back first.
#include "gcode/machine/machine.h"

#include <algorithm>

namespace stratum::gcode {
namespace {

// Filament retracted further than this, in mm, is unloaded: the longest retractions of Bowden printers are 16 mm,
// unloading takes 50 and more.
constexpr double kUnloaded = 25;

}  // namespace

double Machine::extrudedOf(double drive, bool in_place) {
    // Multi-material units swap filament while the head travels over the wipe tower (PrusaSlicer's "CP TOOLCHANGE"):
    // metres of E only bring the filament back. Ordinary retractions are not corrected.
    const double mm = volumetric_ ? drive / filamentArea() : drive;
    const std::size_t nozzle = settings_.shared_nozzle ? 0 : tool_;
    if (flushing_ && in_place) flushed_ += mm;
    double& drawn_back = drawn_back_[nozzle];
    bool& unloaded = unloaded_[nozzle];
    if (drive < 0) {
        drawn_back -= mm;
        if (drawn_back > kUnloaded) unloaded = true;
        return drive;
    }
    if (!unloaded) {
        drawn_back = in_place ? std::max(0.0, drawn_back - mm) : 0;
        return drive;
    }
    const double fetched = std::min(drawn_back, mm);
    drawn_back -= fetched;
    unloaded = drawn_back > 0;
    return drive * (1 - fetched / mm);
}

double Machine::freshOf(double drive) const {
    const double mm = volumetric_ ? drive / filamentArea() : drive;
    const double drawn_back = drawn_back_[settings_.shared_nozzle ? 0 : tool_];
    return mm > drawn_back ? drive * (1 - drawn_back / mm) : 0;
}

void Machine::loaded() {
    const std::size_t nozzle = settings_.shared_nozzle ? 0 : tool_;
    drawn_back_[nozzle] = 0;
    unloaded_[nozzle] = false;
}

}  // namespace stratum::gcode
