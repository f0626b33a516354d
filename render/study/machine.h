// The machine on which times are measured.
#pragma once

#include <string>

namespace lacuna {

/// Processor, number of threads, operating system: "Intel ..., 8 threads, Linux x86_64". Runs on
/// different machines are different runs of a study.
std::string machineText();

}  // namespace lacuna
