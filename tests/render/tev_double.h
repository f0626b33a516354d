// A stand-in for tev: listens and records what it receives. Its decoder follows tev's own and
// shares no code with the sender.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace lacuna::test {

class TevDouble {
  public:
    enum class Manner {
        Reads,
        NeverReads,   ///< accepts connections but reads nothing, until `setManner`
        LeavesEarly,  ///< closes its first connection in the middle of a tile
        Absent,       ///< refuses connections, until `setManner`
    };
    explicit TevDouble(Manner manner = Manner::Reads);
    ~TevDouble();
    TevDouble(const TevDouble&) = delete;
    TevDouble& operator=(const TevDouble&) = delete;

    void setManner(Manner manner);
    std::uint16_t port() const { return port_; }

    struct Picture {
        int width = 0, height = 0;
        std::map<std::string, std::vector<float>> channels;
        int updates = 0;     ///< tiles
        bool whole = false;  ///< every pixel has been updated since it was created
    };
    struct State {
        std::map<std::string, Picture> pictures;  ///< by name
        int connections = 0, created = 0;
        std::string fault;  ///< the first packet error that tev would report
    };
    State state() const;
    /// Waits for a state; false if it does not come about in a generous time.
    bool waitFor(const std::function<bool(const State&)>& wanted) const;
    /// Waits for a picture of that name with all its pixels.
    bool waitForPicture(const std::string& name) const;

  private:
    struct Guest {
        int fd = -1;
        std::vector<std::uint8_t> bytes;
        std::size_t taken = 0;
    };
    void run();
    bool receive(Guest& guest);
    void decode(const std::uint8_t* packet, std::size_t size);

    std::atomic<Manner> manner_;
    std::atomic<bool> stop_{false};
    int listener_ = -1;
    std::uint16_t port_ = 0;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    State state_;
    std::map<std::string, std::vector<bool>> seen_;  ///< received pixels, by picture
    std::thread thread_;
};

}  // namespace lacuna::test
