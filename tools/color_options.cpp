#include "color_options.h"

#include "base/error.h"
#include "shade/palette/color_name.h"

#include <fmt/format.h>

#include <string>

namespace stratum::tools {

void addColorList(CLI::App& app, const char* group) {
    app.add_option_function<std::string>(
           "--colors",
           [](const std::string& words) {
               std::string list;
               try {
                   list = shade::listFilaments(words);
               } catch (const InputError& error) {
                   throw CLI::ValidationError("--colors", error.what());
               }
               if (list.empty())
                   throw CLI::ValidationError("--colors", fmt::format("no filament has all of the words {}", words));
               list.pop_back();  // the end of the last line comes with it
               throw CLI::CallForVersion(list, 0);
           },
           "Lists the real filaments that --color knows by these words, e.g. 'prusament galaxy', and does nothing else")
        ->type_name("WORDS")
        ->group(group);
}

}  // namespace stratum::tools
