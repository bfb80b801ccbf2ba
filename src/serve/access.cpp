#include "serve/access.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>
#include <utility>

namespace stratum::serve {
namespace {

// Host names are of any case.
bool equalNames(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&lower](char x, char y) { return lower(x) == lower(y); });
}

bool isAmong(const std::vector<std::string>& names, std::string_view name) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& known) { return equalNames(known, name); });
}

}  // namespace

std::string randomToken() {
    std::array<unsigned char, 16> bytes{};
    if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        throw std::system_error(errno, std::generic_category(), "getrandom");
    std::string token;
    for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

bool equalSecrets(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    unsigned difference = 0;
    for (std::size_t n = 0; n < a.size(); ++n)
        difference |= static_cast<unsigned>(static_cast<unsigned char>(a[n]) ^ static_cast<unsigned char>(b[n]));
    return difference == 0;
}

Access::Access(std::string token, const std::vector<std::string>& hosts, std::uint16_t port,
               const std::vector<std::string>& named)
    : token_(std::move(token)) {
    constexpr std::uint16_t kHttp = 80;  // which clients leave out
    for (const std::string& host : hosts) {
        hosts_.push_back(fmt::format("{}:{}", host, port));
        if (port == kHttp) hosts_.push_back(host);
    }
    for (const std::string& host : named) {
        named_.push_back(host);
        named_.push_back(fmt::format("{}:{}", host, port));
    }
}

bool Access::knownHost(std::string_view host) const { return isAmong(hosts_, host) || isAmong(named_, host); }

bool Access::ownOrigin(std::string_view origin, std::string_view host) const {
    constexpr std::string_view kPlain = "http://", kEncrypted = "https://";
    if (origin.starts_with(kPlain)) return equalNames(origin.substr(kPlain.size()), host) && knownHost(host);
    return origin.starts_with(kEncrypted) && equalNames(origin.substr(kEncrypted.size()), host) &&
           isAmong(named_, host);
}

bool Access::below(std::string_view target, std::string_view& rest) const {
    target = target.substr(0, target.find('?'));
    if (!target.starts_with('/')) return false;
    target.remove_prefix(1);
    const std::size_t end = target.find('/');
    if (end == std::string_view::npos || !equalSecrets(target.substr(0, end), token_)) return false;
    rest = target.substr(end + 1);
    return true;
}

}  // namespace stratum::serve
