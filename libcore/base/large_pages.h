// Memory for large arrays that are read in no order. The system is asked for large pages, of which the
// processor remembers enough to find most addresses at once, and which come faster than small ones.
#pragma once

#include <cstddef>
#include <limits>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace lacuna {

/// Allocator of a std::vector. Throws std::bad_alloc if there is no such memory.
template <class T>
struct LargePages {
    using value_type = T;

    LargePages() = default;
    template <class U>
    LargePages(const LargePages<U>&) {}

    T* allocate(std::size_t n) {
        if (n > std::numeric_limits<std::size_t>::max() / sizeof(T))
            throw std::bad_array_new_length();
        const std::size_t bytes = n * sizeof(T);
        void* memory = ::operator new(bytes, alignmentOf(bytes));
#if defined(__linux__)
        // Only advice: if the system does not take it, the pages are small.
        if (bytes >= kPage) ::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t n) {
        ::operator delete(memory, alignmentOf(n * sizeof(T)));
    }
    bool operator==(const LargePages&) const = default;

  private:
    static constexpr std::size_t kPage = std::size_t(1) << 21;
    static std::align_val_t alignmentOf(std::size_t bytes) {
        return std::align_val_t(bytes >= kPage ? kPage : alignof(T));
    }
};

}  // namespace lacuna
