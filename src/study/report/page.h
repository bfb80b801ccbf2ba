// One HTML file that holds all it shows: text, tables, plots, pictures.
#pragma once

#include "report/text/svg_plot.h"
#include "study/report/result_table.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace stratum::study {

using report::Plot;
using report::Series;

class Page {
public:
    /// `command`: what was typed. Names of folders in it are left out: the page is read on other machines.
    Page(std::string title, std::span<const std::string> command);

    void heading(std::string_view text);
    void paragraph(std::string_view text);
    /// Cells that are numbers are set flush right. A row whose cells hold `marked` is shown in red; empty marks none.
    void table(const Row& columns, const std::vector<Row>& rows, std::string_view marked = {});
    void plot(const Plot& plot);
    /// A PNG file, kept in the page.
    void picture(const std::filesystem::path& png, std::string_view caption);

    std::string html() const;
    /// Throws OutputError.
    void write(const std::filesystem::path& path) const;

private:
    std::string title_, made_by_, body_;
};

/// Processor, cores, memory, system, compiler; never the machine's name.
std::string machineLine();

/// Bytes as base 64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace stratum::study
