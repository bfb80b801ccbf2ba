#include "shade/palette/filament_table.h"

#include "base/error.h"
#include "base/input_file.h"
#include "base/text.h"
#include "shade/data_folder.h"
#include "shade/palette/finish_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

namespace stratum::shade {
namespace {

constexpr std::size_t kColumns = 7;
constexpr std::array<std::string_view, 5> kFinishes{"plain", "matte", "glossy", "silk", "glitter"};

// UTF-8 of accented letters, of two bytes each, and behind them what they are looked up as.
constexpr std::string_view kFolded = "äa öo üu Äa Öo Üu ßss áa ée èe íi óo úu çc";

bool isWordByte(char c) { return isLetter(c) || (c >= '0' && c <= '9') || c == '+'; }

/// The next part up to a separator, which is taken too.
std::string_view cut(std::string_view& rest, char separator) {
    const std::size_t end = rest.find(separator);
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    return part;
}

/// "RRGGBB", "RRGGBBAA" or "AARRGGBB"; nothing for several colors.
std::optional<std::uint32_t> colorOf(std::string_view hex) {
    if (hex.size() == 3) {
        const std::array<char, 6> doubled{hex[0], hex[0], hex[1], hex[1], hex[2], hex[2]};
        return colorOf({doubled.data(), doubled.size()});
    }
    // The table has both orders. Those of its rows whose alpha is last end in 22 or 88; it is not used.
    if (hex.size() == 8) hex = hex.ends_with("22") || hex.ends_with("88") ? hex.substr(0, 6) : hex.substr(2);
    return hex.size() == 6 ? parsed<std::uint32_t>(hex, 16) : std::nullopt;
}

Finish finishOf(const Filament& filament, std::string_view stated, std::string_view pattern) {
    if (pattern == "sparkle") return Finish::glitter;
    std::vector<std::string> words = wordsOf(filament.material);
    words.insert(words.end(), filament.name_words.begin(), filament.name_words.end());
    const Finish said = finishOfWords(words);
    if (said == Finish::glitter || said == Finish::silk) return said;
    if (stated == "matte") return Finish::matte;
    if (stated == "glossy") return Finish::glossy;
    return said;
}

}  // namespace

std::vector<std::string> wordsOf(std::string_view text) {
    std::vector<std::string> words;
    bool fresh = true;
    while (!text.empty()) {
        std::string_view letters;
        std::size_t taken = 1;
        std::string plain;
        if (isWordByte(text.front())) {
            plain = lowerCase(text.front());
            letters = plain;
        } else {
            for (const std::string_view folded : split(kFolded, ' '))
                if (text.starts_with(folded.substr(0, 2))) {
                    letters = folded.substr(2);
                    taken = 2;
                }
        }
        text.remove_prefix(taken);
        if (!letters.empty()) {
            if (fresh) words.emplace_back();
            words.back() += letters;
        }
        fresh = letters.empty();
    }
    return words;
}

std::vector<Filament> parseFilaments(std::string_view text, std::string_view file) {
    std::vector<Filament> table;
    std::size_t line = 0;
    while (!text.empty()) {
        std::string_view row = trim(cut(text, '\n'), "\r");
        if (++line == 1 || row.empty()) continue;  // the names of the columns
        std::array<std::string_view, kColumns> cells;
        const auto separators = static_cast<std::size_t>(std::count(row.begin(), row.end(), '\t'));
        if (separators + 1 != kColumns)
            throw InputError(fmt::format("{}:{}: {} columns where {} belong", file, line, separators + 1, kColumns));
        for (std::string_view& cell : cells) cell = trim(cut(row, '\t'));
        if (cells[3].find(',') != std::string_view::npos) continue;
        const std::optional<std::uint32_t> color = colorOf(cells[3]);
        if (!color) throw InputError(fmt::format("{}:{}: {} is no colour RRGGBB", file, line, cells[3]));
        Filament filament{
            std::string(cells[0]), std::string(cells[1]), std::string(cells[2]), *color, Finish::plain, {},
            wordsOf(cells[2])};
        filament.finish = finishOf(filament, cells[4], cells[6]);
        filament.words = wordsOf(fullName(filament));
        table.push_back(std::move(filament));
    }
    return table;
}

const std::vector<Filament>& filaments() {
    static const std::vector<Filament> table = [] {
        const std::filesystem::path path = dataFolder() / "filaments" / "colors.tsv";
        return parseFilaments(InputFile(path).bytes(), path.string());
    }();
    return table;
}

std::string fullName(const Filament& filament) {
    return fmt::format("{} {} {}", filament.maker, filament.material, filament.name);
}

std::string_view finishName(Finish finish) { return kFinishes[static_cast<std::size_t>(finish)]; }

}  // namespace stratum::shade
