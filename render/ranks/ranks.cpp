#include "render/ranks/ranks.h"

#include <chrono>
#include <thread>

namespace lacuna {

std::string Ranks::name(int rank) const {
    return "rank " + std::to_string(rank) + " (" + machines_[std::size_t(rank)] + ")";
}

void Ranks::send(int to, Tag tag, const std::string& text) const {
    send(to, tag, std::as_bytes(std::span(text.data(), text.size())));
}

Ranks::Letter Ranks::wait() const {
    for (;;) {
        if (std::optional<Letter> letter = poll()) return std::move(*letter);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

std::string textOf(const Ranks::Letter& letter) {
    return {reinterpret_cast<const char*>(letter.bytes.data()), letter.bytes.size()};
}

}  // namespace lacuna
