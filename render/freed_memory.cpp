#include "render/freed_memory.h"

#include <climits>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace lacuna {

void keepFreedMemory() {
#if defined(__GLIBC__)
    mallopt(M_MMAP_THRESHOLD, INT_MAX);
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
#endif
}

void returnFreedMemory() {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

}  // namespace lacuna
