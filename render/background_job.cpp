#include "render/background_job.h"

#include <exception>
#include <utility>

namespace lacuna {

BackgroundJob::BackgroundJob(double seconds) : every_(seconds) {}

BackgroundJob::~BackgroundJob() {
    wait();
}

bool BackgroundJob::idle() const {
    return !doing_.valid() || doing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

bool BackgroundJob::due() const {
    return idle() && Clock::now() - last_ >= every_;
}

void BackgroundJob::begin(std::function<void()> work) {
    last_ = Clock::now();
    doing_ = std::async(std::launch::async, std::move(work));
}

void BackgroundJob::wait() {
    if (doing_.valid()) doing_.wait();
}

std::optional<std::string> BackgroundJob::failure() {
    if (!doing_.valid() || !idle()) return std::nullopt;
    try {
        doing_.get();
        told_ = false;
    } catch (const std::exception& e) {
        if (!std::exchange(told_, true)) return e.what();
    }
    return std::nullopt;
}

}  // namespace lacuna
