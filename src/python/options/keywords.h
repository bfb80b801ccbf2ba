// Keyword arguments of a function, read one by one, with errors that say which.
#pragma once

#include "base/options/option_source.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::python {

/// Every name that is asked for is known; finish() refuses all others. None counts as not given. Values of a wrong type
/// throw TypeError, numbers that are not finite UsageError, both with the name. Needs the GIL.
class Keywords final : public OptionSource {
public:
    /// `function`: its name, for messages.
    Keywords(std::string function, const pybind11::kwargs& given) : function_(std::move(function)), given_(&given) {}

    /// The value, or nothing if it is not given.
    std::optional<pybind11::object> find(std::string_view name);
    std::optional<double> number(std::string_view name) override;
    std::optional<std::int64_t> integer(std::string_view name, std::int64_t least, std::int64_t most) override;
    std::optional<bool> flag(std::string_view name) override;
    /// Also of a path object.
    std::optional<std::string> text(std::string_view name) override;
    std::vector<double> list(std::string_view name, char separator = ',') override;
    std::vector<std::string> texts(std::string_view name) override;
    bool says(std::string_view name, std::string_view word) override;
    bool given(std::string_view name) const override;
    std::string called(std::string_view name) const override;
    /// Throws TypeError.
    [[noreturn]] void fail(std::string_view name, std::string_view expected) const override;
    /// Throws UsageError.
    [[noreturn]] void refuse(std::string_view name, std::string_view expected) const override;

    /// Names that were asked for until now, in that order; those among them that are given.
    const std::vector<std::string>& known() const { return known_; }
    const std::vector<std::string>& found() const { return found_; }
    /// Throws TypeError for names that nobody asked for, with the known one that is most like it.
    void finish() const;
    const std::string& function() const { return function_; }

private:
    double finite(std::string_view name, const pybind11::handle& value) const;

    std::string function_;
    const pybind11::kwargs* given_;
    std::vector<std::string> known_, found_;
};

/// One text, or several, of a parameter that is no keyword of such; none for None.
std::vector<std::string> textsOf(const std::string& function, const char* name, const pybind11::object& value);

}  // namespace stratum::python
