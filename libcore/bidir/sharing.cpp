#include "libcore/bidir/sharing.h"

#include "libcore/bidir/full_path.h"

namespace lacuna {

int sharedEdge(const FullPath& path) {
    int i = path.edges - 1;
    while (i > 1 && path.delta[std::size_t(i)]) --i;
    if (i < 2 || path.delta[std::size_t(i) - 1]) return 0;
    return forks(*path.vertex[std::size_t(i)]) && mayBeShared(*path.vertex[std::size_t(i) - 1]) ? i
                                                                                                : 0;
}

}  // namespace lacuna
