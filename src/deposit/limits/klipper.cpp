#include "deposit/limits/limit_files.h"

#include "base/error.h"
#include "base/text.h"
#include "deposit/limits/printer_text.h"
#include "gcode/printer/machine_limits.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace stratum::deposit {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::string_view kSaved =
    "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n"
    "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n"
    "#*#\n";
constexpr std::size_t kMostFiles = 1000;
constexpr std::size_t kMostBytes = std::size_t{8} << 20;
constexpr std::size_t kDeepest = 100;  // includes in includes

// What stands between the brackets of a section's head, if the text begins with one.
std::optional<std::string_view> headOf(std::string_view text) {
    const std::size_t close = text.rfind(']');
    if (!text.starts_with('[') || close == std::string_view::npos || close < 2) return std::nullopt;
    return text.substr(1, close - 1);
}

std::string withUnixLines(std::string_view text) {
    std::string lines;
    lines.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
        lines += text[i] == '\r' ? '\n' : text[i];
    }
    return lines;
}

// The lines of the SAVE_CONFIG block without their marks; nothing if people wrote into it, which Klipper ignores then.
std::optional<std::string> savedPart(std::string_view block) {
    std::string text;
    while (!block.empty()) {
        const std::size_t end = std::min(block.find('\n'), block.size());
        const std::string_view line = block.substr(0, end);
        const bool marked = line.starts_with("#*#") && (line.size() < 4 || line[3] == ' ');
        if (!marked && !trim(block, " \t\n").empty()) return std::nullopt;
        text.append(line.substr(std::min<std::size_t>(4, line.size()))).append("\n");
        block.remove_prefix(std::min(end + 1, block.size()));
    }
    return text;
}

std::vector<std::string> filesOf(const std::string& pattern) {
    glob_t found{};
    std::vector<std::string> files;
    // By name as Python sorts them, not by the locale.
    if (::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found) == 0)
        files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
    ::globfree(&found);
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

class KlipperReader {
public:
    using Sections = std::map<std::string, KlipperConfig::Options, std::less<>>;

    explicit KlipperReader(Sections& sections) : sections_(sections) {}

    void read(const std::string& path, std::string_view text) {
        if (++files_ > kMostFiles || (bytes_ += text.size()) > kMostBytes)
            throw InputError(
                fmt::format("{}: more than {} files or {} bytes are included", place_, kMostFiles, kMostBytes));
        stack_.push_back(fs::absolute(path).lexically_normal());
        Parser parser(*this, path);
        for (std::size_t line = 1; !text.empty(); ++line) parser.line(takePiece(text, '\n'), line);
        stack_.pop_back();
    }

private:
    // The lines between two includes are parsed for themselves, as in Klipper: an include ends the section.
    class Parser {
    public:
        Parser(KlipperReader& reader, const std::string& path) : reader_(reader), path_(path) {}

        void line(std::string_view line, std::size_t number) {
            line = line.substr(0, line.find('#'));
            const std::string place = fmt::format("{}:{}", path_, number);
            if (const auto head = headOf(line); head && head->starts_with("include ")) {
                section_ = nullptr;
                value_ = nullptr;
                indent_ = 0;
                return reader_.include(std::string(trim(head->substr(8), kBlanks)), path_, place);
            }
            for (std::size_t at = line.find(';'); at != std::string_view::npos; at = line.find(';', at + 1)) {
                if (at > 0 && kBlanks.find(line[at - 1]) == std::string_view::npos) continue;
                line = line.substr(0, at);
                break;
            }
            const std::string_view text = trim(line, kBlanks);
            if (text.empty()) return;
            const std::size_t indent = line.find_first_not_of(kBlanks);
            if (value_ != nullptr && indent > indent_) {
                value_->text.append("\n").append(text);
                return;
            }
            indent_ = indent;
            if (const auto head = headOf(text)) {
                section_ = &reader_.sections_[std::string(*head)];
                value_ = nullptr;
                return;
            }
            option(text, place);
        }

    private:
        void option(std::string_view text, const std::string& place) {
            const std::size_t mark = text.find_first_of(":=");
            if (section_ == nullptr || mark == std::string_view::npos || mark == 0)
                throw InputError(fmt::format(
                    "{}: expected a [section], 'option: value', or an indented line of a value, as Klipper does",
                    place));
            value_ = &(*section_)[lowerCase(std::string(trim(text.substr(0, mark), kBlanks)))];
            *value_ = {std::string(trim(text.substr(mark + 1), kBlanks)), place};
        }

