// vdbview: level sets, prints and scenes -> a page in the browser to look at them.
#include "command_line.h"
#include "command_line/run_files.h"
#include "print_options.h"

#include "assemble/file/file_facts.h"
#include "assemble/file/input_files.h"
#include "assemble/picture_request.h"
#include "assemble/scene_file.h"
#include "base/error.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "serve/server.h"
#include "view/viewer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace stratum;

constexpr const char* kExamples = R"(
Examples:
  vdbview part.gcode --open                   in the browser of this machine
  vdbview part.gcode --voxel-size 0.05 --port 8080
  vdbview part.vdb part.gcode scene.json      one page, three inputs
  ssh -L 8080:127.0.0.1:8080 machine vdbview part.gcode --port 8080)";

struct ViewCommand {
    tools::CommonOptions common;
    std::vector<std::string> inputs, hosts;
    assemble::PrintRequest prints;
    std::string listen = "127.0.0.1", token_file;
    std::optional<std::size_t> brick_cache;
    std::uint16_t port = 0;
    bool open = false;
};

void addOptions(CLI::App& app, ViewCommand& o) {
    app.add_option("IN", o.inputs,
                   "What to look at: a print (G-code in any container), a level set, or a scene; of several, the page "
                   "chooses")
        ->required()
        ->type_name("FILE.gcode|FILE.vdb|SCENE.json");
    app.add_flag("--open", o.open, "Opens the page in the browser (xdg-open)");
    const char* server = "Server";
    app.add_option("--port", o.port, "Port to listen on (default: any that is free)")->type_name("N")->group(server);
    app.add_option("--listen", o.listen,
                   "Address to listen on (default 127.0.0.1: this machine alone). Who has the URL sees the input, and "
                   "the connection is not encrypted; pages then can't send files")
        ->type_name("ADDRESS")
        ->group(server);
    app.add_option(
           "--token-file", o.token_file,
           "Takes the URL's token from this file, which is made if it is not there: with --port, pages that are "
           "open find the next server, too")
        ->type_name("FILE")
        ->group(server);
    app.add_option("--host", o.hosts,
                   "A further name that the page is called by, e.g. behind a proxy, with its port unless that is the "
                   "usual one; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NAME[:PORT]")
        ->group(server);
    tools::Declarations(app, "Tracing")("--brick-cache", "SIZE",
                                        "No more than this of samples at once, of each print, e.g. 200MB");
    tools::addPrintOptions(app);
    tools::addCommonOptions(app, o.common,
                            {{"IN", "Prints, level sets, scenes; the page chooses"},
                             {"--open", "Opens the page in the browser"},
                             {"--port", "Default: any that is free"},
                             {"--listen", "Default 127.0.0.1: this machine alone"},
                             {"--voxel-size", ""},
                             {"--printer", "ideal, typical, or your printer's limits"},
                             {"--threads", ""},
                             {"--quiet", ""},
                             {"--version", "How it was built, and with what"},
                             {"--help", ""},
                             {"--help-all", ""}});
    app.footer(kExamples);
}

// The options of prints and bricks as they were given, for the command line that the page shows.
std::vector<std::string> givenWords(const CLI::App& app) {
    std::vector<std::string> names = tools::givenPrintOptions(app);
    if (app.get_option("--brick-cache")->count() > 0) names.emplace_back("--brick-cache");
    std::vector<std::string> words;
    for (const std::string& name : names)
        for (const std::string& value : app.get_option(name)->as<std::vector<std::string>>())
            words.push_back(fmt::format("{}={}", name, value));
    return words;
}

bool isScene(const std::string& path) { return assemble::isSceneFile(InputFile(path).first(4096)); }

view::GivenInput givenInput(const ViewCommand& o, const std::string& path, const std::vector<std::string>& words) {
    if (gcode::isStream(path))
        throw UsageError(fmt::format("{}: a stream can't be read anew when it has changed; name a file", path));
    view::GivenInput given;
    given.path = given.source = path;
    assemble::TracingOptions& tracing = given.options.tracing;
    if (isScene(path)) {
        assemble::SceneFile scene = assemble::readSceneFile(path);
        assemble::completeSamples(scene);
        given.objects = scene.objects;
        if (given.objects.empty()) {
            given.objects.push_back({.vdb = scene.print, .grid = scene.grid, .up = scene.file_up});
            given.source = scene.print;
        }
        given.options = scene;
        given.options.render.seconds = 0.0;  // pictures by the clock differ from each other
        given.options.render.checkpoint.clear();
    } else {
        given.objects.push_back({.vdb = path});
    }
    const bool prints = std::any_of(given.objects.begin(), given.objects.end(),
                                    [](const auto& object) { return !object.sdf && !assemble::isVdbFile(object.vdb); });
    if (prints) given.words = words;
    tracing.prints = o.prints;
    if (!given.options.tool_colors.empty()) tracing.prints.print.read.filament_colors = given.options.tool_colors;
    if (o.brick_cache) tracing.brick_cache = *o.brick_cache;
    return given;
}

// An input that is read anew when its file has changed.
view::GivenInput watchedInput(const ViewCommand& o, const std::string& path, const std::vector<std::string>& words) {
    view::GivenInput given = givenInput(o, path, words);
    given.again = [&o, path, words] { return givenInput(o, path, words); };
    return given;
}

