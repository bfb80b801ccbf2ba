// The options of a command line, by the names that Python has: ao_distance is --ao-distance.
#pragma once

#include "base/options/option_source.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::tools {

/// All of them are declared in the parser, without a variable. All errors are UsageError.
class CommandSource final : public OptionSource {
public:
    /// @param app  has parsed, and outlives this
    explicit CommandSource(const CLI::App& app) : app_(&app) {}

    std::optional<double> number(std::string_view name) override;
    std::optional<std::int64_t> integer(std::string_view name, std::int64_t least, std::int64_t most) override;
    /// Of --name and --no-name.
    std::optional<bool> flag(std::string_view name) override;
    std::optional<std::string> text(std::string_view name) override;
    std::vector<double> list(std::string_view name, char separator = ',') override;
    std::vector<std::string> texts(std::string_view name) override;
    bool says(std::string_view name, std::string_view word) override { return text(name) == word; }
    bool given(std::string_view name) const override;
    std::string called(std::string_view name) const override;
    [[noreturn]] void fail(std::string_view name, std::string_view expected) const override;
    [[noreturn]] void refuse(std::string_view name, std::string_view expected) const override;

private:
    const CLI::App* app_;
};

/// Declares options of one heading, for such a source.
class Declarations {
public:
    Declarations(CLI::App& app, const char* group) : app_(app), group_(group) {}

    /// An option with one value.
    CLI::Option* operator()(const char* name, const char* type, const std::string& help) const;
    /// The same, and it may be given again for more.
    CLI::Option* several(const char* name, const char* type, const std::string& help) const;
    /// "--bed,!--no-bed", or one of them.
    CLI::Option* flag(const char* names, const std::string& help) const;

private:
    CLI::App& app_;
    const char* group_;
};

}  // namespace stratum::tools
