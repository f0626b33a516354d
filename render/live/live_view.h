// --display-server: shows the current picture in the viewer tev during the render. The viewer may
// be missing, come later, hang or go away.
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

/// A thread sends one picture after the other. It requests the next picture when the last one has
/// been sent, so that at most one is in flight and none is made without a viewer.
class LiveView {
  public:
    using Seconds = std::chrono::duration<double>;
    struct Timing {
        Seconds connect{2.0};   ///< limit of time to connect
        Seconds again{2.0};     ///< between two attempts
        Seconds stall{20.0};    ///< a viewer that accepts no data for this long is dropped
        Seconds every{0.25};    ///< least time between two pictures
        double share = 0.01;    ///< largest share of time for making and sending them
        Seconds farewell{2.0};  ///< limit of time for the last picture
    };
    /// Prints a line for the user; called from any thread.
    using Tell = std::function<void(const std::string&)>;

    LiveView(ServerAddress server, TevImage image, Tell tell);
    LiveView(ServerAddress server, TevImage image, Tell tell, const Timing& timing);
    /// Ends at once, without waiting for pictures to be sent.
    ~LiveView();
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    /// Whether a viewer is connected and it is time for a new picture.
    bool wants() const;
    /// Hands over a picture of the image's size and with its channels; missing channels are black.
    /// `cost`: time to make it. Does not wait.
    void show(LayeredImage picture, Seconds cost);
    /// Hands over the last picture, even if none was requested. It replaces a picture that is being
    /// sent.
    void showLast(LayeredImage picture);
    /// Waits until the last picture is sent, for a bounded time. Nothing is sent afterwards.
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
    bool asking_ = false;  ///< connected, with nothing to send
    std::optional<LayeredImage> next_;
    Clock::time_point due_{};  ///< earliest time of the next picture
    bool last_ = false;        ///< the last picture has been handed over
    std::optional<Clock::time_point> end_;
    // Used by the thread only, until it has ended.
    bool unsent_ = false;  ///< a viewer was connected but did not get the last picture
    bool toldMissing_ = false, toldLost_ = false;
    std::thread thread_;
};

}  // namespace lacuna
