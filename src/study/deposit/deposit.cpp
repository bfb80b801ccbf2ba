#include "study/deposit/deposit.h"

#include "study/deposit/deposit_parts.h"

#include <array>

namespace stratum::study {

StudyReport studyDeposit(const DepositOptions& options, const StudyOptions& common) {
    StudyReport report;
    Page page("What the plastic does: models against measurements", common.command);
    page.paragraph(
        "docs/deposit.md has the models. Here is how much of the plastic they account for, how rough, wide and quick "
        "their prints are beside published and stated figures, and what each costs.");
    constexpr int kParts = 5;
    std::array<PartTable, kParts> tables;
    const auto part = [&](int number, const auto& study) {
        StudyOptions own = common;
        if (common.progress) own.progress = [&, number](double share) { common.progress((number + share) / kParts); };
        tables.at(static_cast<std::size_t>(number)) = study(own);
        if (common.progress) common.progress((number + 1.0) / kParts);
    };
    // First what is measured in processes of its own, which want no threads to have been started before.
    part(0, [&](const StudyOptions& own) { return studyEffects(options, own, page, report); });
    part(1, [&](const StudyOptions& own) { return studyVolume(options, own, page, report); });
    part(2, [&](const StudyOptions& own) { return studyRoughness(own, page, report); });
    part(3, [&](const StudyOptions& own) { return studyCorner(own, page, report); });
    part(4, [&](const StudyOptions& own) { return studyTimes(options, own, page, report); });
    for (const PartTable& table : tables) {
        report.rows += table->rows().size();
        report.resumed += table->resumed();
    }
    page.runs(*tables.back());
    report.csv = tables[1]->path();
    report.html = common.folder / "deposit.html";
    page.write(report.html);
    return report;
}

}  // namespace stratum::study
