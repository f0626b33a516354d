#include "render/choose/processor_share.h"

#include <ctime>
#include <filesystem>
#include <fstream>

namespace lacuna {

double ProcessorShare::value() const {
    const Seconds now = ofAllThreads();
    const double run = now.run - start_.run, waited = now.waited - start_.waited;
    // The waiting time of a thread that has ended is lost, so that `waited` may be negative.
    return run > 0.0 && waited > 0.0 ? run / (run + waited) : 1.0;
}

ProcessorShare::Seconds ProcessorShare::ofAllThreads() {
    Seconds sum;
    // The CPU-time clock, because the files below can be some milliseconds old for running threads.
    std::timespec run{};
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &run) == 0) {
        sum.run = double(run.tv_sec) + 1e-9 * double(run.tv_nsec);
    }
    std::error_code none;  // ignored: not Linux, or a thread has just ended
    for (std::filesystem::directory_iterator thread("/proc/self/task", none), end; thread != end;
         thread.increment(none)) {
        double ran = 0.0, waited = 0.0;  // in nanoseconds
        if (std::ifstream(thread->path() / "schedstat") >> ran >> waited) {
            sum.waited += 1e-9 * waited;
        }
    }
    return sum;
}

}  // namespace lacuna
