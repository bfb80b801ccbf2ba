#include "deposit/limits/limit_files.h"

#include "base/error.h"
#include "base/text.h"
#include "deposit/limits/printer_text.h"
#include "gcode/text/lexer.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace stratum::deposit {
namespace {

using gcode::Command;
using gcode::CornerRule;
using gcode::Firmware;
using gcode::kMotionAxes;
using gcode::Limit;
using gcode::LimitOrigin;
using gcode::ofAxis;

constexpr std::array<char, kMotionAxes> kLetters{'X', 'Y', 'Z', 'E'};
constexpr std::string_view kEcho = "echo:";
constexpr double kInch = 25.4;  // mm
constexpr double kPerMinute = 1.0 / 60;

// Hosts write "Recv: " and times before what the machine says.
std::string_view behindEcho(std::string_view line) {
    const std::size_t echo = line.rfind(kEcho);
    return trim(echo == std::string_view::npos ? line : line.substr(echo + kEcho.size()), " \t\r");
}

template <typename Take>
void eachLine(std::string_view text, const Take& take) {
    for (std::size_t number = 1; !text.empty(); ++number) take(takePiece(text, '\n'), number);
}

// The commands of one line.
template <typename Take>
void eachCommand(std::string_view text, const Take& take) {
    gcode::Lexer lexer(text);
    gcode::Line line;
    while (lexer.next(line))
        for (std::size_t n = 0; n < line.count; ++n)
            if (line.commands[n].kind == Command::Kind::numbered) take(line.commands[n]);
}

class CommandLimits {
public:
    CommandLimits(const std::string& path, Firmware firmware) : path_(path), reprap_(firmware == Firmware::reprap) {
        limits_.name = path;
        limits_.firmware = firmware;
        limits_.limits.rule = CornerRule::automatic;
        limits_.limits.arcs = reprap_ ? gcode::ArcRule::reprap : gcode::ArcRule::marlin;
        if (reprap_) assumeDefaults();
    }

    void line(std::string_view text, std::size_t number) {
        place_ = fmt::format("{}:{}", path_, number);
        const std::string_view said = behindEcho(text);
        if (said.starts_with("Steps per unit")) marlin_1_ = true;
        eachCommand(said, [this](const Command& command) { execute(command); });
    }

    gcode::PrinterLimits finish() {
        CornerRule& rule = limits_.limits.rule;
        if (reprap_)
            rule = CornerRule::reprap_jerk;
        else if (is(Limit::junction_deviation))
            rule = CornerRule::junction_deviation;
        else
            rule = marlin_1_ ? CornerRule::jerk : CornerRule::marlin_jerk;
        return std::move(limits_);
    }

private:
    void assumeDefaults() {
        const auto byDefault = [this](Limit limit, double value) {
            limits_.set(limit, value, LimitOrigin::Kind::firmware, "RepRapFirmware's default");
        };
        constexpr std::array<double, kMotionAxes> kSpeed{100, 100, 20, 100};            // mm/s
        constexpr std::array<double, kMotionAxes> kAcceleration{1000, 1000, 200, 500};  // mm/s^2
        constexpr std::array<double, kMotionAxes> kJerk{15, 15, 10, 5};                 // mm/s
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
            byDefault(ofAxis(Limit::speed, axis), kSpeed[axis]);
            byDefault(ofAxis(Limit::acceleration, axis), kAcceleration[axis]);
            byDefault(ofAxis(Limit::jerk, axis), kJerk[axis]);
        }
        // More than any axis has: the axes' own limits hold. For E alone there are no others.
        for (const Limit limit : {Limit::printing, Limit::travel, Limit::retracting}) byDefault(limit, 50000);
        for (const Limit limit : {Limit::least_printing_speed, Limit::least_travel_speed}) byDefault(limit, 0.5);
    }

    bool is(Limit limit) const { return limits_.origins[limit].kind == LimitOrigin::Kind::printer; }

