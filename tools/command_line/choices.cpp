#include "choices.h"

#include "base/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace stratum::tools {
namespace {

constexpr std::string_view kMark = "completion:";  // at the beginning of a check's name
constexpr std::array<std::string_view, 4> kHow = {"word", "list", "selection", "preset"};

const CLI::Validator* checkOf(const CLI::Option& option, int n) {
    try {
        return const_cast<CLI::Option&>(option).get_validator(n);
    } catch (const CLI::OptionNotFound&) {
        return nullptr;
    }
}

}  // namespace

CLI::Validator oneOf(std::vector<std::string> names) {
    std::vector<std::pair<std::string, int>> values;
    values.reserve(names.size());
    for (std::string& name : names) values.emplace_back(std::move(name), -1);
    return enumeration(std::move(values));
}

CLI::Validator enumeration(std::vector<std::pair<std::string, int>> values) {
    std::vector<std::string> names;
    names.reserve(values.size());
    for (const auto& value : values) names.push_back(value.first);
    const std::string all = fmt::format("{}", fmt::join(names, ", "));
    const std::string description = fmt::format("{{{}}}", fmt::join(names, ","));
    return {[values = std::move(values), all](std::string& text) -> std::string {
                const auto found = std::find_if(values.begin(), values.end(),
                                                [&text](const auto& value) { return value.first == text; });
                if (found != values.end()) {
                    if (found->second >= 0) text = std::to_string(found->second);
                    return {};
                }
                std::vector<std::string_view> views;
                for (const auto& value : values) views.push_back(value.first);
                return fmt::format("'{}' is none of {}{}", text, all, didYouMean(text, views));
            },
            description, ""};
}

CLI::Option* completes(CLI::Option* option, Completion how, const std::vector<std::string>& names) {
    return option->check(
        CLI::Validator([](std::string&) { return std::string(); }, "",
                       fmt::format("{}{}:{}", kMark, kHow[static_cast<std::size_t>(how)], fmt::join(names, ","))));
}

Choices choicesOf(const CLI::Option& option) {
    for (int n = 0;; ++n) {
        const CLI::Validator* check = checkOf(option, n);
        if (check == nullptr) break;
        const std::string& name = check->get_name();
        if (!name.starts_with(kMark)) continue;
        const std::string rest = name.substr(kMark.size());
        const std::size_t colon = rest.find(':');
        const auto how = std::find(kHow.begin(), kHow.end(), rest.substr(0, colon));
        return {static_cast<Completion>(how - kHow.begin()), CLI::detail::split(rest.substr(colon + 1), ',')};
    }
    const std::string checks = checksOf(option);
    if (!checks.starts_with(":{")) return {};
    return {Completion::word, CLI::detail::split(checks.substr(2, checks.find('}') - 2), ',')};
}

std::string checksOf(const CLI::Option& option) {
    std::string text;
    for (int n = 0;; ++n) {
        const CLI::Validator* check = checkOf(option, n);
        if (check == nullptr) return text;
        const std::string description = check->get_description();
        if (!description.empty()) text += ":" + description;
    }
}

}  // namespace stratum::tools
