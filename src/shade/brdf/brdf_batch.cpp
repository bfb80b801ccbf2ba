#include "shade/brdf/brdf_batch.h"

#include <span>

namespace stratum::shade {

void BrdfBatch::clear() {
    brdfs_.clear();
    wo_.clear();
    wi_.clear();
    lobes_.clear();
    u_.clear();
}

void BrdfBatch::addPair(const Brdf& brdf, const glm::vec3& wo, const glm::vec3& wi) {
    brdfs_.push_back(&brdf);
    wo_.push_back(wo);
    wi_.push_back(wi);
}

void BrdfBatch::addDraw(const Brdf& brdf, const glm::vec3& wo, float lobe, const glm::vec2& u) {
    brdfs_.push_back(&brdf);
    wo_.push_back(wo);
    lobes_.push_back(lobe);
    u_.push_back(u);
}

void BrdfBatch::forEachBrdf(const auto& work) const {
    for (std::size_t first = 0, end = 0; first < brdfs_.size(); first = end) {
        while (end < brdfs_.size() && brdfs_[end] == brdfs_[first]) ++end;
        work(*brdfs_[first], first, end - first);
    }
}

void BrdfBatch::eval() {
    values.resize(brdfs_.size());
    densities.resize(brdfs_.size());
    forEachBrdf([&](const Brdf& brdf, std::size_t first, std::size_t count) {
        brdf.evalStream(std::span(wo_).subspan(first, count), std::span(wi_).subspan(first, count),
                        std::span(values).subspan(first, count), std::span(densities).subspan(first, count));
    });
}

void BrdfBatch::sample() {
    samples.resize(brdfs_.size());
    forEachBrdf([&](const Brdf& brdf, std::size_t first, std::size_t count) {
        brdf.sampleStream(std::span(wo_).subspan(first, count), std::span(lobes_).subspan(first, count),
                          std::span(u_).subspan(first, count), std::span(samples).subspan(first, count));
    });
}

}  // namespace stratum::shade
