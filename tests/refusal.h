// What is thrown, for tests of refusals.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace stratum::test {

/// What the Error that `work` throws says; `otherwise` if it throws none.
template <typename Error, typename Work>
std::string messageOf(const Work& work, std::string otherwise = {}) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return otherwise;
}

/// Whether `work` throws an Error that says this.
template <typename Error, typename Work>
testing::AssertionResult refuses(std::string_view part, const Work& work) {
    const std::string message = messageOf<Error>(work, "not refused");
    return (message.find(part) != std::string::npos ? testing::AssertionSuccess() : testing::AssertionFailure())
           << message;
}

}  // namespace stratum::test
