#include "manual.h"

#include "base/text.h"
#include "choices.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>

namespace stratum::tools {
namespace {

constexpr std::size_t kExamplesInBrief = 3;
constexpr const char* kExamplesTitle = "Examples:";
constexpr const char* kOptionsGroup = "Options";  // CLI11's for options without one
constexpr const char* kCommonGroup = "General";
constexpr std::size_t kScreenColumns = 80;

std::string typeName(const CLI::Option& option) {
    const std::string name = option.get_type_name();
    return name.substr(0, name.size() - checksOf(option).size());
}

bool isVisible(const CLI::Option& option) { return !option.get_group().empty(); }

// Headings in reading order: what has none of its own first, what every tool has last.
std::vector<std::string> groupsOf(const CLI::App& app) {
    std::vector<std::string> groups = app.get_groups();
    groups.erase(std::remove(groups.begin(), groups.end(), ""), groups.end());
    std::stable_partition(groups.begin(), groups.end(), [](const std::string& g) { return g != kCommonGroup; });
    std::stable_partition(groups.begin(), groups.end(), [](const std::string& g) { return g == kOptionsGroup; });
    return groups;
}

// The footer as far as its first examples go.
std::string firstExamples(const CLI::App& app) {
    std::string footer = app.get_footer();
    const std::size_t examples = footer.find(kExamplesTitle);
    if (examples == std::string::npos) return footer;
    std::size_t end = footer.find('\n', examples);
    for (std::size_t n = 0; n < kExamplesInBrief && end != std::string::npos; ++n) end = footer.find('\n', end + 1);
    return footer.substr(0, end);
}

class HelpFormatter : public CLI::Formatter {
public:
    explicit HelpFormatter(const Brief& brief) : brief_(brief.begin(), brief.end()) { column_width(29); }

    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
        if (mode == CLI::AppFormatMode::Sub) return CLI::Formatter::make_help(app, std::move(name), mode);
        const bool all = mode == CLI::AppFormatMode::All || brief_.empty();
        std::string text = make_description(app) + make_usage(app, std::move(name));
        text += all ? make_positionals(app) : briefGroup(*app, "") + "\nOptions:\n";
        for (const std::string& group : groupsOf(*app)) {
            if (!all) {
                text += briefGroup(*app, group);
                continue;
            }
            const auto options = app->get_options([&group](const CLI::Option* option) {
                return option->get_group() == group && option->nonpositional();
            });
            if (!options.empty()) text += make_group(group, false, options);
        }
        text += make_subcommands(app, mode);
        return text + (all ? app->get_footer() : briefFooter(*app)) + "\n";
    }

    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        std::string text = "  " + make_option_name(option, is_positional) + make_option_opts(option);
        std::size_t column = text.size() + 1;
        if (column > column_width_) {
            text += '\n';
            column = 1;
        }
        text.append(column_width_ - std::min(column, column_width_), ' ');
        column = column_width_;
        for (const std::string& word : CLI::detail::split(option->get_description(), ' ')) {
            if (column + 1 + word.size() > kScreenColumns) {
                text += "\n" + std::string(column_width_ - 1, ' ');
                column = column_width_ - 1;
            }
            text += " " + word;
            column += 1 + word.size();
        }
        return text + "\n";
    }

    std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
        // "--bed,--no-bed{false}": the braces are CLI11's.
        const std::string name = option->get_name(is_positional, true);
        return name.substr(0, name.find('{'));
    }

    std::string make_option_opts(const CLI::Option* option) const override {
        return option->get_type_size() == 0 ? "" : " " + typeName(*option);
    }

private:
    static std::string briefFooter(const CLI::App& app) {
        return fmt::format("{}\n\n{} --help-all tells the rest.", firstExamples(app), app.get_name());
    }

    // A line an option: of a group, or of what has no dashes.
    std::string briefGroup(const CLI::App& app, const std::string& group) const {
        std::string lines;
        for (const CLI::Option* option : app.get_options()) {
            const auto known = brief_.find(option->get_name(!option->nonpositional()));
            if (known == brief_.end() || (option->nonpositional() ? option->get_group() != group : !group.empty()))
                continue;
            const std::string& text = known->second.empty() ? option->get_description() : known->second;
            lines += fmt::format("  {:<{}} {}\n",
                                 make_option_name(option, !option->nonpositional()) + make_option_opts(option),
                                 column_width_ - 3, text);
        }
        return lines;
    }

    std::map<std::string, std::string> brief_;
};

