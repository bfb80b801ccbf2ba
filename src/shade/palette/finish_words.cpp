#include "shade/palette/finish_words.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace stratum::shade {
namespace {

/// Words that begin so: "silk+", "sparkling".
constexpr std::array<std::string_view, 5> kFlakes{"galax", "glitter", "sparkl", "twinkl", "stardust"};
constexpr std::array<std::string_view, 3> kMattBeginnings{"wood", "marble", "glow"};
constexpr std::array<std::string_view, 2> kMatt{"matte", "matt"};
constexpr std::array<std::string_view, 4> kGlossy{"glossy", "gloss", "shiny", "shine"};

template <std::size_t N>
bool beginsAsOneOf(std::string_view word, const std::array<std::string_view, N>& beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [word](std::string_view beginning) { return word.starts_with(beginning); });
}

template <std::size_t N>
bool isAmong(std::string_view word, const std::array<std::string_view, N>& all) {
    return std::find(all.begin(), all.end(), word) != all.end();
}

/// "cf", "gf20".
bool isFiber(std::string_view word) {
    return (word.starts_with("cf") || word.starts_with("gf")) &&
           std::all_of(word.begin() + 2, word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "Carbon Fiber", but not the colour "Carbon Black".
bool hasFiber(const std::vector<std::string>& words) {
    for (std::size_t n = 0; n < words.size(); ++n) {
        if (isFiber(words[n])) return true;
        const bool named = words[n] == "carbon" || words[n] == "glass";
        if (named && n + 1 < words.size() && words[n + 1].starts_with("fib")) return true;
    }
    return false;
}

}  // namespace

Finish finishOfWords(const std::vector<std::string>& words) {
    // A plus joins materials, "PLA+WOOD", or ends a brand, "Silk+".
    std::vector<std::string> parts;
    for (std::string_view word : words)
        while (!word.empty()) {
            const std::size_t plus = word.find('+');
            if (plus != 0) parts.emplace_back(word.substr(0, plus));
            word.remove_prefix(plus == std::string_view::npos ? word.size() : plus + 1);
        }
    const auto any = [&parts](const auto& is) { return std::any_of(parts.begin(), parts.end(), is); };
    if (any([](const std::string& word) { return beginsAsOneOf(word, kFlakes); })) return Finish::glitter;
    if (any([](const std::string& word) { return word.starts_with("silk"); })) return Finish::silk;
    if (any([](const std::string& word) { return isAmong(word, kMatt) || beginsAsOneOf(word, kMattBeginnings); }) ||
        hasFiber(parts))
        return Finish::matte;
    if (any([](const std::string& word) { return isAmong(word, kGlossy); })) return Finish::glossy;
    return Finish::plain;
}

Finish finishOfProfile(std::string_view name) { return finishOfWords(wordsOf(name.substr(0, name.find('@')))); }

}  // namespace stratum::shade
