#include "deposit/string_recorder.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace stratum::deposit {
namespace {

constexpr double kThinnestSection = std::numbers::pi / 4 * kThinnestThread * kThinnestThread;  // mm^2
// Neighbours of one direction are one piece while their sections are this near to its mean, as a fraction.
constexpr double kSameThread = 0.1;
constexpr double kNoTravel = 1e-3;  // mm in the plan: such a piece only rises

}  // namespace

void StringRecorder::print(double x0, double y0, double x1, double y1, double z, double half_width) {
    places_.add(x0, y0, x1, y1, z, half_width);
    z_ = z;
}

void StringRecorder::ooze(const Ooze& piece, std::uint32_t bead) {
    bead_ = bead;
    const double length = std::hypot(piece.x1 - piece.x0, piece.y1 - piece.y0);
    if (!broken_ && length > kNoTravel) {
        broken_ = piece.volume < kThinnestSection * length;
        if (!broken_ && !places_.under(0.5 * (piece.x0 + piece.x1), 0.5 * (piece.y0 + piece.y1), z_)) {
            run_.push_back({piece, length});
            return;
        }
        close(!broken_);
    }
    leave(piece.volume);
}

// The run is a string, or too short to be one.
void StringRecorder::close(bool held) {
    double length = 0;
    double volume = 0;
    for (const Part& part : run_) {
        length += part.length;
        volume += part.ooze.volume;
    }
    if (length < kShortestString) {
        leave(volume);
        run_.clear();
        return;
    }
    double from = 0;
    std::size_t move = 0;
    for (const auto& [ooze, mm] : run_) {
        FlowString* const last = move == ooze.move ? &strings_.back() : nullptr;
        const double last_mm = last != nullptr ? last->to - last->from : 0;
        if (last != nullptr && std::abs(ooze.volume * last_mm - last->volume * mm) <= kSameThread * last->volume * mm) {
            last->x1 = ooze.x1;
            last->y1 = ooze.y1;
            last->to = from + mm;
            last->volume += ooze.volume;
            last->seconds = ooze.start + ooze.seconds - last->start;
        } else {
            strings_.push_back({bead_, ooze.x0, ooze.y0, ooze.x1, ooze.y1, z_, ooze.volume, ooze.start, ooze.seconds,
                                from, from + mm, held ? length : 0});
        }
        move = ooze.move;
        from += mm;
    }
    run_.clear();
}

StringRecorder::Rest StringRecorder::finish(FlowRecord& record) {
    close(true);
    record.strings.insert(record.strings.end(), strings_.begin(), strings_.end());
    strings_.clear();
    broken_ = false;
    return std::exchange(rest_, {});
}

}  // namespace stratum::deposit
