#include "render/ranks/together.h"

#include <algorithm>
#include <bit>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>

#include "libcore/base/error.h"
#include "libcore/base/stopwatch.h"
#include "libcore/tool/tool.h"

namespace lacuna {
namespace {

using Tag = Ranks::Tag;

/// Durations of pieces in seconds. Longer pieces need fewer messages; shorter ones leave less
/// unfinished at the end.
constexpr double kShortestPiece = 2.0, kLongestPiece = 30.0;
/// Longer renders have longer pieces: an interrupt loses at most this share of the render.
constexpr double kShareOfRender = 0.05;
/// Largest number of pieces per rank that wait for an earlier one; they take memory.
constexpr std::size_t kWaitingPerRank = 4;
constexpr auto kPause = std::chrono::milliseconds(1);

/// A failure as the text "CODE text".
std::string letterOf(const Failure& failure) {
    return std::to_string(failure.exitCode) + " " + failure.text;
}

[[noreturn]] void throwFailure(const std::string& who, const std::string& text) {
    const std::size_t space = text.find(' ');
    throw Error(std::stoi(text.substr(0, space)), who + ": " + text.substr(space + 1));
}

}  // namespace

std::uint64_t pieceSize(std::uint64_t next, std::uint64_t end, const BlockPlan& plan,
                        bool wholeBlocks, int ranks, double seconds, double iterationSeconds) {
    const std::uint64_t inBlock = next % plan.iterations;
    std::uint64_t left = plan.iterations - inBlock;
    if (end > 0) left = std::min(left, end - next);
    if (wholeBlocks) return left;
    double wanted = iterationSeconds > 0.0 ? seconds / iterationSeconds : 1.0;
    if (end > 0) wanted = std::min(wanted, double(end - next) / (2.0 * ranks));
    const auto most = std::uint64_t(std::clamp(wanted, 1.0, double(left)));
    // After n = 2^k iterations, errors are estimated every n / 4 iterations.
    const std::uint64_t measured = std::max<std::uint64_t>(1, std::bit_floor(next) / 4);
    const std::uint64_t size = std::min(std::bit_floor(most), measured);
    return inBlock == 0 ? size : std::min(size, inBlock & (~inBlock + 1));
}

class LocalMember {
  public:
    explicit LocalMember(PieceMaker maker) : maker_(std::move(maker)) {}
    ~LocalMember() {
        {
            const std::lock_guard lock(mutex_);
            quit_ = stop_ = true;
        }
        wake_.notify_all();
        thread_.join();
    }
    LocalMember(const LocalMember&) = delete;
    LocalMember& operator=(const LocalMember&) = delete;

    void give(const Work& work) {
        {
            const std::lock_guard lock(mutex_);
            work_ = work;
        }
        wake_.notify_all();
    }
    void stop() { stop_ = true; }
    /// The finished piece, if any. Rethrows an error of the thread.
    std::optional<Part> poll() {
        const std::lock_guard lock(mutex_);
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
        return std::exchange(done_, std::nullopt);
    }

  private:
    void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            wake_.wait(lock, [&] { return quit_ || work_; });
            if (quit_) return;
            const Work work = *std::exchange(work_, std::nullopt);
            lock.unlock();
            std::optional<Part> part;
            std::exception_ptr failure;
            try {
                part = maker_.make(work, [&] { return stop_.load(); });
            } catch (...) {
                failure = std::current_exception();
            }
            lock.lock();
            done_ = std::move(part);
            failure_ = failure;
        }
    }

    PieceMaker maker_;
    std::mutex mutex_;
    std::condition_variable wake_;
    std::optional<Work> work_;
    std::optional<Part> done_;
    std::exception_ptr failure_;
    bool quit_ = false;
    std::atomic<bool> stop_{false};
    std::thread thread_{[this] { run(); }};
};

Together::Together(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter,
                   const PixelRect& crop, Limits limits, const std::atomic<bool>& interrupted,
                   const ThreadPool& pool)
    : ranks_(ranks),
      limits_(limits),
      interruptedHere_(interrupted),
      plan_(maker.plan()),
      wholeBlocks_(maker.blocksAreWhole()),
      local_(std::make_unique<LocalMember>(PieceMaker(maker, meter, crop, interrupted, pool))),
      work_(std::size_t(ranks.size())) {}

Together::~Together() {
    try {
        end();
    } catch (...) {
        // A rank failed while others were ending. The reason for the end is reported already.
    }
    local_.reset();
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, Tag::End);
}

bool Together::busy() const {
    return std::ranges::any_of(work_, [](const auto& work) { return work.has_value(); });
}

