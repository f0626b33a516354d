// The share of the processors that other programs leave to this one. (theory.md, "auto")
#pragma once

namespace lacuna {

/// The processor time that this process's threads have got since construction, as a share of the
/// time that they were ready to run. It is 1 if nothing else runs, or if the system does not tell.
class ProcessorShare {
  public:
    ProcessorShare() : start_(ofAllThreads()) {}
    /// The share, above 0 and at most 1.
    double value() const;

  private:
    struct Seconds {
        double run = 0.0;     ///< on a processor
        double waited = 0.0;  ///< ready to run, waiting for a processor
    };
    static Seconds ofAllThreads();

    Seconds start_;
};

}  // namespace lacuna
