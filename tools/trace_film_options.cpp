#include "trace_film_options.h"

#include "choices.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace stratum::tools {

void addFilmOptions(CLI::App& app, FilmCommand& film, assemble::HotEndLook& nozzle) {
    const char* group = "Film";
    // Ranges let "nan" pass.
    const CLI::Validator finite(
        [](const std::string& text) {
            return text.find_first_of("nN") == text.npos ? std::string() : "expected a number, not " + text;
        },
        "");
    const auto option = [&](const char* name, auto& value, const char* type, const char* help) {
        return app.add_option(name, value, help)->type_name(type)->group(group);
    };
    option("--film", film.output, "FILE",
           "Instead of pictures a film: .mp4, .webm or .gif by the system's ffmpeg, or an animated .png. Of G-code "
           "the print grows, a level set turns, unless --grow, --turntable or --camera-path say otherwise");
    option("--seconds", film.seconds, "S", "How long (default 8, or as long as --camera-path)")
        ->check(CLI::Range(0.0, 86400.0))
        ->check(finite)
        ->each([&film](const std::string&) { film.seconds_given = true; });
    option("--fps", film.rate, "N", "Frames a second, also 23.976, 29.97 or 59.94 (default 30, of .gif and .png 20)")
        ->check(CLI::Range(1.0, 240.0))
        ->check(finite);
    option("--grow", film.grow, "time|filament|layers",
           "G-code: the print grows bead by bead, by the time that it takes to print, by filament, or at a "
           "steady pace upwards, each layer in the same time")
        ->check(oneOf(kGrowths));
    option("--hold", film.hold, "S",
           "G-code: how long the finished print is shown at the end (default 1, of films of less than 4 s 0)")
        ->check(CLI::Range(0.0, 86400.0))
        ->check(finite);
    option("--ease", film.ease, "S",
           "The print grows, and the camera turns, ever faster during the first S seconds and slower during the "
           "last (default 0: evenly)")
        ->check(CLI::Range(0.0, 86400.0))
        ->check(finite);
    option("--camera-path", film.camera_path, "FILE.json",
           "The camera moves smoothly through {\"keys\": [{\"time\": 0, \"eye\": [X,Y,Z], \"look_at\": ..., "
           "\"up\": ..., \"fov\": ...}, ...]}");
    const auto hot_end = [&](const char* name, assemble::HotEndKind kind, const char* help) {
        return app
            .add_flag_callback(
                name, [&nozzle, kind] { nozzle.kind = kind; }, help)
            ->group(group);
    };
    auto* metal = hot_end("--nozzle", assemble::HotEndKind::metal,
                          "G-code: a hot end stands where the last bead ends; of pictures, too");
    hot_end("--clear-nozzle", assemble::HotEndKind::clear, "The same of glass, through which the part is seen")
        ->excludes(metal);
    app.add_option_function<std::string>(
           "--hot-end",
           [&nozzle](const std::string& name) {
               nozzle.shape = *valueOf(assemble::kHotEndShapes, name);
               if (nozzle.kind == assemble::HotEndKind::none) nozzle.kind = assemble::HotEndKind::metal;
           },
           "Which one: slender (the default, smaller above a small part), v6 or volcano (of E3D, full size); implies "
           "--nozzle")
        ->check(oneOf(assemble::kHotEndShapes))
        ->type_name("NAME")
        ->group(group);
}

std::string givenFilmOptions(const FilmCommand& film) {
    std::vector<std::string> given;
    if (film.seconds_given) given.emplace_back("--seconds");
    if (film.rate > 0) given.emplace_back("--fps");
    if (!film.grow.empty()) given.emplace_back("--grow");
    if (film.hold) given.emplace_back("--hold");
    if (film.ease > 0) given.emplace_back("--ease");
    if (!film.camera_path.empty()) given.emplace_back("--camera-path");
    return fmt::format("{}", fmt::join(given, ", "));
}

}  // namespace stratum::tools