void Together::stop() {
    if (std::exchange(stopped_, true)) return;
    local_->stop();
    for (int rank = 1; rank < ranks_.size(); ++rank) {
        if (work_[std::size_t(rank)]) ranks_.send(rank, Tag::Stop);
    }
}

void Together::end() {
    stop();
    while (busy()) {
        if (!receive()) std::this_thread::sleep_for(kPause);
    }
}

/// Receives finished pieces and letters. False if there were none.
bool Together::receive() {
    bool any = false;
    if (work_[0]) {
        try {
            if (std::optional<Part> part = local_->poll()) {
                take(0, std::move(*part));
                any = true;
            }
        } catch (...) {
            work_[0].reset();
            throw;
        }
    }
    while (std::optional<Ranks::Letter> letter = ranks_.poll()) {
        any = true;
        if (letter->tag == Tag::Failure) {
            work_[std::size_t(letter->from)].reset();
            throwFailure(ranks_.name(letter->from), textOf(*letter));
        }
        const Stopwatch watch(piecesSeconds_);
        receivedBytes_ += letter->bytes.size();
        take(letter->from, partOf(letter->bytes));
    }
    return any;
}

void Together::take(int rank, Part part) {
    const Work work = *std::exchange(work_[std::size_t(rank)], std::nullopt);
    const std::uint64_t count = part.iterations();
    if (count < work.count && !stopped_) interrupted_ = true;
    if (count == 0) return;
    const double one = part.seconds / double(count);
    iterationSeconds_ = iterationSeconds_ > 0.0 ? 0.5 * (iterationSeconds_ + one) : one;
    made_.emplace(work.begin, std::move(part));
}

void Together::giveOut(const Film& film, double secondsSoFar) {
    if (stopped_ || interrupted_) return;
    if (interruptedHere_ && film.iterations() > 0) return;
    double seconds = std::clamp(kShareOfRender * secondsSoFar, kShortestPiece, kLongestPiece);
    if (limits_.seconds > 0.0) {
        seconds = std::min(seconds, 0.25 * (limits_.seconds - secondsSoFar));
    }
    for (int rank = 0; rank < ranks_.size(); ++rank) {
        std::optional<Work>& work = work_[std::size_t(rank)];
        if (work) continue;
        if (limits_.end > 0 && *next_ >= limits_.end) return;
        if (made_.size() >= kWaitingPerRank * std::size_t(ranks_.size())) return;
        const std::uint64_t size = pieceSize(*next_, limits_.end, plan_, wholeBlocks_,
                                             ranks_.size(), seconds, iterationSeconds_);
        work = {*next_, size, film.iterations() == 0 && *next_ == film.nextIteration()};
        *next_ += size;
        if (rank == 0) {
            local_->give(*work);
        } else {
            ranks_.send(rank, Tag::Work, std::as_bytes(std::span(&*work, 1)));
        }
    }
}

bool Together::advance(Film& film, Totals& totals) {
    if (!next_) {
        next_ = film.nextIteration();
        told_ = Clock::now();
    }
    const bool received = receive();
    const Clock::time_point now = Clock::now();
    totals.seconds += std::chrono::duration<double>(now - std::exchange(told_, now)).count();
    giveOut(film, totals.seconds);
    auto found = made_.find(film.nextIteration());
    if (found == made_.end()) {
        if (!received) std::this_thread::sleep_for(kPause);
        return false;
    }
    Part part = std::move(found->second);
    made_.erase(found);
    const Stopwatch watch(piecesSeconds_);
    // The pool is busy with a piece, so that this thread adds alone.
    for (SumTree::Node& node : part.sums.open) film.add(std::move(node), nullptr);
    totals.statistics.add(part.statistics);
    return true;
}

void serve(const Ranks& ranks, BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
           const std::atomic<bool>& interrupted, const ThreadPool& pool) {
    PieceMaker pieces(maker, meter, crop, interrupted, pool);
    bool ended = false;
    const auto stop = [&] {
        const std::optional<Ranks::Letter> letter = ranks.poll();
        ended = ended || (letter && letter->tag == Tag::End);
        return letter.has_value();
    };
    while (!ended) {
        const Ranks::Letter letter = ranks.wait();
        if (letter.tag == Tag::End) return;
        if (letter.tag != Tag::Work) continue;  // a stop that arrived too late
        Work work;
        std::memcpy(&work, letter.bytes.data(), sizeof work);
        try {
            ranks.send(0, Tag::Piece, bytesOf(pieces.make(work, stop)));
        } catch (...) {
            ranks.send(0, Tag::Failure, letterOf(failureOfCurrentException()));
        }
    }
}

}  // namespace lacuna