// Backslashes, leading dots and hyphens mean something else to roff.
std::string roff(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else if ((c == '.' || c == '\'') && (i == 0 || text[i - 1] == '\n'))
            out += std::string("\\&") + c;
        else
            out += c;
    }
    return out;
}

void manOption(std::string& page, const CLI::Option& option) {
    std::string name;
    for (const std::string& one : CLI::detail::split(option.get_name(option.get_positional(), true), ','))
        name += (name.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", roff(one));
    if (option.get_type_size() != 0) name += fmt::format(" \\fI{}\\fR", roff(typeName(option)));
    page += fmt::format(".TP\n{}\n{}\n", name, roff(option.get_description()));
    if (const Choices choices = choicesOf(option); !checksOf(option).empty() && !choices.names.empty())
        page += fmt::format("One of {}.\n", roff(fmt::format("{}", fmt::join(choices.names, ", "))));
    if (!option.get_excludes().empty()) {
        std::vector<std::string> names;
        for (const CLI::Option* other : option.get_excludes()) names.push_back(other->get_name());
        std::sort(names.begin(), names.end());  // CLI11 keeps them by address
        page += fmt::format("Not together with {}.\n", roff(fmt::format("{}", fmt::join(names, ", "))));
    }
}

void manOptions(std::string& page, const CLI::App& app, std::string_view group_macro) {
    for (const CLI::Option* option : app.get_options())
        if (option->get_positional() && isVisible(*option)) manOption(page, *option);
    for (const std::string& group : groupsOf(app)) {
        std::string part;
        for (const CLI::Option* option : app.get_options())
            if (option->nonpositional() && option->get_group() == group) manOption(part, *option);
        if (!part.empty()) page += fmt::format("{} {}\n{}", group_macro, roff(group), part);
    }
}

std::string words(const CLI::App& app) {
    std::string list;
    for (const CLI::Option* option : app.get_options())
        if (option->nonpositional() && isVisible(*option))
            for (const std::string& name : CLI::detail::split(option->get_name(false, true), ','))
                list += (list.empty() ? "" : " ") + name.substr(0, name.find('{'));
    return list;
}

// What completes a value, by kind. A list goes on after its last comma, and after a sign if it has those.
std::string completionOf(const Choices& choices) {
    const std::string names = fmt::format("{}", fmt::join(choices.names, " "));
    switch (choices.how) {
        case Completion::word:
            return fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$cur\"))", names);
        case Completion::preset:
            return fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$cur\") $(compgen -f -- \"$cur\"))", names);
        case Completion::list:
            return fmt::format("COMPREPLY=($(compgen -P \"$begun\" -W \"{}\" -- \"${{cur##*,}}\"))", names);
        case Completion::selection:
            break;
    }
    std::string both;
    for (const std::string& name : choices.names) both += fmt::format("{}+{} -{}", both.empty() ? "" : " ", name, name);
    return fmt::format("COMPREPLY=($(compgen -P \"$begun\" -W \"{}\" -- \"${{cur##*,}}\"))", both);
}

// case labels of the options that take one of a few words.
std::string choiceCases(const CLI::App& app) {
    std::string cases;
    for (const CLI::Option* option : app.get_options()) {
        const Choices choices = choicesOf(*option);
        if (option->nonpositional() && isVisible(*option) && !choices.names.empty())
            cases += fmt::format("        {}) {}; return;;\n",
                                 fmt::join(CLI::detail::split(option->get_name(false, true), ','), "|"),
                                 completionOf(choices));
    }
    return cases;
}

}  // namespace

