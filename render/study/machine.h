// What the times were measured on.
#pragma once

#include <string>

namespace lacuna {

/// Processor, number of threads, operating system: "Intel ..., 8 threads, Linux x86_64". A study's
/// runs on another machine are other runs.
std::string machineText();

}  // namespace lacuna
