#include "python/toolpath_state.h"

#include "base/checksum.h"
#include "base/error.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace stratum::python {

namespace {

static_assert(std::endian::native == std::endian::little, "states are little endian");

constexpr std::string_view kMagic = "stratum.Toolpath";
constexpr std::uint32_t kVersion = 7;  // changes with every field
constexpr const char* kRemedy = "; read the G-code again";

/// Values one after the other, as the machine holds them. Reader has the same functions.
class Writer {
public:
    template <typename Value>
    requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
    void value(const Value& value) { raw(&value, sizeof(Value)); }
    void value(const std::string& text) {
        value(std::uint64_t{text.size()});
        raw(text.data(), text.size());
    }
    template <typename Value, std::size_t N>
    void value(const std::array<Value, N>& list) {
        for (const Value& item : list) value(item);
    }
    template <typename Value>
    void value(const std::optional<Value>& optional) {
        value(optional.has_value());
        if (optional) value(*optional);
    }
    template <typename Value>
    void value(const std::vector<Value>& list) {
        each(list, [this](const Value& item) { value(item); });
    }
    /// Records without padding.
    template <typename Record>
    void records(const std::vector<Record>& list) {
        value(std::uint64_t{list.size()});
        raw(list.data(), list.size() * sizeof(Record));
    }
    template <typename Value, typename Visit>
    void each(const std::vector<Value>& list, const Visit& visit) {
        value(std::uint64_t{list.size()});
        for (const Value& item : list) visit(item);
    }
    template <typename... Values>
    void values(const Values&... all) {
        (value(all), ...);
    }
    std::string take() { return std::move(bytes_); }

private:
    void raw(const void* data, std::size_t size) {
        if (size > 0) bytes_.append(static_cast<const char*>(data), size);
    }

    std::string bytes_;
};

class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    template <typename Value>
    requires std::is_arithmetic_v<Value> || std::is_enum_v<Value>
    void value(Value& value) {
        if constexpr (std::is_same_v<Value, bool>) {
            std::uint8_t byte = 0;
            raw(&byte, 1);
            value = byte != 0;
        } else {
            raw(&value, sizeof(Value));
        }
    }
    void value(std::string& text) {
        text.resize(count(1));
        raw(text.data(), text.size());
    }
    template <typename Value, std::size_t N>
    void value(std::array<Value, N>& list) {
        for (Value& item : list) value(item);
    }
    template <typename Value>
    void value(std::optional<Value>& optional) {
        bool there = false;
        value(there);
        optional.reset();
        if (there) value(optional.emplace());
    }
    template <typename Value>
    void value(std::vector<Value>& list) {
        each(list, [this](Value& item) { value(item); });
    }
    template <typename Record>
    void records(std::vector<Record>& list) {
        list.resize(count(sizeof(Record)));
        raw(list.data(), list.size() * sizeof(Record));
    }
    template <typename Value, typename Visit>
    void each(std::vector<Value>& list, const Visit& visit) {
        list.clear();
        list.resize(count(1));
        for (Value& item : list) visit(item);
    }
    template <typename... Values>
    void values(Values&... all) {
        (value(all), ...);
    }
    bool atEnd() const { return bytes_.empty(); }
    [[noreturn]] static void fail() { throw InputError(fmt::format("the pickle of a Toolpath is damaged{}", kRemedy)); }

private:
    // Of items that take so many bytes at least.
    std::size_t count(std::size_t bytes) {
        std::uint64_t count = 0;
        value(count);
        if (count > bytes_.size() / bytes) fail();
        return static_cast<std::size_t>(count);
    }
    void raw(void* data, std::size_t size) {
        if (size > bytes_.size()) fail();
        if (size > 0) std::memcpy(data, bytes_.data(), size);
        bytes_.remove_prefix(size);
    }

    std::string_view bytes_;
};

// Each visit() names every member, so that one more is an error of the compiler until it is here.

template <typename Archive, typename Facts>
void visitStated(Archive& archive, Facts& facts) {
    auto& [seconds, model_seconds, grams, cost, materials, profiles, nozzles, densities, prices, printer, layer,
           first_layer, bed, excluded, belt, belt_angle, programs_left_out] = facts;
    archive.values(seconds, model_seconds, grams, cost, materials, profiles, nozzles, densities, prices, printer, layer,
                   first_layer, bed, excluded, belt, belt_angle, programs_left_out);
}

template <typename Archive, typename Model>
void visitDeposit(Archive& archive, Model& model) {
    auto& [beads, corner_fraction, corner_mm, flow_lag, pressure_advance, nozzle_diameter, sag, crown, strings] = model;
    archive.values(beads, corner_fraction, corner_mm, flow_lag, pressure_advance, nozzle_diameter, sag, crown, strings);
}

template <typename Archive, typename Limits>
void visitLimits(Archive& archive, Limits& limits) {
    archive.value(limits.rule);
    for (std::size_t n = 0; n < gcode::kLimitCount; ++n) {
        auto& [kind, place, value, changes, first_change] = limits[static_cast<gcode::Limit>(n)];
        archive.values(kind, place, value, changes, first_change);
    }
}

