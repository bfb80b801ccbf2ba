#include "compare/model_unit.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

namespace stratum::compare {
namespace {

// The element <model> is the first of its file.
constexpr std::size_t kHead = 65536;

struct Discard {
    void operator()(zip_t* archive) const { zip_discard(archive); }
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};

struct StatedUnit {
    std::string_view name;
    double mm;
};
constexpr std::array kStatedUnits{StatedUnit{"micron", 0.001},  StatedUnit{"millimeter", 1},
                                  StatedUnit{"centimeter", 10}, StatedUnit{"inch", 25.4},
                                  StatedUnit{"foot", 304.8},    StatedUnit{"meter", 1000}};

// The beginning of the model's XML; empty where there is none.
std::string headOf(const std::string& name) {
    const std::unique_ptr<zip_t, Discard> archive(zip_open(name.c_str(), ZIP_RDONLY, nullptr));
    if (!archive) return {};
    zip_int64_t model = zip_name_locate(archive.get(), "3D/3dmodel.model", ZIP_FL_NOCASE);
    for (zip_int64_t n = 0; model < 0 && n < zip_get_num_entries(archive.get(), 0); ++n) {
        const char* entry = zip_get_name(archive.get(), static_cast<zip_uint64_t>(n), 0);
        if (entry != nullptr && lowerCase(entry).ends_with(".model")) model = n;
    }
    if (model < 0) return {};
    const std::unique_ptr<zip_file_t, Discard> file(
        zip_fopen_index(archive.get(), static_cast<zip_uint64_t>(model), 0));
    if (!file) return {};
    std::string text(kHead, '\0');
    const zip_int64_t read = zip_fread(file.get(), text.data(), text.size());
    text.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
    return text;
}

// The value of the attribute in the tag; empty if it isn't there.
std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
        if (at == 0 || std::string_view(" \t\r\n").find(tag[at - 1]) == std::string_view::npos) continue;
        std::string_view rest = tag.substr(at + name.size());
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
        if (!rest.starts_with('=')) continue;
        rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n", 1), rest.size()));
        if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) continue;
        return rest.substr(1, rest.find(rest.front(), 1) - 1);
    }
    return {};
}

}  // namespace

double unitOfModel(const std::filesystem::path& path) {
    if (lowerCase(path.extension().string()) != ".3mf") return 1;
    const std::string head = headOf(path.string());
    const std::size_t begin = head.find("<model");
    if (begin == std::string::npos) return 1;
    const std::string_view tag = std::string_view(head).substr(begin, head.find('>', begin) - begin);
    const std::string_view stated = attribute(tag, "unit");
    if (stated.empty()) return 1;
    for (const StatedUnit& unit : kStatedUnits)
        if (stated == unit.name) return unit.mm;
    throw InputError(
        fmt::format("{}: its unit is \"{}\"; expected micron, millimeter, centimeter, inch, foot or meter; export the "
                    "model again",
                    path.string(), stated));
}

}  // namespace stratum::compare
