// --display-server: the picture as it is, in tev, beside the render. The viewer is asked for
// nothing and may do anything: be missing, come later, hang, go away.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "libcore/image/image.h"
#include "render/live/tcp_connection.h"
#include "render/live/tev_packets.h"

namespace lacuna {

/// A thread of its own sends one picture after the other. It asks for the next one once the last is
/// through, so that there is never more than one under way, and none is made for nobody.
class LiveView {
  public:
    using Seconds = std::chrono::duration<double>;
    struct Timing {
        Seconds connect{2.0};   ///< for a connection to come about
        Seconds again{2.0};     ///< between two attempts
        Seconds stall{20.0};    ///< a viewer that takes nothing for so long is left
        Seconds every{0.25};    ///< between two pictures, at least
        double share = 0.01;    ///< of the time, for making and sending them, at most
        Seconds farewell{2.0};  ///< for the last picture
    };
    /// Says a line to the user; called from any thread.
    using Tell = std::function<void(const std::string&)>;

    LiveView(ServerAddress server, TevImage image, Tell tell);
    LiveView(ServerAddress server, TevImage image, Tell tell, const Timing& timing);
    /// Waits for nothing.
    ~LiveView();
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    /// Whether a viewer is there, and it is time for a new picture.
    bool wants() const;
    /// Of the image's size and with its channels, at least; a channel that is missing is black.
    /// `cost`: what making it took. Does not wait.
    void show(LayeredImage picture, Seconds cost);
    /// The last one, even if nobody has asked: whatever is being sent gives way to it.
    void showLast(LayeredImage picture);
    /// Waits until the last picture is sent, a bounded time. Nothing is sent after that.
    void leave();

  private:
    using Clock = std::chrono::steady_clock;

    void run();
    std::optional<TcpConnection> connect();
    void serve(TcpConnection& connection);
    std::optional<LayeredImage> nextPicture(const TcpConnection& connection);
    void send(TcpConnection& connection, const LayeredImage& picture);
    bool pause();
    bool goOn() const;
    bool superseded() const;
    void end(Seconds wait);

    const ServerAddress server_;
    const TevImage image_;
    const Tell tell_;
    const Timing timing_;

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool asking_ = false;  ///< connected, and nothing to send
    std::optional<LayeredImage> next_;
    Clock::time_point due_{};  ///< not before this
    bool last_ = false;        ///< `next_`, or what is being sent, is the last picture
    std::optional<Clock::time_point> end_;
    // Of the thread, until it has ended.
    bool unsent_ = false;  ///< a viewer was there, but has not taken the last picture
    bool toldMissing_ = false, toldLost_ = false;
    std::thread thread_;
};

}  // namespace lacuna
