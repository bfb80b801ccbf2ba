#include "gcode/machine/extra_axes.h"

#include <cmath>
#include <string_view>

namespace stratum::gcode {
namespace {

constexpr std::string_view kTurningOrBeside = "ABCUV";

std::size_t letterIndex(char letter) { return static_cast<std::size_t>(letter - 'A'); }

}  // namespace

bool ExtraAxes::isMix(const Command& command) {
    if (!command.hasValue('E') || command.has('I')) return false;
    double sum = 0;
    for (const char letter : std::string_view("ABCDH")) {
        if (!command.hasValue(letter)) continue;
        if (!(command.value(letter) >= 0 && command.value(letter) <= 1)) return false;
        sum += command.value(letter);
    }
    constexpr double kRounding = 0.02;
    return std::abs(sum - 1) < kRounding;
}

double ExtraAxes::move(const Command& command, bool absolute, double unit) {
    double rise = 0;
    for (const char letter : std::string_view("ABCUVW")) {
        if (!command.hasAny(letters_ & Command::maskOf({&letter, 1})) || !command.hasValue(letter)) continue;
        double& at = at_[letterIndex(letter)];
        const double before = at;
        at = (absolute ? 0 : before) + command.value(letter) * unit;
        if (letter == 'W' && frozen_) rise = at - before;
        if (!frozen_) reference_[letterIndex(letter)] = at;
    }
    away_ = !away(kTurningOrBeside).empty();
    return rise;
}

void ExtraAxes::setPosition(const Command& command, double unit) {
    for (const char letter : std::string_view("ABCUVW")) {
        if (!command.hasAny(letters_ & Command::maskOf({&letter, 1})) || !command.hasValue(letter)) continue;
        const double change = command.value(letter) * unit - at_[letterIndex(letter)];
        at_[letterIndex(letter)] += change;
        reference_[letterIndex(letter)] += change;
    }
}

std::string ExtraAxes::away(std::string_view letters) const {
    std::string names;
    for (const char letter : letters)
        if (at_[letterIndex(letter)] != reference_[letterIndex(letter)]) names += letter;
    std::string list;
    for (std::size_t n = 0; n < names.size(); ++n) {
        if (n > 0) list += n + 1 == names.size() ? " and " : ", ";
        list += names[n];
    }
    return list;
}

}  // namespace stratum::gcode
