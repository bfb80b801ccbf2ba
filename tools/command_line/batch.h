// Several inputs in one run: what one of them does wrong doesn't stop the others.
#pragma once

#include "command_line.h"

#include <functional>
#include <string>
#include <vector>

namespace stratum::tools {

/// Collects what fails, says it at once on stderr, and ends the run with it when all is done.
class Batch {
public:
    /// @param tool  its name, for messages
    Batch(std::string tool, std::size_t count) : tool_(std::move(tool)), count_(count) {}

    /// Does the work on one input. If that is the only one, its exceptions pass; else they are told and kept, and the
    /// result is false.
    bool attempt(const std::string& input, const std::function<void()>& work);

    /// What failed, for --stats: the input, the message and the exit status.
    const nlohmann::ordered_json& failures() const { return failures_; }

    /// Throws BatchFailure if anything has failed.
    void finish() const;

private:
    std::string tool_;
    std::size_t count_;
    int worst_ = 0;
    std::string last_message_;
    std::vector<std::string> failed_;
    nlohmann::ordered_json failures_ = nlohmann::ordered_json::array();
};

}  // namespace stratum::tools
