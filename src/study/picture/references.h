// Pictures with many samples, which others are compared with.
#pragma once

#include "study/picture/render_plan.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace stratum::study {

/// Made when first asked for, and kept in files for later runs. Not for several threads.
class References {
public:
    /// @param origin  of what print and size: files of another are made again
    /// @param spp  samples a pixel
    /// Throws OutputError if the folder can't be made.
    References(std::filesystem::path folder, std::string origin, int spp, PictureSubject& subject);

    const shade::Film& of(const Reference& reference);
    /// Writes a picture for the page; its file.
    std::filesystem::path show(const std::string& name, const shade::Film& film) const;

private:
    std::string describe(const std::string& name) const;
    std::filesystem::path fileOf(std::string name, const char* extension) const;
    std::optional<shade::Film> fromFile(const std::string& name) const;

    std::filesystem::path folder_;
    std::string origin_;
    int spp_;
    PictureSubject& subject_;
    std::map<std::string, std::optional<shade::Film>> films_;
};

}  // namespace stratum::study
