#include "render/study/machine.h"

#include <sys/utsname.h>

#include <fstream>
#include <thread>

namespace lacuna {

std::string machineText() {
    std::string model = "unknown processor";
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            model = line.substr(colon + 2);
            break;
        }
    }
    struct utsname system {};
    uname(&system);
    return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads, " +
           system.sysname + " " + system.machine;
}

}  // namespace lacuna
