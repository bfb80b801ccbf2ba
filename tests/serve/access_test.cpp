#include "serve/access.h"

#include <gtest/gtest.h>

#include <set>

namespace stratum::serve {
namespace {

TEST(Access, TokensAreLongAndDiffer) {
    std::set<std::string> tokens;
    for (int n = 0; n < 100; ++n) tokens.insert(randomToken());
    EXPECT_EQ(tokens.size(), 100U);
    EXPECT_EQ(tokens.begin()->size(), 32U);
}

TEST(Access, SecretsAreComparedWhole) {
    EXPECT_TRUE(equalSecrets("abc", "abc"));
    EXPECT_FALSE(equalSecrets("abc", "abd"));
    EXPECT_FALSE(equalSecrets("abc", "ab"));
    EXPECT_FALSE(equalSecrets("", "a"));
}

TEST(Access, OnlyBelowTheToken) {
    const Access access("0123", {"127.0.0.1"}, 80);
    std::string_view rest;
    EXPECT_TRUE(access.below("/0123/main.js?x=1", rest));
    EXPECT_EQ(rest, "main.js");
    EXPECT_TRUE(access.below("/0123/", rest));
    EXPECT_EQ(rest, "");
    for (const char* target :
         {"/", "", "/0123", "/0124/", "//0123/", "/01234/", "http://127.0.0.1/0123/", "/?/0123/"}) {
        SCOPED_TRACE(target);
        EXPECT_FALSE(access.below(target, rest));
    }
}

// Browsers leave the default port out (RFC 9110, 4.2.1 and 7.2).
TEST(Access, ThePortOfHttpMayBeLeftOut) {
    const Access access("0123", {"127.0.0.1"}, 80);
    EXPECT_TRUE(access.knownHost("127.0.0.1"));
    EXPECT_TRUE(access.knownHost("127.0.0.1:80"));
    EXPECT_TRUE(access.ownOrigin("http://127.0.0.1", "127.0.0.1"));
    EXPECT_FALSE(access.knownHost("example.org"));
}

TEST(Access, OnlyTheOwnHostsAndPages) {
    const Access access("0123", {"127.0.0.1", "localhost", "[::1]"}, 8080);
    EXPECT_TRUE(access.knownHost("LOCALHOST:8080"));
    EXPECT_TRUE(access.knownHost("[::1]:8080"));
    for (const char* host : {"", "localhost", "localhost:80", "evil.example:8080", "127.0.0.1:8080.evil.example"})
        EXPECT_FALSE(access.knownHost(host)) << host;
    EXPECT_TRUE(access.ownOrigin("http://127.0.0.1:8080", "127.0.0.1:8080"));
    for (const char* origin : {"", "null", "http://evil.example", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
                               "http://localhost:8080", "http://127.0.0.1:8080/"})
        EXPECT_FALSE(access.ownOrigin(origin, "127.0.0.1:8080")) << origin;
    EXPECT_FALSE(access.ownOrigin("http://evil.example:8080", "evil.example:8080"));
}

// A browser leaves the usual ports out of Host and Origin, and a proxy has a port of its own.
TEST(Access, NamesBehindAProxy) {
    const Access access("0123", {"127.0.0.1"}, 8080, {"prints.example", "lab.example:8443"});
    for (const char* host : {"prints.example", "PRINTS.example:8080", "lab.example:8443"}) {
        SCOPED_TRACE(host);
        EXPECT_TRUE(access.knownHost(host));
        EXPECT_TRUE(access.ownOrigin(std::string("http://") + host, host));
        EXPECT_TRUE(access.ownOrigin(std::string("https://") + host, host));
    }
    for (const char* host : {"prints.example:81", "lab.example", "127.0.0.1"})
        EXPECT_FALSE(access.knownHost(host)) << host;
    EXPECT_FALSE(access.ownOrigin("https://127.0.0.1:8080", "127.0.0.1:8080"));
}

}  // namespace
}  // namespace stratum::serve
