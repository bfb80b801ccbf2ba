#include "report/text/html_page.h"

#include <fmt/format.h>

namespace stratum::report {
namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--paper:#fff;--ink:#1d2329;--soft:#5c6670;--line:#dde2e7;--card:#f5f7f9;--warn:#8a4b00}
@media(prefers-color-scheme:dark){:root{--paper:#14181c;--ink:#e4e8ec;--soft:#98a3ae;--line:#313941;--card:#1c2127;--warn:#f0b060;
--plot-paper:#1c2127;--plot-ink:#e4e8ec;--plot-lines:#3a434c}}
*{box-sizing:border-box}
body{font:16px/1.45 system-ui,sans-serif;margin:0 auto;max-width:76rem;padding:1.2rem 1rem 3rem;background:var(--paper);color:var(--ink)}
h1{font-size:1.5rem;margin:0 0 .2rem;overflow-wrap:anywhere}h2{font-size:1.15rem;margin:2rem 0 .6rem}
p{margin:.3rem 0}.soft{color:var(--soft);font-size:.88rem}
dl{margin:0;display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,20rem),1fr));gap:.7rem}
dl>div{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:.7rem .9rem}
dt{color:var(--soft);font-size:.9rem}dd{margin:0}
dd.v{font-size:1.25rem;font-weight:600;white-space:pre-line;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
dd.m{font-size:.85rem;font-weight:400;line-height:1.5}dd.v.t{font-size:.95rem}
.out{color:var(--warn)}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.9rem;margin:.8rem 0}
th,td{border-bottom:1px solid var(--line);padding:.3rem .7rem;text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
th{color:var(--soft);font-weight:500}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,26rem),1fr));gap:.7rem}
.plots figure{margin:0;background:var(--plot-paper,#fff);border:1px solid var(--line);border-radius:8px;padding:.4rem}
.plots svg{display:block;width:100%;height:auto}figcaption{color:var(--soft);font-size:.85rem;padding:0 .5rem .4rem})";

}  // namespace

std::string htmlPage(std::string_view title, std::string_view body, std::string_view more_style) {
    return fmt::format(
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' "
        "content='width=device-width,initial-scale=1'><title>{0}</title>\n<style>{1}{2}</style></head>\n"
        "<body>\n<h1>{0}</h1>\n{3}</body></html>\n",
        escapeMarkup(title), kStyle, more_style, body);
}

}  // namespace stratum::report