        KlipperReader& reader_;
        const std::string& path_;
        KlipperConfig::Options* section_ = nullptr;
        KlipperConfig::Value* value_ = nullptr;
        std::size_t indent_ = 0;
    };

    void include(const std::string& pattern, const std::string& path, const std::string& place) {
        place_ = place;
        const std::string whole = (fs::path(path).parent_path() / pattern).string();
        const std::vector<std::string> files = filesOf(whole);
        if (files.empty() && pattern.find_first_of("*?[") == std::string::npos)
            throw InputError(fmt::format("{}: the included file {} does not exist; put it there, or take out the line",
                                         place, whole));
        if (stack_.size() >= kDeepest)
            throw InputError(fmt::format("{}: more than {} includes in each other", place, kDeepest));
        for (const std::string& file : files) {
            if (std::find(stack_.begin(), stack_.end(), fs::absolute(file).lexically_normal()) != stack_.end())
                throw InputError(fmt::format("{}: {} is included by itself, without end", place, file));
            read(file, withUnixLines(readIncludedText(file, place)));
            place_ = place;
        }
    }

    Sections& sections_;
    std::vector<fs::path> stack_;  // the files that are being read
    std::string place_;            // of the include that is being read
    std::size_t files_ = 0;
    std::size_t bytes_ = 0;
};

KlipperConfig::KlipperConfig(const std::string& path, std::string_view text) {
    const std::string lines = withUnixLines(text);
    const std::string_view all = lines;
    const std::size_t mark = std::min(all.find(kSaved), all.size());
    const std::string_view regular = all.substr(0, mark);
    std::optional<std::string> saved;
    if (mark < all.size() && regular.find("\n#*# ") == std::string_view::npos)
        saved = savedPart(all.substr(mark + kSaved.size()));
    KlipperReader(sections_).read(path, regular);
    if (!saved) return;
    // The block's lines keep their numbers.
    const auto before = std::count(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(mark + kSaved.size()), '\n');
    std::map<std::string, Options, std::less<>> kept;
    KlipperReader(kept).read(path, std::string(static_cast<std::size_t>(before), '\n') + *saved);
    for (auto& [section, options] : kept)
        for (auto& [option, value] : options) sections_[section].emplace(option, std::move(value));
}

const KlipperConfig::Value* KlipperConfig::find(std::string_view section, std::string_view option) const {
    const auto options = sections_.find(section);
    if (options == sections_.end()) return nullptr;
    const auto value = options->second.find(option);
    return value == options->second.end() ? nullptr : &value->second;
}

bool looksLikeKlipperConfig(std::string_view text) {
    while (!text.empty()) {
        const std::string_view line = takePiece(text, "\r\n");
        if (line.size() > 2 && line[0] == '[' && isLetter(line[1]) && line.find(']') != std::string_view::npos)
            return true;
    }
    return false;
}

namespace {

using gcode::Bounds;
using gcode::Limit;
using gcode::LimitOrigin;
using gcode::ofAxis;
using Value = KlipperConfig::Value;

constexpr Limit kSpeedZ = ofAxis(Limit::speed, 2);
constexpr Limit kAccelerationZ = ofAxis(Limit::acceleration, 2);
constexpr Bounds kNozzle{0.01, 10};    // mm
constexpr Bounds kFilament{0.1, 100};  // mm

class KlipperLimits {
public:
    KlipperLimits(const std::string& path, std::string_view text) : path_(path), config_(path, text) {
        limits_.name = path;
        limits_.firmware = gcode::Firmware::klipper;
        limits_.limits.rule = gcode::CornerRule::corner_velocity;
        limits_.limits.arcs = gcode::ArcRule::klipper;
    }

