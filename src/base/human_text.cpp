#include "base/human_text.h"

#include <fmt/format.h>

namespace stratum {

std::string humanBytes(double bytes) {
    if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes * 1e-9);
    if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes * 1e-6);
    if (bytes >= 1e3) return fmt::format("{:.1f} kB", bytes * 1e-3);
    return fmt::format("{:.0f} B", bytes);
}

std::string humanCount(double count) {
    if (count >= 1e6) return fmt::format("{:.1f} M", count * 1e-6);
    if (count >= 1e4) return fmt::format("{:.1f} k", count * 1e-3);
    return fmt::format("{:.0f}", count);
}

std::string counted(std::size_t number, std::string_view noun) {
    return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

}  // namespace stratum
