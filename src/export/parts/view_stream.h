// A stream that reads bytes in memory without copying them.
#pragma once

#include <istream>
#include <streambuf>
#include <string_view>

namespace stratum::exporter {

class ViewStream : private std::streambuf, public std::istream {
public:
    /// The bytes must outlive it.
    explicit ViewStream(std::string_view bytes) : std::istream(this) {
        char* const first = const_cast<char*>(bytes.data());  // a stream for reading writes nothing
        setg(first, first, first + bytes.size());
    }

private:
    std::streampos seekoff(std::streamoff offset, std::ios_base::seekdir from,
                           std::ios_base::openmode /*which*/) override {
        char* const base = from == std::ios_base::beg ? eback() : from == std::ios_base::cur ? gptr() : egptr();
        if (offset < eback() - base || offset > egptr() - base) return std::streampos(std::streamoff(-1));
        setg(eback(), base + offset, egptr());
        return std::streampos(gptr() - eback());
    }
    std::streampos seekpos(std::streampos place, std::ios_base::openmode which) override {
        return seekoff(std::streamoff(place), std::ios_base::beg, which);
    }
};

}  // namespace stratum::exporter
