#include "assemble/file/object_file.h"

#include "assemble/file/sdf_file.h"
#include "shade/finish/named_brdf.h"

#include <fmt/format.h>

#include <utility>

namespace stratum::assemble {
namespace {

trace::Placement readPlacement(JsonSection section) {
    glm::dvec3 scale(1.0);
    if (const auto* s = section.find("scale"); s && s->is_number())
        scale = glm::dvec3(s->get<double>());
    else
        section.read("scale", scale);
    glm::dvec3 rotate(0.0);
    glm::dvec3 translate(0.0);
    section.read("rotate", rotate);
    section.read("translate", translate);
    section.finish();
    return trace::Placement::of(scale, rotate, translate);
}

shade::MaterialOptions readMaterial(JsonSection& section, const std::filesystem::path& folder) {
    shade::MaterialOptions material;
    const auto* j = section.find("material");
    if (!j) return material;
    if (j->is_string()) {
        material.brdf = materialBeside(folder, j->get<std::string>());
        return material;
    }
    if (!j->is_object()) section.fail("material", "a text as --brdf has it, or { \"by\": ..., ... }");
    for (const auto& item : j->items()) {
        if (!item.value().is_string()) section.fail("material." + item.key(), "a text");
        const auto text = item.value().get<std::string>();
        if (item.key() == "by")
            material.by = text;
        else if (item.key() == "other")
            material.brdf = materialBeside(folder, text);
        else
            material.each[item.key()] = materialBeside(folder, text);
    }
    if (material.by.empty()) section.fail("material.by", "the attribute that chooses, e.g. \"tool\"");
    if (material.each.empty())
        section.fail("material", fmt::format("a material for a value of {0} beside \"by\", e.g. \"0\": \"pla-blue\"; "
                                             "to colour by it write \"color_by\": \"{0}\"",
                                             material.by));
    return material;
}

}  // namespace

std::string beside(const std::filesystem::path& folder, const std::string& text) {
    std::error_code error;
    const std::filesystem::path path = folder / text;
    return !text.empty() && std::filesystem::is_regular_file(path, error) ? path.string() : text;
}

std::string materialBeside(const std::filesystem::path& folder, const std::string& text) {
    return shade::isBrdfPreset(text) ? text : beside(folder, text);
}

std::optional<std::array<double, 2>> readColorRange(OptionSource& options, const std::string& color_by) {
    constexpr double kMost = 1e9;  // of any attribute
    constexpr const char* kEnds = "MIN,MAX, two numbers, the lower one first";
    const std::vector<double> ends = options.numbersOf("color_range", {2}, kEnds);
    if (ends.empty()) return std::nullopt;
    if (!(-kMost <= ends[0] && ends[0] < ends[1] && ends[1] <= kMost)) options.refuse("color_range", kEnds);
    if (color_by.empty())
        options.refuse("color_range", fmt::format("an attribute beside it, in {}", options.called("color_by")));
    return std::array{ends[0], ends[1]};
}

ObjectOptions readObject(JsonSection section, const std::filesystem::path& folder) {
    ObjectOptions object;
    section.read("vdb", object.vdb);
    section.read("grid", object.grid);
    const auto* sdf = section.find("sdf");
    if (object.vdb.empty() == (sdf == nullptr)) section.fail("", "either \"vdb\" or \"sdf\"");
    if (!object.vdb.empty()) object.vdb = (folder / object.vdb).string();
    if (auto transform = section.section("transform")) object.placement = readPlacement(std::move(*transform));
    assign(object.up, section.choice("file_up", kUps));
    object.material = readMaterial(section, folder);
    std::string color_by;
    section.read("color_by", color_by);
    if (!color_by.empty()) {
        if (!object.material.by.empty()) section.fail("color_by", "no material with \"by\" beside it");
        object.material.by = color_by;
    }
    object.material.range = readColorRange(section, color_by);
    if (sdf) {
        object.sdf = readSdf(*sdf, section.place("sdf"), section.file());
        section.read("voxel_size", object.voxel_size);
        section.read("tolerance", object.tolerance);
        if (!object.grid.empty()) section.fail("grid", "no grid: the object is an sdf");
        if (!object.up.empty()) section.fail("file_up", "no file's axis: the object is an sdf");
        if (!object.material.by.empty()) section.fail("material", "one material: an sdf has no attributes");
    }
    section.finish();
    return object;
}

}  // namespace stratum::assemble
