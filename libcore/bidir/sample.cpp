#include "libcore/bidir/sample.h"

namespace lacuna {

std::string Sample::address(int filmWidth) const {
    const auto width = std::uint64_t(filmWidth);
    const std::string place =
        ofLight ? "light:" + std::to_string(number)
                : std::to_string(number % width) + "," + std::to_string(number / width);
    return place + "," + std::to_string(iteration);
}

}  // namespace lacuna
