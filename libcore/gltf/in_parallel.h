// Work on many parts of a file at once.
#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>
#include <exception>
#include <vector>

namespace lacuna::gltf {

/// Calls work(item) for each of `items`, with tbb::parallel_for in the caller's arena. Then throws the
/// error of the first item that has one: which thread met one first must not decide which the user sees.
template <class Item, class Work>
void inParallel(std::vector<Item>& items, const Work& work) {
    std::vector<std::exception_ptr> errors(items.size());
    tbb::parallel_for(std::size_t(0), items.size(), [&](std::size_t i) {
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
