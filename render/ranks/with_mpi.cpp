// The only file that uses MPI. Waits sleep between polls: MPI's own waiting occupies a core, which
// the ranks on one machine need for rendering.
#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <thread>

#include "libcore/base/error.h"
#include "libcore/tool/tool.h"
#include "render/ranks/ranks.h"

namespace lacuna {
namespace {

constexpr std::size_t kSlice = std::size_t(1) << 28;  // MPI counts bytes in an int

/// Whether mpirun, or srun with PMI, started this process. Other processes skip MPI, which takes .4
/// s to start.
bool launched() {
    constexpr const char* kSigns[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
    return std::any_of(std::begin(kSigns), std::end(kSigns),
                       [](const char* sign) { return std::getenv(sign) != nullptr; });
}

void waitFor(MPI_Request& request) {
    for (int done = 0;;) {
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

/// The outcome of a stage on one rank.
struct Outcome {
    int code = 0;  ///< exit code; 0: success
    std::array<char, 2044> text{};

    void set(const Failure& failure) {
        code = failure.exitCode;
        std::snprintf(text.data(), text.size(), "%s", failure.text.c_str());
    }
};

}  // namespace

Ranks::Ranks() {
    if (!launched()) return;
    int provided = 0, size = 1;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    joined_ = true;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    using Name = std::array<char, MPI_MAX_PROCESSOR_NAME + 1>;
    Name own{};
    int length = 0;
    MPI_Get_processor_name(own.data(), &length);
    std::vector<Name> names(std::size_t(size), Name{});
    MPI_Allgather(own.data(), int(own.size()), MPI_CHAR, names.data(), int(own.size()), MPI_CHAR,
                  MPI_COMM_WORLD);
    machines_.clear();
    for (const Name& name : names) machines_.emplace_back(name.data());
}

Ranks::~Ranks() {
    if (joined_) MPI_Finalize();
}

bool Ranks::agree(const std::function<void()>& stage) const {
    if (!many()) {
        stage();
        return true;
    }
    Outcome own;
    std::exception_ptr thrown;
    try {
        stage();
    } catch (...) {
        own.set(failureOfCurrentException());
        thrown = std::current_exception();
    }
    std::vector<Outcome> all(machines_.size());
    MPI_Request request;
    MPI_Iallgather(&own, int(sizeof own), MPI_BYTE, all.data(), int(sizeof own), MPI_BYTE,
                   MPI_COMM_WORLD, &request);
    waitFor(request);
    const auto failed = std::ranges::find_if(all, [](const Outcome& o) { return o.code != 0; });
    if (failed == all.end()) return true;
    if (!leads()) return false;
    if (thrown) std::rethrow_exception(thrown);
    throw Error(failed->code, name(int(failed - all.begin())) + ": " + failed->text.data());
}

void Ranks::send(int to, Tag tag, std::span<const std::byte> bytes) const {
    const std::uint64_t size = bytes.size();
    MPI_Send(&size, 1, MPI_UINT64_T, to, int(tag), MPI_COMM_WORLD);
    for (std::size_t at = 0; at < bytes.size(); at += kSlice) {
        MPI_Send(bytes.data() + at, int(std::min(kSlice, bytes.size() - at)), MPI_BYTE, to,
                 int(tag), MPI_COMM_WORLD);
    }
}

std::optional<Ranks::Letter> Ranks::poll() const {
    MPI_Status status;
    int there = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (!there) return std::nullopt;
    Letter letter{status.MPI_SOURCE, Tag(status.MPI_TAG), {}};
    std::uint64_t size = 0;
    MPI_Recv(&size, 1, MPI_UINT64_T, letter.from, status.MPI_TAG, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    letter.bytes.resize(size);
    for (std::size_t at = 0; at < size; at += kSlice) {
        MPI_Recv(letter.bytes.data() + at, int(std::min(kSlice, size - at)), MPI_BYTE, letter.from,
                 status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    return letter;
}

}  // namespace lacuna
