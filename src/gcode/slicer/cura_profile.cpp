#include "gcode/slicer/cura_profile.h"

#include "base/base64.h"
#include "base/text.h"
#include "gcode/container/inflate.h"

#include <algorithm>

namespace stratum::gcode {
namespace {

constexpr std::size_t kMostProfile = std::size_t{1} << 20;  // bytes of an unpacked profile; real ones have 10 kB
constexpr std::size_t kMostExtruders = 32;

// What zlib data unpacks to; empty if it is damaged.
std::string inflated(std::string& bytes) {
    Inflater inflater(15);
    z_stream& stream = inflater.stream;
    std::string text(std::min(kMostProfile, bytes.size() * std::size_t{kDeflateMostRatio}), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    if (inflate(&stream, Z_FINISH) != Z_STREAM_END) return {};
    text.resize(stream.total_out);
    return text;
}

// Adds the settings of a profile: one a part, key and value separated by '='.
void addAll(std::string_view profile, char separator, std::optional<std::size_t> extruder,
            std::vector<CuraSetting>& settings) {
    while (!profile.empty()) {
        const auto cut = std::min(profile.find(separator), profile.size());
        const std::string_view one = profile.substr(0, cut);
        profile.remove_prefix(std::min(cut + 1, profile.size()));
        const auto equals = one.find('=');
        if (equals == std::string_view::npos) continue;
        const std::string_view key = trim(one.substr(0, equals));
        if (key == "position" && extruder) {
            // An extruder's profile names its number, which its place in the list need not be.
            const std::string_view value = trim(one.substr(equals + 1));
            if (value.size() == 1 && value[0] >= '0' && value[0] <= '9')
                extruder = static_cast<std::size_t>(value[0] - '0');
        }
        settings.push_back({extruder, std::string(key), std::string(trim(one.substr(equals + 1)))});
    }
}

// The JSON string whose opening quote is at the start of `text`, which it removes. Profiles are escaped once or twice.
std::string takeString(std::string_view& text) {
    std::string plain;
    std::size_t at = 1;
    for (; at < text.size() && text[at] != '"'; ++at) {
        if (text[at] != '\\') {
            plain += text[at];
            continue;
        }
        while (at + 1 < text.size() && text[at + 1] == '\\') ++at;
        if (at + 1 < text.size()) plain += text[++at] == 'n' ? '\n' : text[at];
    }
    text.remove_prefix(std::min(at + 1, text.size()));
    return plain;
}

}  // namespace

bool CuraProfile::comment(std::string_view comment) {
    constexpr std::string_view kJson = "SETTING_3 ";
    constexpr std::string_view kProfile = "CURA_PROFILE_STRING:";
    if (comment.starts_with(kJson)) {
        json_ += comment.substr(kJson.size());
        return true;
    }
    if (!comment.starts_with(kProfile)) return false;
    readProfileString(comment.substr(kProfile.size()));
    return true;
}

void CuraProfile::readProfileString(std::string_view base64) {
    cura_15_ = true;
    std::string bytes = bytesOfBase64(base64.substr(0, kMostProfile));
    const std::string profile = bytes.empty() ? std::string() : inflated(bytes);
    damaged_ = damaged_ || profile.empty();
    addAll(std::string_view(profile).substr(0, profile.find('\f')), '\b', std::nullopt, settings_);
}

std::vector<CuraSetting> CuraProfile::settings() {
    // {"global_quality": "...", "extruder_quality": ["...", "..."]}: other keys than these hold no settings.
    std::string_view text = json_;
    bool of_extruders = false;
    std::size_t extruder = 0;
    while (true) {
        text.remove_prefix(std::min(text.find('"'), text.size()));
        if (text.empty()) break;
        const std::string part = takeString(text);
        if (part == "extruder_quality")
            of_extruders = true;
        else if (part.find('=') != std::string::npos && extruder < kMostExtruders)
            addAll(part, '\n', of_extruders ? std::optional(extruder++) : std::nullopt, settings_);
    }
    return std::move(settings_);
}

}  // namespace stratum::gcode
