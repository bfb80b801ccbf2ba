#include "study/study.h"

#include "study/deposit/deposit_parts.h"

#include <array>
#include <utility>

namespace stratum::study {

StudyReport studyDeposit(const DepositOptions& options, const StudyOptions& common) {
    StudyReport report;
    Page page("What the plastic does: models against measurements", common.command);
    page.paragraph(
        "docs/deposit.md has the models. Here is how much of the plastic they account for, how rough, wide and quick "
        "their prints are beside published and stated figures.");
    using Part = Table (*)(const DepositOptions&, const StudyOptions&, Page&, StudyReport&);
    // First what is measured in processes of its own, which want no threads to have been started before.
    constexpr std::array<std::pair<const char*, Part>, 4> kParts{{{"deposit_volume", studyVolume},
                                                                  {"deposit_roughness", studyRoughness},
                                                                  {"deposit_corner", studyCorner},
                                                                  {"deposit_time", studyTimes}}};
    double done = 0;
    for (const auto& [name, part] : kParts) {
        StudyOptions own = common;
        if (common.progress)
            own.progress = [&](double share) { common.progress((done + share) / static_cast<double>(kParts.size())); };
        writeTable(common, name, part(options, own, page, report), report);
        ++done;
    }
    writePage(common, "deposit", page, report);
    return report;
}

}  // namespace stratum::study
