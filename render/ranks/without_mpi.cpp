// Build without MPI: every process is alone.
#include "render/ranks/ranks.h"

namespace lacuna {

Ranks::Ranks() = default;
Ranks::~Ranks() = default;

bool Ranks::agree(const std::function<void()>& stage) const {
    stage();
    return true;
}

void Ranks::send(int, Tag, std::span<const std::byte>) const {}

std::optional<Ranks::Letter> Ranks::poll() const {
    return std::nullopt;
}

}  // namespace lacuna
