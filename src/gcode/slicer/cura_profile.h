// Cura's own settings in a program: what the user changed, as Cura stores it for reading a profile back.
// Sources: Cura's GCodeWriter.py (";SETTING_3 " and a piece of JSON, whose strings are profiles with one "key = value"
// a line); Cura 15's util/profile.py (";CURA_PROFILE_STRING:", base64 of zlib: "key=value" separated by \b, and after
// \f the texts of start and end programs).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

struct CuraSetting {
    std::optional<std::size_t> extruder;  ///< nothing: of the whole print
    std::string key;
    std::string value;
};

/// Collects them from comments in the order of the file.
class CuraProfile {
public:
    /// `comment` is one line behind its ';', untrimmed. False if it is no part of a profile.
    bool comment(std::string_view comment);

    /// What was collected; damaged parts are left out. To be called once, at the end.
    std::vector<CuraSetting> settings();

    /// Some ";CURA_PROFILE_STRING:" has been read.
    bool isCura15() const { return cura_15_; }
    /// A profile string couldn't be decoded.
    bool isDamaged() const { return damaged_; }

private:
    void readProfileString(std::string_view base64);

    std::string json_;  // of all SETTING_3 lines
    std::vector<CuraSetting> settings_;
    bool cura_15_ = false;
    bool damaged_ = false;
};

}  // namespace stratum::gcode
