// Parallel work on many parts of a file.
#pragma once

#include <cstddef>
#include <exception>
#include <vector>

#include "libcore/base/tbb_loop.h"

namespace lacuna::gltf {

/// Calls work(item) for each of `items`, in the caller's arena of oneTBB. Then throws the error of the first item that
/// has one: the order of threads must not decide which error the user sees.
template <class Item, class Work>
void inParallel(std::vector<Item>& items, const Work& work) {
    std::vector<std::exception_ptr> errors(items.size());
    tbbLoop(items.size(), [&](std::size_t i) {
        try {
            work(items[i]);
        } catch (...) {
            errors[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

}  // namespace lacuna::gltf
