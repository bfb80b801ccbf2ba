#include "gcode/toolpath/warning_log.h"

#include <fmt/format.h>

#include <utility>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMaxTexts = 100;
constexpr std::string_view kOverflow = "more kinds of warnings than are listed";

}  // namespace

std::string describe(const Warning& warning, std::string_view name) {
    return fmt::format("{}:{}: {}{}", name, warning.first_line, warning.text,
                       warning.count > 1 ? fmt::format(" ({} times)", warning.count) : "");
}

void WarningLog::add(std::string_view text, std::uint32_t line) {
    if (const auto found = index_.find(text); found != index_.end()) {
        ++warnings_[found->second].count;
        return;
    }
    if (warnings_.size() >= kMaxTexts && text != kOverflow) return add(kOverflow, line);
    index_.emplace(text, warnings_.size());
    warnings_.push_back({std::string(text), line, 1});
}

std::vector<Warning> WarningLog::take() {
    index_.clear();
    return std::exchange(warnings_, {});
}

}  // namespace stratum::gcode
