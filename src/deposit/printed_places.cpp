#include "deposit/printed_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace stratum::deposit