std::string manPage(const CLI::App& app) {
    const std::string& name = app.get_name();
    std::string page =
        fmt::format(".TH {} 1 \"\" \"Stratum {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n",
                    upperCase(std::string(name)), STRATUM_VERSION, name, roff(app.get_description()), name);
    const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
    if (!verbs.empty()) page += ".I COMMAND\n";
    page += "[\\fIOPTIONS\\fR]";
    for (const CLI::Option* option : app.get_options())
        if (option->get_positional()) page += fmt::format(" \\fI{}\\fR...", roff(option->get_name(true, false)));
    page += "\n.SH OPTIONS\n";
    manOptions(page, app, ".SS");
    if (!verbs.empty()) page += ".SH COMMANDS\n";
    for (const CLI::App* verb : verbs) {
        page += fmt::format(".SS {}\n{}\n", verb->get_name(), roff(verb->get_description()));
        for (const CLI::Option* option : verb->get_options())
            if (isVisible(*option)) manOption(page, *option);
    }
    const std::string footer = app.get_footer();
    const std::size_t examples = footer.find(kExamplesTitle);
    if (examples != std::string::npos) {
        if (examples > 1) page += ".SH NOTES\n" + roff(footer.substr(1, examples - 1));
        page += ".SH EXAMPLES\n.nf\n" + roff(footer.substr(footer.find('\n', examples) + 1)) + "\n.fi\n";
    }
    return page +
           ".SH EXIT STATUS\n"
           "0 done, 1 failed, 2 wrong usage, 3 bad input, 130 interrupted.\n"
           "Output appears whole or not at all: it is written beside its place and renamed.\n"
           ".SH ENVIRONMENT\n.TP\n.B STRATUM_DATA\n"
           "Where the tables of materials are, if not where they were installed.\n";
}

std::string shortUsage(const CLI::App& app) {
    std::string text = fmt::format("{}\nUsage: {}", app.get_description(), app.get_name());
    if (app.get_require_subcommand_min() > 0) {
        std::vector<std::string> verbs;
        for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
            verbs.push_back(verb->get_name());
        text += fmt::format(" {}", fmt::join(verbs, "|"));
    }
    for (const CLI::Option* option : app.get_options())
        if (option->get_positional()) text += fmt::format(" {}...", typeName(*option));
    return fmt::format("{} [OPTIONS]\n{}\n{} -h lists the options that most people need.\n", text, firstExamples(app),
                       app.get_name());
}

std::string bashCompletion(const CLI::App& app) {
    const std::string& name = app.get_name();
    std::string script = fmt::format(
        "# bash completion for {0}\n_{0}() {{\n    local cur=${{COMP_WORDS[COMP_CWORD]}} "
        "prev=${{COMP_WORDS[COMP_CWORD-1]}}\n    local words=\"{1}\"\n"
        // --view=fr is three words to bash.
        "    if [[ $cur == \"=\" ]]; then cur=; elif [[ $prev == \"=\" ]]; then prev=${{COMP_WORDS[COMP_CWORD-2]}}; "
        "fi\n"
        "    local begun=; [[ $cur == *,* ]] && begun=\"${{cur%,*}},\"\n",
        name, words(app));
    std::string cases = choiceCases(app);
    std::string verb_words;
    const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
    for (const CLI::App* verb : verbs) {
        cases += choiceCases(*verb);
        verb_words += fmt::format("        {}) words=\"{}\";;\n", verb->get_name(), words(*verb));
    }
    if (!verbs.empty()) {
        std::vector<std::string> names;
        names.reserve(verbs.size());
        for (const CLI::App* verb : verbs) names.push_back(verb->get_name());
        script += fmt::format(
            "    if [[ $COMP_CWORD -eq 1 ]]; then\n        COMPREPLY=($(compgen -W \"$words {}\" -- \"$cur\"))\n"
            "        return\n    fi\n    case ${{COMP_WORDS[1]}} in\n{}    esac\n",
            fmt::join(names, " "), verb_words);
    }
    if (!cases.empty()) script += fmt::format("    case $prev in\n{}    esac\n", cases);
    return script + fmt::format(
                        "    [[ $cur == -* ]] && COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n}}\n"
                        "complete -o default -F _{0} {0}\n",
                        name);
}

void addManual(CLI::App& app, const Brief& brief) {
    app.formatter(std::make_shared<HelpFormatter>(brief));
    app.set_help_all_flag("--help-all", "All options and examples")->group(kCommonGroup);
    app.get_help_ptr()->description("The options that most people need")->group(kCommonGroup);
    app.add_option_function<std::string>(
           "--write-manual",
           [&app](const std::string& kind) {
               fmt::print("{}", kind == "man" ? manPage(app) : bashCompletion(app));
               throw CLI::Success();
           },
           "For the build: prints the man page or the completion")
        ->check(CLI::IsMember({"man", "bash"}))
        // Before required arguments are missed, which versions of CLI11 look for at different times.
        ->trigger_on_parse()
        ->group("");
}

}  // namespace stratum::tools
