#include "compare/comparison_report.h"

#include <fmt/format.h>

#include <numbers>

namespace stratum::compare {
namespace {

using Json = nlohmann::ordered_json;

Json placeOf(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

Json describe(const Deviations& found) {
    Json json{{"samples", found.samples}};
    if (found.samples == 0) return json;
    json["mean_mm"] = found.mean;
    json["rms_mm"] = found.rms;
    json["within_95_mm"] = found.within_95;
    json["least_mm"] = found.least.mm;
    json["least_at_mm"] = placeOf(found.least.place);
    json["most_mm"] = found.most.mm;
    json["most_at_mm"] = placeOf(found.most.place);
    return json;
}

Json describe(const DeviationsByNormal& found) {
    return {{"all", describe(found.all)},
            {"walls", describe(found.walls)},
            {"tops", describe(found.tops)},
            {"bottoms", describe(found.bottoms)}};
}

}  // namespace

std::string describe(const Rigid& placement) {
    const double degrees = angleOf(placement.turn) * 180 / std::numbers::pi;
    const glm::dvec3& move = placement.move;
    return fmt::format("{}moved by ({:.3f}, {:.3f}, {:.3f}) mm",
                       degrees < 0.005 ? "" : fmt::format("turned by {:.2f} degrees, ", degrees), move.x, move.y,
                       move.z);
}

nlohmann::ordered_json describe(const Comparison& comparison) {
    Json turn = Json::array();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) turn.push_back(comparison.model_to_print.turn[column][row]);
    return {{"placement",
             {{"by", comparison.fit ? "best fit" : "the bed's coordinates"},
              {"turn", turn},
              {"turn_degrees", angleOf(comparison.model_to_print.turn) * 180 / std::numbers::pi},
              {"move_mm", placeOf(comparison.model_to_print.move)},
              {"residual_mm", comparison.fit ? Json(comparison.fit->residual) : Json(nullptr)}}},
            {"model_mm3", comparison.model_mm3},
            {"model_mm2", comparison.model_mm2},
            {"print_mm2", comparison.print_mm2},
            {"print_mm3", comparison.print_mm3},
            {"hidden_share", comparison.hidden_share},
            {"print_to_model", describe(comparison.print_to_model)},
            {"model_to_print", describe(comparison.model_to_surface)},
            {"doubts", comparison.doubts}};
}

}  // namespace stratum::compare
