// The address at which a viewer listens.
#pragma once

#include <cstdint>
#include <string>

namespace lacuna {

struct ServerAddress {
    std::string host = "localhost";
    std::uint16_t port = 14158;  ///< default of tev

    /// The address in the form of the command line.
    std::string text() const;
    friend bool operator==(const ServerAddress&, const ServerAddress&) = default;
};

/// Parses "host:port", "host", ":port", "[::1]:port" or "[::1]". Throws UsageError, which names
/// `option`.
ServerAddress parseServerAddress(const std::string& option, const std::string& text);

}  // namespace lacuna
