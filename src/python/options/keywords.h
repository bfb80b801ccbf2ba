// Keyword arguments of a function, read one by one, with errors that say which.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::python {

/// Every name that is asked for is known; finish() refuses all others. None counts as not given. Values of a wrong type
/// throw TypeError, numbers that are not finite UsageError, both with the name. Needs the GIL.
class Keywords {
public:
    /// `function`: its name, for messages.
    Keywords(std::string function, const pybind11::kwargs& given) : function_(std::move(function)), given_(given) {}

    /// The value, or nothing if it is not given.
    std::optional<pybind11::object> find(std::string_view name);
    std::optional<double> number(std::string_view name);
    std::optional<double> number(std::string_view name, double least, double most);
    std::optional<int> integer(std::string_view name, int least, int most);
    std::optional<bool> flag(std::string_view name);
    /// Also of a path object.
    std::optional<std::string> text(std::string_view name);
    std::optional<glm::dvec3> point(std::string_view name);
    /// One number, or several.
    std::vector<double> numbers(std::string_view name);
    /// One text, or several.
    std::vector<std::string> texts(std::string_view name);

    /// One of the values that have names.
    template <typename Choice, std::size_t N>
    std::optional<Choice> choice(std::string_view name, const std::array<std::pair<std::string_view, Choice>, N>& all) {
        const std::optional<std::string> given = text(name);
        if (!given) return std::nullopt;
        std::vector<std::string_view> names;
        for (const auto& [known, value] : all) {
            if (known == *given) return value;
            names.push_back(known);
        }
        refuseChoice(name, *given, names);
    }

    /// Names of the values that were found until now, in that order.
    const std::vector<std::string>& found() const { return found_; }
    /// Throws TypeError for names that nobody asked for, with the known one that is most like it.
    void finish() const;
    const std::string& function() const { return function_; }
    [[noreturn]] void fail(std::string_view name, std::string_view expected) const;

private:
    [[noreturn]] void refuseChoice(std::string_view name, const std::string& given,
                                   std::span<const std::string_view> names) const;
    double finite(std::string_view name, const pybind11::handle& value) const;

    std::string function_;
    const pybind11::kwargs& given_;
    std::vector<std::string> known_, found_;
};

/// Sets a value that is given.
template <typename To, typename From>
void assign(To& to, const std::optional<From>& from) {
    if (from) to = *from;
}

}  // namespace stratum::python