template <typename Archive, typename Times>
void visitTimes(Archive& archive, Times& times) {
    auto& [total, travel, retraction, waiting, before_model, after_model, features, layers, rule, limits] = times;
    archive.values(total, travel, retraction, waiting, before_model, after_model, features, layers, rule);
    visitLimits(archive, limits);
}

template <typename Archive, typename Path>
void visitToolpath(Archive& archive, Path& toolpath) {
    auto& [beads, arcs, runs, objects, warnings, slicer, firmware, format, filament_diameter, layer_height, deposit,
           layer_count, belt_angle, tool_colors, palette_tools, color_changes, temperatures, fans, accelerations,
           pressure_advances, timing, flow, filament_by_tool, footer_by_tool, footer_mm, stated, extrusion_rule,
           firmware_reason, cut_short, filament_mm, prime_mm, flushed_mm, primed_mm, extruded_mm3] = toolpath;
    archive.records(beads);
    archive.each(arcs, [&archive](auto& item) {
        auto& [center_x, center_y, sweep, line] = item;
        archive.values(center_x, center_y, sweep, line);
    });
    archive.records(runs);
    archive.value(objects);
    archive.each(warnings, [&archive](auto& item) {
        auto& [text, first_line, count] = item;
        archive.values(text, first_line, count);
    });
    archive.values(slicer, firmware, format, filament_diameter, layer_height);
    visitDeposit(archive, deposit);
    archive.values(layer_count, belt_angle, tool_colors, palette_tools);
    archive.each(color_changes, [&archive](auto& item) {
        auto& [first_bead, tool, color, is_stated] = item;
        archive.values(first_bead, tool, color, is_stated);
    });
    for (auto* const values : {&temperatures, &fans, &accelerations, &pressure_advances})
        archive.each(*values, [&archive](auto& item) {
            auto& [line, tool, value] = item;
            archive.values(line, tool, value);
        });
    archive.records(timing);
    archive.records(flow);
    archive.values(filament_by_tool, footer_by_tool, footer_mm);
    visitStated(archive, stated);
    archive.values(extrusion_rule, firmware_reason, cut_short, filament_mm, prime_mm, flushed_mm, primed_mm,
                   extruded_mm3);
}
static_assert(sizeof(gcode::Bead) == 60 && sizeof(gcode::Run) == 16 && sizeof(gcode::BeadTiming) == 24 &&
                  sizeof(gcode::BeadFlow) == 12 && sizeof(motion::Travel) == 96,
              "records are written as they are, and must have no padding");

// What the rest of the program takes for granted of indices.
bool indicesExist(const gcode::Toolpath& toolpath) {
    const auto all = [](std::size_t count, std::size_t beads) { return count == 0 || count == beads; };
    if (toolpath.objects.empty() || !all(toolpath.timing.size(), toolpath.beads.size()) ||
        !all(toolpath.flow.size(), toolpath.beads.size()))
        return false;
    for (const gcode::Run& run : toolpath.runs)
        if (run.object >= toolpath.objects.size() || run.feature >= gcode::Feature::count_) return false;
    for (const gcode::Bead& bead : toolpath.beads)
        if (bead.run >= toolpath.runs.size() ||
            (bead.arc >= 0 && static_cast<std::size_t>(bead.arc) >= toolpath.arcs.size()))
            return false;
    return true;
}

}  // namespace

std::string stateOf(const ToolpathObject& object) {
    Writer writer;
    writer.value(std::string(kMagic));
    writer.value(kVersion);
    visitToolpath(writer, *object.toolpath);
    writer.value(object.times.has_value());
    if (object.times) visitTimes(writer, *object.times);
    writer.value(object.travels != nullptr);
    if (object.travels) writer.records(*object.travels);
    writer.value(object.source);
    writer.value(object.source_sha256);
    std::string bytes = writer.take();
    const std::uint32_t checksum = checksumOf(bytes);
    bytes.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    return bytes;
}

ToolpathObject toolpathOf(std::string_view state) {
    std::uint32_t checksum = 0;
    if (state.size() < sizeof checksum) Reader::fail();
    const std::string_view bytes = state.substr(0, state.size() - sizeof checksum);
    std::memcpy(&checksum, state.data() + bytes.size(), sizeof checksum);
    if (checksum != checksumOf(bytes)) Reader::fail();
    Reader reader(bytes);
    std::string magic;
    std::uint32_t version = 0;
    reader.value(magic);
    if (magic != kMagic) Reader::fail();
    reader.value(version);
    if (version != kVersion)
        throw InputError(fmt::format("the pickle of a Toolpath is of version {}; this stratum reads version {}{}",
                                     version, kVersion, kRemedy));
    ToolpathObject object;
    gcode::Toolpath toolpath;
    visitToolpath(reader, toolpath);
    bool timed = false;
    reader.value(timed);
    if (timed) visitTimes(reader, object.times.emplace());
    bool has_travels = false;
    reader.value(has_travels);
    if (has_travels) {
        std::vector<motion::Travel> travels;
        reader.records(travels);
        object.travels = std::make_shared<const std::vector<motion::Travel>>(std::move(travels));
    }
    reader.value(object.source);
    reader.value(object.source_sha256);
    if (!reader.atEnd() || !indicesExist(toolpath)) Reader::fail();
    object.toolpath = std::make_shared<const gcode::Toolpath>(std::move(toolpath));
    return object;
}

}  // namespace stratum::python