// Of a file that a page has sent.
view::GivenInput sentInput(const ViewCommand& o, const std::string& path, const std::vector<std::string>& words) {
    // Nothing that a page says may name a file of this machine.
    if (isScene(path)) throw InputError("a scene names other files: give it to vdbview on the command line");
    return watchedInput(o, path, words);
}

/// A page that leads to the URL, for this user alone: arguments of processes can be read by all.
class LeadingPage {
public:
    explicit LeadingPage(const std::string& url) {
        const char* own = std::getenv("XDG_RUNTIME_DIR");
        path_ = (own != nullptr && *own != 0 ? std::string(own) : std::filesystem::temp_directory_path().string()) +
                "/vdbview-XXXXXX.html";
        const int file = mkstemps(path_.data(), 5);  // for its owner alone
        if (file < 0) throw OutputError(path_ + ": can't be written; open the URL yourself");
        const std::string text =
            fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={0}\">\n", url);
        const bool whole = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
        close(file);
        if (!whole) throw OutputError(path_ + ": can't be written; open the URL yourself");
    }
    ~LeadingPage() { unlink(path_.c_str()); }
    LeadingPage(const LeadingPage&) = delete;
    LeadingPage& operator=(const LeadingPage&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// The token in a file, or a new one written there for this user alone.
std::string tokenOf(const std::string& path) {
    if (path.empty()) return {};
    constexpr std::size_t kLength = 32;
    if (std::filesystem::exists(path)) {
        std::string token;
        std::ifstream(path) >> token;
        if (token.size() < kLength || token.find_first_not_of("0123456789abcdef") != std::string::npos)
            throw InputError(path +
                             ": holds no token of at least 32 hexadecimal digits; remove it, and a new one is made");
        return token;
    }
    std::string token = serve::randomToken();
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0) throw OutputError(path + ": can't be written");
    const bool whole = write(file, (token + "\n").data(), token.size() + 1) == static_cast<ssize_t>(token.size() + 1);
    close(file);
    if (!whole) throw OutputError(path + ": can't be written");
    return token;
}

void openBrowser(const std::string& page) {
    std::string program = "xdg-open";
    std::string address = page;
    char* const arguments[] = {program.data(), address.data(), nullptr};
    std::signal(SIGCHLD, SIG_IGN);  // nobody waits for it
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    if (posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments, environ) != 0)
        tools::tellError("vdbview: xdg-open could not be started; open the URL yourself\n");
    posix_spawn_file_actions_destroy(&actions);
}

void run(const CLI::App& app, const ViewCommand& o) {
    const tools::ThreadLimit limit(o.common.threads);
    const std::vector<std::string> words = givenWords(app);
    std::vector<view::GivenInput> inputs;
    for (const std::string& path : o.inputs) {
        try {
            inputs.push_back(watchedInput(o, path, words));
        } catch (const InputError& error) {
            // Of several inputs a bad one is shown when it has been written anew.
            if (o.inputs.size() == 1) throw;
            tools::tellError(fmt::format("vdbview: {}\n", error.what()));
            inputs.emplace_back();
            inputs.back().path = path;
            inputs.back().again = [&o, path, words] { return givenInput(o, path, words); };
        }
    }
    tools::RunFiles files;
    for (const view::GivenInput& input : inputs) {
        files.reads(input.path);
        for (const std::string& file : assemble::inputFiles(input.objects, input.options.scene, o.prints.print.printer))
            files.reads(file);
    }
    files.writesBeside(o.common.stats, "--stats");
    serve::ServerOptions options;
    view::Viewer::Read read_sent;
    if (serve::isLoopback(o.listen) && o.hosts.empty()) {
        read_sent = [&](const std::string& path) { return sentInput(o, path, words); };
        options.limits.file_bytes = view::SentFiles::kMostBytes;
    }
    const auto say = [&o](const std::string& text) {
        if (!o.common.quiet) tools::tellError(fmt::format("vdbview: {}\n", text));
    };
    auto viewer = std::make_unique<view::Viewer>(std::move(inputs), say, std::move(read_sent));
    options.address = o.listen;
    options.port = o.port;
    options.hosts = o.hosts;
    options.token = tokenOf(o.token_file);
    serve::Server server(options, view::pageFiles(), *viewer);
    fmt::print("{}\n", server.url());
    std::fflush(stdout);
    if (!o.common.quiet) tools::tellError("vdbview: ctrl-C ends it\n");
    std::unique_ptr<const LeadingPage> leading;
    if (o.open) {
        leading = std::make_unique<const LeadingPage>(server.url());
        openBrowser(leading->path());
    }
    if (viewer->descriptor() >= 0) server.watch(viewer->descriptor(), [&viewer] { viewer->filesChanged(); });
    server.run();
    viewer.reset();  // before the server: what it still makes is sent through that
    tools::writeStats(o.common, {{"inputs", o.inputs}, {"peak_rss_bytes", tools::peakRssBytes()}});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Shows prints, level sets and scenes in a browser.", "vdbview");
    ViewCommand command;
    addOptions(app, command);
    return tools::runTool(app, argc, argv, [&] {
        tools::CommandSource options(app);
        tools::readPrintOptions(options, command.prints.print);
        command.brick_cache = assemble::brickCacheOf(options);
        run(app, command);
    });
}
