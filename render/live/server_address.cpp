#include "render/live/server_address.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "libcore/base/error.h"

namespace lacuna {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

bool consistsOf(std::string_view text, std::string_view marks) {
    return std::ranges::all_of(text, [&](char c) {
        return kDigits.find(c) != kDigits.npos || kLetters.find(c) != kLetters.npos ||
               marks.find(c) != marks.npos;
    });
}

std::optional<std::uint16_t> portOf(std::string_view text) {
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size() || port == 0) return std::nullopt;
    return port;
}

/// Removes the host from the front of `text`; empty if there is no valid one.
std::optional<std::string> takeHost(std::string_view& text) {
    const bool bracketed = text.starts_with('[');
    const std::size_t end = bracketed ? text.find(']') : std::min(text.find(':'), text.size());
    if (end == text.npos) return std::nullopt;
    const std::string_view host = bracketed ? text.substr(1, end - 1) : text.substr(0, end);
    text.remove_prefix(bracketed ? end + 1 : end);
    // An IPv6 address may name its interface: fe80::1%eth0.
    const bool sound = bracketed ? host.find(':') != host.npos && consistsOf(host, ":.%-_")
                                 : consistsOf(host, ".-_");
    if (!sound) return std::nullopt;
    return std::string(host);
}

std::optional<ServerAddress> addressOf(std::string_view text) {
    ServerAddress address;
    if (text.empty()) return std::nullopt;
    const std::optional<std::string> host = takeHost(text);
    if (!host) return std::nullopt;
    if (!host->empty()) address.host = *host;
    if (text.empty()) return address;
    if (text.front() != ':') return std::nullopt;
    const std::optional<std::uint16_t> port = portOf(text.substr(1));
    if (!port) return std::nullopt;
    address.port = *port;
    return address;
}

}  // namespace

std::string ServerAddress::text() const {
    const bool brackets = host.find(':') != host.npos;
    return (brackets ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

ServerAddress parseServerAddress(const std::string& option, const std::string& text) {
    if (const std::optional<ServerAddress> address = addressOf(text)) return *address;
    throw UsageError(option +
                     ": expected where tev listens, such as localhost:14158, :14158, host or "
                     "[::1]:14158, with a port from 1 to 65535, found '" +
                     text + "'");
}

}  // namespace lacuna
