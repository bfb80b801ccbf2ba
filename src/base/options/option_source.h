// Options by name, wherever they are given: on a command line, in a scene file, as keywords of Python.
#pragma once

#include "base/names.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stratum {

/// One reader asks for options by the names that Python has, and each place of options gives what it holds. An option
/// that is not there is nullopt, or an empty list. Values of a wrong kind and numbers that are not finite are refused
/// in the words of that place. Not for several threads at once.
class OptionSource {
public:
    OptionSource() = default;
    OptionSource(const OptionSource&) = default;
    OptionSource& operator=(const OptionSource&) = default;
    virtual ~OptionSource() = default;

    virtual std::optional<double> number(std::string_view name) = 0;
    /// Throws if it is not in [least, most].
    virtual std::optional<std::int64_t> integer(std::string_view name, std::int64_t least, std::int64_t most) = 0;
    virtual std::optional<bool> flag(std::string_view name) = 0;
    virtual std::optional<std::string> text(std::string_view name) = 0;
    /// One number, or several.
    /// @param separator  between the numbers of a text
    virtual std::vector<double> list(std::string_view name, char separator = ',') = 0;
    /// One text, or several.
    virtual std::vector<std::string> texts(std::string_view name) = 0;

    /// Whether the value is this text, where another is no text.
    virtual bool says(std::string_view name, std::string_view word) = 0;

    virtual bool given(std::string_view name) const = 0;
    /// How people call the option there.
    virtual std::string called(std::string_view name) const = 0;
    /// The value has a wrong kind or form.
    [[noreturn]] virtual void fail(std::string_view name, std::string_view expected) const = 0;
    /// The value is of the right kind, but none that is possible.
    [[noreturn]] virtual void refuse(std::string_view name, std::string_view expected) const = 0;

    std::optional<double> numberIn(std::string_view name, double least, double most);
    /// As many numbers as one of `counts`.
    std::vector<double> numbersOf(std::string_view name, std::initializer_list<std::size_t> counts,
                                  std::string_view expected, char separator = ',');
    /// Whole numbers of at most 1e9, as many as `count`.
    std::vector<int> integersOf(std::string_view name, std::size_t count, std::string_view expected,
                                char separator = ',');
    std::optional<glm::dvec3> point(std::string_view name);

    /// One of the values that have names.
    template <typename Value, std::size_t N>
    std::optional<Value> choice(std::string_view name, const Names<Value, N>& names) {
        const std::optional<std::string> given = text(name);
        if (!given) return std::nullopt;
        if (const std::optional<Value> value = valueOf(names, *given)) return value;
        refuse(name, oneOf(*given, listOf(names)));
    }

private:
    static std::string oneOf(std::string_view given, std::span<const std::string_view> names);
};

/// Sets a value that is given.
template <typename To, typename From>
void assign(To& to, const std::optional<From>& from) {
    if (from) to = static_cast<To>(*from);
}

}  // namespace stratum
