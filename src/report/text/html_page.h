// An HTML file that needs no other: the pages of reports and of studies.
#pragma once

#include <string>
#include <string_view>

namespace stratum::report {

/// Light and dark schemes, wide screens and phones. `title` is text, `body` is HTML, `more_style` is CSS. Tables that
/// may be wide stand in a <div class='scroll'>.
std::string htmlPage(std::string_view title, std::string_view body, std::string_view more_style = {});

}  // namespace stratum::report
