// The steps of long work: their names as they begin, and how long they took.
#pragma once

#include <functional>
#include <map>
#include <string>

namespace lacuna {

class Phases {
  public:
    /// `announce` is called with each phase's name when it begins; may be empty.
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
