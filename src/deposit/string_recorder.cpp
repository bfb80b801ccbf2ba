#include "deposit/string_recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace stratum::deposit {
namespace {

constexpr double kPrintedStep = 0.5 * PrintedPlaces::kCell;
constexpr double kMostAlong = 16384;  // steps along a line
constexpr double kMostAcross = 64;
constexpr double kFarthest = 1e8;  // cells from the origin

}  // namespace

float* PrintedPlaces::cell(double x, double y, bool make) {
    const auto index = [](double mm) {
        return static_cast<std::int64_t>(std::floor(std::clamp(mm / kCell, -kFarthest, kFarthest)));
    };
    const std::int64_t column = index(x);
    const std::int64_t row = index(y);
    const auto tile = [](std::int64_t n) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(n >> 4)); };
    const std::uint64_t key = tile(column) << 32U | tile(row);
    if (last_ == nullptr || last_key_ != key) {
        auto found = tiles_.find(key);
        if (found == tiles_.end()) {
            if (!make) return nullptr;
            if (tiles_.size() >= kMostTiles) {
                full_ = true;
                return nullptr;
            }
            found = tiles_.try_emplace(key).first;
            found->second.fill(-std::numeric_limits<float>::infinity());
        }
        last_key_ = key;
        last_ = &found->second;
    }
    return &(
        *last_)[static_cast<std::size_t>(row & (kSide - 1)) * kSide + static_cast<std::size_t>(column & (kSide - 1))];
}

void PrintedPlaces::add(double x0, double y0, double x1, double y1, double z, double half_width) {
    if (full_) return;
    const double length = std::hypot(x1 - x0, y1 - y0);
    const auto steps = [](double mm, double most) {
        return static_cast<int>(std::clamp(std::ceil(mm / kPrintedStep), 1.0, most));
    };
    const int along = steps(length, kMostAlong);
    const int across = steps(2 * half_width, kMostAcross);
    const double nx = length > 0 ? -(y1 - y0) / length * half_width : half_width;
    const double ny = length > 0 ? (x1 - x0) / length * half_width : 0;
    for (int n = 0; n <= along; ++n)
        for (int m = 0; m <= across; ++m) {
            const double share = static_cast<double>(n) / along;
            const double side = 2.0 * m / across - 1;
            float* const top = cell(std::lerp(x0, x1, share) + side * nx, std::lerp(y0, y1, share) + side * ny, true);
            if (top == nullptr) return;
            *top = std::max(*top, static_cast<float>(z));
        }
}

bool PrintedPlaces::under(double x, double y, double z) {
    if (full_ || !(z > kLeastAir)) return true;
    const float* const top = cell(x, y, false);
    return top != nullptr && static_cast<double>(*top) > z - kLeastAir;
}

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
