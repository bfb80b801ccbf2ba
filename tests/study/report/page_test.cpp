#include "study/report/page.h"

#include "scratch_folder.h"

#include <gtest/gtest.h>

namespace stratum::study {
namespace {

TEST(Page, HoldsAllThatItShowsAndNoFolders) {
    const std::vector<std::string> command{"/home/me/bin/vdbstudy", "memory", "/data/a.gcode", "-o", "/data/out/"};
    Page page("A & B", command);
    page.heading("One");
    page.table({"name", "value"}, {{"x<y", "1.5"}, {"bad", "failed"}}, "failed");
    page.picture("aGVsbG8=", "a hull");
    const std::string html = page.html();
    EXPECT_NE(html.find("<td class='n'>1.5</td>"), std::string::npos);
    EXPECT_NE(html.find("x&lt;y"), std::string::npos);
    EXPECT_NE(html.find("<tr class='marked'><td>bad"), std::string::npos);
    EXPECT_NE(html.find("data:image/jpeg;base64,aGVsbG8="), std::string::npos);
    EXPECT_NE(html.find("<code>vdbstudy memory a.gcode -o out/</code>"), std::string::npos);
    EXPECT_EQ(html.find("/home/"), std::string::npos);
    EXPECT_EQ(html.find("http://"), std::string::npos);
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path()};
    StudyReport report;
    writePage(common, "p", page, report);
    EXPECT_EQ(report.html, folder / "p.html");
    EXPECT_EQ(std::filesystem::file_size(folder / "p.html"), html.size());
}

TEST(Page, NamesTheMachine) { EXPECT_NE(machineLine().find("GB of memory"), std::string::npos); }

}  // namespace
}  // namespace stratum::study
