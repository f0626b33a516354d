// What other programs leave of the processors to this one. (theory.md, "auto")
#pragma once

namespace lacuna {

/// Of the processor time that the threads of this process have wanted since construction, the share
/// that they have had: 1 where nothing else runs, or where the system does not tell.
class ProcessorShare {
  public:
    ProcessorShare() : start_(ofAllThreads()) {}
    /// Above 0, at most 1.
    double value() const;

  private:
    struct Seconds {
        double run = 0.0;     ///< on a processor
        double waited = 0.0;  ///< for one, ready to run
    };
    static Seconds ofAllThreads();

    Seconds start_;
};

}  // namespace lacuna
