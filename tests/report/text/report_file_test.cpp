#include "report/text/report_file.h"

#include "reported_print.h"
#include "scratch_folder.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

namespace stratum::report {
namespace {

PrintReport smallReport() {
    ReportOptions options;
    options.source = "a<b>&c|d.gcode";
    return test::reportOfAll(test::tube(3, 0.6, 0.4, 6), test::layeredLattice(0.4, 4), options);
}

TEST(ReportFile, EveryNumberIsInTheTexts) {
    const PrintReport report = smallReport();
    const std::string markdown = reportMarkdown(report);
    const std::string page = reportPage(report);
    for (const Definition& definition : numberDefinitions()) {
        EXPECT_NE(markdown.find(definition.title), std::string::npos) << definition.key;
        EXPECT_NE(page.find(definition.title), std::string::npos) << definition.key;
        EXPECT_NE(markdown.find(definition.text.substr(0, 30)), std::string::npos) << definition.key;
    }
}

TEST(ReportFile, ThePageHoldsAllItShows) {
    const std::string page = reportPage(smallReport());
    EXPECT_EQ(page.find("<b>"), std::string::npos);
    EXPECT_NE(page.find("a&lt;b&gt;&amp;c|d.gcode"), std::string::npos);
    EXPECT_NE(page.find("<svg"), std::string::npos);
    for (const char* outside : {"src=", "href=", "url(", "@import", "<script"})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_LT(page.size(), 1000000U);
}

// The page of a tall print stays small, and keeps its peaks.
TEST(ReportFile, PlotsOfManyLayersAreThinned) {
    PrintReport report = smallReport();
    constexpr std::size_t kLayers = 20000;
    report.layers.resize(kLayers);
    for (std::size_t n = 0; n < kLayers; ++n) report.layers[n] = static_cast<std::uint32_t>(n + 1);
    for (Column& column : report.by_layer) {
        column.values.assign(kLayers, 1.0);
        column.values[777] = 9;
        column.values[0] = std::numeric_limits<double>::quiet_NaN();
    }
    EXPECT_LT(reportPage(report).size(), 200000U);
}

TEST(ReportFile, WritesByItsEnding) {
    const test::ScratchFolder folder;
    const PrintReport report = smallReport();
    for (const char* name : {"a.json", "a.md", "a.html"}) {
        const std::filesystem::path path = folder.path() / name;
        EXPECT_TRUE(isReportPath(path));
        writeReport(report, path);
        const std::string text = test::bytesOf(path);
        EXPECT_FALSE(text.empty());
        if (path.extension() == ".json") {
            EXPECT_EQ(nlohmann::ordered_json::parse(text), toJson(report));
        }
    }
    PrintReport latin = report;
    latin.slicer = "M\xfcller";  // Latin-1 is no UTF-8
    writeReport(latin, folder.path() / "latin.json");
    std::ifstream file(folder.path() / "latin.json");
    EXPECT_NE(nlohmann::ordered_json::parse(file).dump().find("M\xef\xbf\xbdller"), std::string::npos);
    EXPECT_FALSE(isReportPath("a.txt"));
    EXPECT_THROW(writeReport(report, folder.path() / "a.txt"), UsageError);
    EXPECT_THROW(writeReport(report, folder.path() / "none" / "a.md"), OutputError);
}

}  // namespace
}  // namespace stratum::report
