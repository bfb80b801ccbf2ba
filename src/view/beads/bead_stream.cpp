#include "view/beads/bead_stream.h"

#include "base/error.h"
#include "view/asked/picture_plan.h"
#include "view/beads/bead_look.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>
#include <vector>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kPart = 32768;  // texels: half a megabyte

template <typename Value>
std::vector<std::uint8_t> bytesOf(const std::vector<Value>& values) {
    std::vector<std::uint8_t> bytes(values.size() * sizeof(Value));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

}  // namespace

std::string whyNoBeads(const Document& document) {
    const GivenInput& given = document.given();
    if (given.objects.size() != 1 || !document.toolpath(0)) return "the input is not a print alone";
    if (!given.objects.front().placement.isIdentity()) return "the print is moved by its scene";
    const assemble::PrintRequest& request = given.options.tracing.prints;
    if (!request.print.layers.empty() || !request.print.features.empty() || !request.print.objects.empty() ||
        !request.print.tools.empty() || !request.printed.empty())
        return "the command line selects a part of the print";
    return {};
}

bool BeadStream::sendPart() {
    if (!table_ || generation_ != document_.generation()) {
        table_.reset();
        std::string why = whyNoBeads(document_);
        if (why.empty()) {
            try {
                table_ = std::make_unique<const BeadTable>(document_.toolpath(0));
            } catch (const InputError& error) {
                why = error.what();
            }
        }
        if (!why.empty()) {
            // Without parts, so that the page has something to acknowledge.
            output_.picture({{"type", "no-beads"}, {"text", why}}, {});
            return false;
        }
        generation_ = document_.generation();
        next_ = 0;
        // With another table the page forgets what it had of the one before.
        colors_key_.reset();
        light_key_.clear();
        Json head = table_->head();
        head["generation"] = generation_;
        output_.picture(head, bytesOf(table_->runs()));
        return true;
    }
    output_.picture({{"type", "bead-part"}, {"generation", generation_}}, bytesOf(table_->part(next_, kPart)));
    if (next_ < table_->beads()) return true;
    table_.reset();  // the page has it now
    return false;
}

void BeadStream::sendLook(const ViewedPicture& picture, const PicturePlan& plan, ViewScene& scene,
                          std::uint64_t number) {
    // A light that turns with the camera is turned by the page.
    const bool above = !picture.scene.bed || picture.scene.camera.eye().z > picture.scene.bed->z;
    const std::string light_key =
        fmt::format("{} {} {} {}", plan.light_key, plan.objects_key, above, document_.generation());
    const bool lights = light_key != light_key_;
    light_key_ = light_key;
    const auto& objects = scene.objects();
    const std::string by = objects.legends.size() == 1 ? objects.legends.front().title : std::string();
    // Ramps follow what is selected.
    const std::string colors_key =
        by.empty() ? std::string() : fmt::format("{} {}", plan.objects_key, document_.generation());
    if (colors_key_ != colors_key && objects.prints.size() == 1) {
        const auto& toolpath = objects.prints.front()->finest().layout().toolpath;
        BeadColors colors;
        if (!by.empty()) colors = colorsOf(picture, *toolpath, by);
        Json palette = Json::array();
        for (const shade::Color& color : colors.palette) palette.push_back({color.r, color.g, color.b});
        output_.picture({{"type", "colors"}, {"palette", std::move(palette)}, {"values", colors.values}},
                        bytesOf(colors.places));
        colors_key_ = colors_key;
    }
    Json look = lookOf(picture, plan, lights ? &scene.bareLight() : nullptr);
    look["number"] = number;
    look["command"] = shellLine(plan.words);
    output_.text(look);
}

}  // namespace stratum::view