    void execute(const Command& command) {
        if (command.letter == 'G' && (command.code == 20 || command.code == 21) && !reprap_)
            unit_ = command.code == 20 ? kInch : 1;
        if (command.letter != 'M') return;
        const double per_minute = command.hasValue('S') && command.value('S') == 1 ? 1 : kPerMinute;
        switch (command.code) {
            case 92:
                return byAxis(command, Limit::steps_per_mm, 1 / unit_);
            case 201:
                if (command.subcode == 0) byAxis(command, Limit::acceleration, unit_);
                return;
            case 203:
                if (reprap_) take(command, 'I', Limit::least_printing_speed, per_minute);
                if (reprap_) take(command, 'I', Limit::least_travel_speed, per_minute);
                return byAxis(command, Limit::speed, reprap_ ? per_minute : unit_);
            case 204:
                return acceleration(command);
            case 205:
                return corners(command);
            case 566:
                if (!reprap_) return;
                if (command.hasValue('P')) limits_.limits.jerk_policy = command.value('P') != 0 ? 1 : 0;
                return byAxis(command, Limit::jerk, kPerMinute);
            default:
                return;
        }
    }

    void acceleration(const Command& command) {
        take(command, 'S', Limit::printing, unit_);
        take(command, 'S', Limit::travel, unit_);
        take(command, 'P', Limit::printing, unit_);
        // Before Marlin 1.1 T beside S was for retractions.
        take(command, 'T', command.has('S') && !reprap_ ? Limit::retracting : Limit::travel, unit_);
        if (!reprap_) take(command, 'R', Limit::retracting, unit_);
    }

    void corners(const Command& command) {
        byAxis(command, Limit::jerk, unit_);
        if (reprap_) return;
        if (command.has('X') && !command.has('Y')) take(command, 'X', ofAxis(Limit::jerk, 1), unit_);
        take(command, 'S', Limit::least_printing_speed, unit_);
        take(command, 'T', Limit::least_travel_speed, unit_);
        take(command, 'J', Limit::junction_deviation, unit_);
    }

    void byAxis(const Command& command, Limit first, double scale) {
        // Marlin reports further extruders on lines of their own.
        if (!reprap_ && command.code != 205 && command.hasValue('T') && command.value('T') != 0) return;
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
            take(command, kLetters[axis], ofAxis(first, axis), scale);
    }

    void take(const Command& command, char letter, Limit limit, double scale) {
        if (!command.has(letter)) return;
        const std::string what = fmt::format("M{} {}", command.code, letter);
        if (!command.hasValue(letter))
            throw InputError(fmt::format("{}: {} has no number{}", place_, what,
                                         command.isExpression(letter) ? "; expressions are not evaluated" : ""));
        checkLimit(limit, command.value(letter) * scale, place_, what);
        limits_.set(limit, command.value(letter) * scale, LimitOrigin::Kind::printer, place_);
    }

    const std::string& path_;
    const bool reprap_;
    gcode::PrinterLimits limits_;
    std::string place_;
    double unit_ = 1;  // mm in a unit of the report
    bool marlin_1_ = false;
};

}  // namespace

std::optional<Firmware> firmwareOfCommands(const std::string& path, std::string_view text) {
    bool limits = false;
    bool reprap = false;
    std::size_t printing = 0;
    eachLine(text, [&](std::string_view line, std::size_t number) {
        eachCommand(behindEcho(line), [&](const Command& command) {
            const int code = command.code;
            if (command.letter == 'G' && code <= 3 && command.has('E') && (command.has('X') || command.has('Y')))
                printing = printing == 0 ? number : printing;
            if (command.letter != 'M') return;
            limits = limits || code == 92 || (code >= 201 && code <= 205) || code == 566;
            // Drives and jerk as only RepRapFirmware has them.
            reprap = reprap || code == 566 || code == 569 || code == 584;
        });
    });
    if (limits && printing > 0)
        throw InputError(fmt::format("{}:{}: a move that prints; this is a program, no printer", path, printing));
    if (!limits) return std::nullopt;
    return reprap && text.find(kEcho) == std::string_view::npos ? Firmware::reprap : Firmware::marlin;
}

gcode::PrinterLimits readCommandLimits(const std::string& path, std::string_view text, Firmware firmware) {
    CommandLimits limits(path, firmware);
    eachLine(text, [&limits](std::string_view line, std::size_t number) { limits.line(line, number); });
    return limits.finish();
}

}  // namespace stratum::deposit
