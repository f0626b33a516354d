#include "render/live/live_view.h"

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lacuna {
namespace {

constexpr auto kLook = std::chrono::milliseconds(500);  // interval of checks for the viewer

/// CPU time of the calling thread.
std::chrono::duration<double> threadTime() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return std::chrono::duration<double>(double(t.tv_sec) + 1e-9 * double(t.tv_nsec));
}

std::chrono::steady_clock::duration inTicks(std::chrono::duration<double> seconds) {
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(seconds);
}

std::string secondsText(std::chrono::duration<double> seconds) {
    char text[32];
    std::snprintf(text, sizeof text, "%g s", seconds.count());
    return text;
}

}  // namespace

LiveView::LiveView(ServerAddress server, TevImage image, Tell tell)
    : LiveView(std::move(server), std::move(image), std::move(tell), Timing()) {}

LiveView::LiveView(ServerAddress server, TevImage image, Tell tell, const Timing& timing)
    : server_(std::move(server)),
      image_(std::move(image)),
      tell_(std::move(tell)),
      timing_(timing),
      thread_([this] { run(); }) {}

LiveView::~LiveView() {
    end(Seconds(0.0));
}

bool LiveView::wants() const {
    const std::lock_guard lock(mutex_);
    return asking_ && Clock::now() >= due_;
}

void LiveView::show(LayeredImage picture, Seconds cost) {
    {
        const std::lock_guard lock(mutex_);
        next_ = std::move(picture);
        asking_ = false;
        due_ = Clock::now() + inTicks(std::max(timing_.every, cost / timing_.share));
    }
    wake_.notify_all();
}

void LiveView::showLast(LayeredImage picture) {
    {
        const std::lock_guard lock(mutex_);
        next_ = std::move(picture);
        last_ = true;
    }
    wake_.notify_all();
}

void LiveView::leave() {
    end(timing_.farewell);
    if (unsent_) {
        tell_("warning: --display-server: expected tev to take the last picture within " +
              secondsText(timing_.farewell) + ", found it did not; open the file that is written");
    }
}

void LiveView::end(Seconds wait) {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        end_ = Clock::now() + inTicks(wait);
    }
    wake_.notify_all();
    thread_.join();
}

bool LiveView::goOn() const {
    const std::lock_guard lock(mutex_);
    return !end_ || Clock::now() < *end_;
}

bool LiveView::superseded() const {
    const std::lock_guard lock(mutex_);
    return next_.has_value();
}

void LiveView::run() {
    while (goOn()) {
        if (std::optional<TcpConnection> connection = connect()) serve(*connection);
        if (!pause()) return;
    }
}

/// Connects and creates the image; empty if no viewer answers.
std::optional<TcpConnection> LiveView::connect() {
    const auto patient = [this] { return goOn(); };
    try {
        TcpConnection connection(server_, timing_.connect, patient);
        connection.send(createImage(image_), timing_.stall, patient);
        return connection;
    } catch (const std::exception& e) {
        if (!std::exchange(toldMissing_, true)) {
            tell_("warning: --display-server: expected tev at " + server_.text() +
                  ", found: " + e.what() + "; start it, it is looked for every " +
                  secondsText(timing_.again) + " (the render goes on)");
        }
        return std::nullopt;
    }
}

/// Sends pictures as long as the viewer stays and there are any.
void LiveView::serve(TcpConnection& connection) {
    try {
        while (const std::optional<LayeredImage> picture = nextPicture(connection)) {
            send(connection, *picture);
        }
    } catch (const std::exception& e) {
        unsent_ = !goOn();
        if (unsent_ || std::exchange(toldLost_, true)) return;
        tell_("warning: --display-server: expected tev to stay at " + server_.text() +
              ", found: " + e.what() + "; it is looked for every " + secondsText(timing_.again) +
              " (the render goes on)");
    }
}

/// Waits for the next picture. Empty if there will be none; throws if the viewer goes away
/// meanwhile.
std::optional<LayeredImage> LiveView::nextPicture(const TcpConnection& connection) {
    std::unique_lock lock(mutex_);
    asking_ = !next_ && !last_;
    while (!next_ && !last_ && !end_) {
        wake_.wait_for(lock, kLook);
        if (!next_ && connection.closed()) {
            asking_ = false;
            throw std::runtime_error("it has closed the connection");
        }
    }
    asking_ = false;
    return std::exchange(next_, std::nullopt);
}

/// Sends a picture tile by tile. Stops early if there is a newer picture.
void LiveView::send(TcpConnection& connection, const LayeredImage& picture) {
    const Seconds before = threadTime();
    const std::vector<float> black(std::size_t(image_.width) * std::size_t(image_.height));
    std::vector<const std::vector<float>*> planes;
    for (const std::string& channel : image_.channels) {
        const std::vector<float>* plane = picture.find(channel);
        planes.push_back(plane ? plane : &black);
    }
    for (const PixelRect& tile : tilesOf(image_)) {
        if (superseded()) return;
        connection.send(updateImage(image_, tile, planes), timing_.stall,
                        [this] { return goOn(); });
    }
    const std::lock_guard lock(mutex_);
    due_ += inTicks((threadTime() - before) / timing_.share);
}

/// Waits until the next attempt to connect. False if the render is over.
bool LiveView::pause() {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, timing_.again, [this] { return last_ || end_; });
    return !last_ && !end_;
}

}  // namespace lacuna
