#include "shade/palette/color_name.h"

#include "base/error.h"
#include "base/names.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

namespace stratum::shade {
namespace {

constexpr std::size_t kSuggested = 3;
constexpr std::size_t kMostLetters = 80;  // of a name; a slip may be as long as a file

bool has(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::size_t otherWords(const Filament& filament, const std::vector<std::string>& asked) {
    return static_cast<std::size_t>(std::count_if(filament.name_words.begin(), filament.name_words.end(),
                                                  [&asked](const std::string& word) { return !has(asked, word); }));
}

std::size_t distance(const Filament& filament, const std::vector<std::string>& asked) {
    std::size_t sum = 0;
    for (const std::string& word : asked) {
        std::size_t least = word.size();
        for (const std::string& own : filament.words) least = std::min(least, editDistance(word, own));
        sum += least;
    }
    return sum;
}

std::string quoted(const std::vector<const Filament*>& filaments) {
    std::string text;
    for (std::size_t n = 0; n < std::min(filaments.size(), kSuggested); ++n)
        text += fmt::format("{}'{}' (#{:06x})", n == 0 ? "" : ", ", fullName(*filaments[n]), filaments[n]->color);
    return text;
}

// The nearest first; of equally near ones those with the shorter names. One a color.
std::vector<const Filament*> nearest(const std::vector<std::string>& asked) {
    std::vector<std::pair<std::pair<std::size_t, std::size_t>, const Filament*>> ranked;
    ranked.reserve(filaments().size());
    for (const Filament& filament : filaments())
        ranked.push_back({{distance(filament, asked), otherWords(filament, asked)}, &filament});
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<const Filament*> found;
    for (const auto& [rank, filament] : ranked) {
        const std::uint32_t color = filament->color;
        if (std::none_of(found.begin(), found.end(), [color](const Filament* f) { return f->color == color; }))
            found.push_back(filament);
        if (found.size() == kSuggested) break;
    }
    return found;
}

// Those that are meant by the words: of all that have them, the ones with the fewest other words in their names.
std::vector<const Filament*> meantBy(const std::vector<std::string>& asked) {
    std::vector<const Filament*> meant;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const Filament& filament : filaments()) {
        const auto in_it = [&filament](const std::string& word) { return has(filament.words, word); };
        if (!std::all_of(asked.begin(), asked.end(), in_it)) continue;
        const std::size_t others = otherWords(filament, asked);
        if (others < fewest) meant.clear();
        fewest = std::min(fewest, others);
        if (others == fewest) meant.push_back(&filament);
    }
    return meant;
}

const Filament& filamentNamed(std::string_view text, std::string_view option) {
    const std::string shown(text.substr(0, kMostLetters));
    const std::vector<std::string> asked = wordsOf(shown);
    if (text.size() > kMostLetters || text.starts_with('#') || asked.empty())
        throw UsageError(
            fmt::format("{} {}: is no colour; write '#rrggbb', a name as in CSS, e.g. orange, or a "
                        "filament's, e.g. 'Prusament Galaxy Black'",
                        option, shown));
    const std::vector<const Filament*> meant = meantBy(asked);
    if (meant.empty())
        throw UsageError(fmt::format("{} {}: neither a colour of CSS nor a filament has this name; did you mean {}?",
                                     option, shown, quoted(nearest(asked))));
    std::vector<const Filament*> different;
    for (const Filament* filament : meant)
        if (std::none_of(different.begin(), different.end(), [filament](const Filament* other) {
                return other->color == filament->color && other->finish == filament->finish;
            }))
            different.push_back(filament);
    if (different.size() > 1)
        throw UsageError(fmt::format(
            "{} {}: {} filaments of different colours have this name; did you mean {}{}? "
            "Name the maker, or the colour",
            option, shown, different.size(), quoted(different), different.size() > kSuggested ? " or another" : ""));
    return *meant.front();
}

}  // namespace

std::string brdfOf(std::uint32_t color, Finish finish) {
    constexpr float kGlossyAlpha = 0.08f;
    if (finish == Finish::plain) return fmt::format("#{:06x}", color);
    const Color body = bodyOf(fromSrgb(color));
    const std::string numbers = fmt::format("{:.4f},{:.4f},{:.4f}", body.r, body.g, body.b);
    if (finish == Finish::glossy) return fmt::format("plastic:{},{}", numbers, kGlossyAlpha);
    return fmt::format("{}:{}", finishName(finish), numbers);
}

ColorName colorNamed(std::string_view text, std::string_view option) {
    if (const auto color = parseNamedColor(text)) {
        const std::string hex = hexOf(*color);
        return {static_cast<std::uint32_t>(std::stoul(hex.substr(1), nullptr, 16)), std::string(text),
                std::string(text)};
    }
    const Filament& filament = filamentNamed(text, option);
    return {filament.color, fullName(filament), brdfOf(filament.color, filament.finish)};
}

std::vector<const Filament*> filamentsWith(std::string_view words) {
    const std::vector<std::string> asked = wordsOf(words);
    std::vector<const Filament*> found;
    for (const Filament& filament : filaments())
        if (std::all_of(asked.begin(), asked.end(),
                        [&filament](const std::string& word) { return has(filament.words, word); }))
            found.push_back(&filament);
    return found;
}

std::string listFilaments(std::string_view words) {
    std::string text;
    for (const Filament* filament : filamentsWith(words)) {
        const std::string finish =
            filament->finish == Finish::plain ? "" : fmt::format("  {}", finishName(filament->finish));
        fmt::format_to(std::back_inserter(text), "{:<56} #{:06x}{}\n", fullName(*filament), filament->color, finish);
    }
    return text;
}

}  // namespace stratum::shade
