#include "report/text/report_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_text.h"

#include <fmt/format.h>

namespace stratum::report {
namespace {

std::string endingOf(const std::filesystem::path& path) { return path.extension().string(); }

}  // namespace

bool isReportPath(const std::filesystem::path& path) {
    const std::string ending = endingOf(path);
    return ending == ".json" || ending == ".md" || ending == ".html";
}

void writeReport(const PrintReport& report, const std::filesystem::path& path) {
    if (!isReportPath(path))
        throw UsageError(fmt::format("--report {}: the name must end in .json, .md or .html", path.string()));
    const std::string ending = endingOf(path);
    writeFile(path, ending == ".json" ? jsonText(toJson(report), 1) + "\n"
                    : ending == ".md" ? reportMarkdown(report)
                                      : reportPage(report));
}

}  // namespace stratum::report
