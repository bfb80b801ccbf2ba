// Who may talk to a local server: the token of its URL, and what browsers say of where a request comes from.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::serve {

/// 128 random bits of the system as 32 hexadecimal digits.
std::string randomToken();

/// Compares in a time that depends on the lengths alone.
bool equalSecrets(std::string_view a, std::string_view b);

/// Guards a server at one port. Pages of other sites can send requests to it, also by a name of their own that leads
/// to its address (DNS rebinding): their Host and Origin give them away.
class Access {
public:
    /// @param hosts  names or addresses by which the server is called, without a port; IPv6 addresses in brackets
    /// @param named  further ones, behind a proxy say: "name" is that host at the usual ports, which browsers leave
    /// out,
    ///               and at `port`; "name:8443" is that host at that port
    Access(std::string token, const std::vector<std::string>& hosts, std::uint16_t port,
           const std::vector<std::string>& named = {});

    const std::string& token() const { return token_; }
    /// Of the header Host: one of the hosts with its port.
    bool knownHost(std::string_view host) const;
    /// Of the header Origin of a web socket: the page of this very server, under the host that it was called by; a
    /// proxy may have encrypted what came under a further name.
    bool ownOrigin(std::string_view origin, std::string_view host) const;
    /// What follows "/TOKEN/" in the target of a request, without its query; false if the token is another.
    bool below(std::string_view target, std::string_view& rest) const;

private:
    std::string token_;
    std::vector<std::string> hosts_, named_;  // with their ports
};

}  // namespace stratum::serve