    gcode::PrinterLimits read() {
        need("printer", "max_velocity", Limit::path_speed);
        need("printer", "max_accel", Limit::printing);
        limits_.set(Limit::travel, limits_.limits.printing, LimitOrigin::Kind::printer,
                    limits_.origins[Limit::printing].place);
        take("printer", "square_corner_velocity", Limit::corner_velocity, 5);
        readCruiseRatio();
        take("printer", "max_z_velocity", kSpeedZ, limits_.limits.path_speed);
        take("printer", "max_z_accel", kAccelerationZ, limits_.limits.printing);
        refuseAbove("max_z_velocity", kSpeedZ, "max_velocity", Limit::path_speed);
        refuseAbove("max_z_accel", kAccelerationZ, "max_accel", Limit::printing);
        take("gcode_arcs", "resolution", Limit::arc_resolution, 1);
        take("extruder", "instantaneous_corner_velocity", Limit::extruder_corner_velocity, 1);
        readExtrudeOnly();
        if (const Value* advance = config_.find("extruder", "pressure_advance"))
            limits_.limits.pressure_advance =
                numberIn(advance->text, {0, gcode::kLongestAdvance}, advance->place, "pressure_advance");
        return std::move(limits_);
    }

private:
    static constexpr const char* kDefault = "Klipper's default";

    // False if the option is not there.
    bool take(const char* section, const char* option, Limit limit) {
        const Value* value = config_.find(section, option);
        if (value == nullptr) return false;
        limits_.set(limit, numberIn(value->text, gcode::boundsOf(limit), value->place, option),
                    LimitOrigin::Kind::printer, value->place);
        return true;
    }

    void take(const char* section, const char* option, Limit limit, double otherwise) {
        if (!take(section, option, limit)) limits_.set(limit, otherwise, LimitOrigin::Kind::firmware, kDefault);
    }

    void need(const char* section, const char* option, Limit limit) {
        if (!take(section, option, limit))
            throw InputError(
                fmt::format("{}: [{}] has no {}, without which Klipper doesn't start; is it in a file that is "
                            "not included?",
                            path_, section, option));
    }

    void readCruiseRatio() {
        if (take("printer", "minimum_cruise_ratio", Limit::cruise_ratio)) return;
        // Until 2025 the older option was read, where the newer one is missing.
        if (const Value* older = config_.find("printer", "max_accel_to_decel")) {
            const double acceleration =
                numberIn(older->text, gcode::boundsOf(Limit::printing), older->place, "max_accel_to_decel");
            const double ratio = 1 - std::min(1.0, acceleration / limits_.limits.printing);
            limits_.set(Limit::cruise_ratio, std::min(ratio, gcode::boundsOf(Limit::cruise_ratio).most),
                        LimitOrigin::Kind::printer, older->place);
        } else {
            limits_.set(Limit::cruise_ratio, 0.5, LimitOrigin::Kind::firmware, kDefault);
        }
    }

    void refuseAbove(const char* option, Limit limit, const char* other, Limit most) const {
        const double value = gcode::valueOf(limits_.limits, limit);
        const double bound = gcode::valueOf(limits_.limits, most);
        if (value > bound)
            throw InputError(fmt::format("{}: {} is {:g}; Klipper takes no more than {}, {:g}",
                                         limits_.origins[limit].place, option, value, other, bound));
    }

    void readExtrudeOnly() {
        const bool speed = take("extruder", "max_extrude_only_velocity", Limit::extrude_only_speed);
        const bool acceleration = take("extruder", "max_extrude_only_accel", Limit::retracting);
        if ((speed && acceleration) || !config_.has("extruder")) return;
        const double nozzle = diameter("nozzle_diameter", kNozzle);
        const double filament = diameter("filament_diameter", kFilament);
        const double ratio = 4 * nozzle * nozzle / (std::numbers::pi * filament * filament / 4);
        const auto derive = [&](Limit limit, double value) {
            limits_.set(limit, value, LimitOrigin::Kind::firmware, "Klipper's formula for nozzle and filament");
        };
        if (!speed) derive(Limit::extrude_only_speed, ratio * limits_.limits.path_speed);
        if (!acceleration) derive(Limit::retracting, ratio * limits_.limits.printing);
    }

    double diameter(const char* option, Bounds bounds) const {
        const Value* value = config_.find("extruder", option);
        if (value == nullptr)
            throw InputError(
                fmt::format("{}: [extruder] has no {}, of which Klipper makes max_extrude_only_velocity and "
                            "max_extrude_only_accel",
                            path_, option));
        return numberIn(value->text, bounds, value->place, option);
    }

    const std::string& path_;
    KlipperConfig config_;
    gcode::PrinterLimits limits_;
};

}  // namespace

gcode::PrinterLimits readKlipperLimits(const std::string& path, std::string_view text) {
    return KlipperLimits(path, text).read();
}

}  // namespace stratum::deposit
