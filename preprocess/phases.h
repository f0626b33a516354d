// Phases of long work: announces their names and measures their times.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace lacuna {

class Phases {
  public:
    /// `announce` is called with the name of each phase when it begins; may be empty.
    explicit Phases(std::function<void(const std::string&)> announce = {})
        : announce_(std::move(announce)) {}
    /// Runs `work` as the phase `name`.
    void run(const std::string& name, const std::function<void()>& work);
    const std::map<std::string, double>& seconds() const { return seconds_; }

  private:
    std::function<void(const std::string&)> announce_;
    std::map<std::string, double> seconds_;
};

}  // namespace lacuna
