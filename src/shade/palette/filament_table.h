// The colors of real filaments: data/filaments/colors.tsv, from SpoolmanDB (MIT licence).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// How a filament's surface looks, as its maker says.
enum class Finish : std::uint8_t { plain, matte, glossy, silk, glitter };

struct Filament {
    std::string maker;        ///< "Prusament"
    std::string material;     ///< "PLA"
    std::string name;         ///< "Galaxy Black"
    std::uint32_t color = 0;  ///< sRGB, 0xRRGGBB
    Finish finish = Finish::plain;
    std::vector<std::string> words;       ///< of all three, see wordsOf()
    std::vector<std::string> name_words;  ///< of the name
};

/// The table, read once; immutable. Rows of several colors are left out. The pattern "sparkle" is Finish::glitter; else
/// flakes and silk by the words of name and material (finishOfWords()), then the stated finish, then their other words.
/// Throws InputError if the file is missing or damaged.
const std::vector<Filament>& filaments();

/// Reads such a table. `file` is its name for messages. Throws InputError.
std::vector<Filament> parseFilaments(std::string_view text, std::string_view file);

/// Lower-case words of letters and digits, with the accents of Latin letters taken off: "PolyLite(TM) Grün" is
/// polylite, grun.
std::vector<std::string> wordsOf(std::string_view text);

/// "Prusament PLA Galaxy Black".
std::string fullName(const Filament& filament);

std::string_view finishName(Finish finish);

}  // namespace stratum::shade
