#include "render/grace.h"

namespace lacuna {

Grace::Grace(const std::atomic<bool>& interrupted, std::atomic<bool>& over)
    : interrupted_(interrupted), over_(over), thread_([this] { watch(); }) {}

Grace::~Grace() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void Grace::watch() {
    constexpr auto kLook = std::chrono::milliseconds(50);
    constexpr auto kGrace = std::chrono::seconds(3);
    std::unique_lock lock(mutex_);
    const auto stopped = [this] { return stop_; };
    while (!interrupted_) {
        if (wake_.wait_for(lock, kLook, stopped)) return;
    }
    if (!wake_.wait_for(lock, kGrace, stopped)) over_ = true;
}

}  // namespace lacuna
