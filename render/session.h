// One render from the loaded scene to the saved image: warm-up, iterations, curve, result.
#pragma once

#include <memory>
#include <optional>

#include "libcore/bidir/error_estimate.h"
#include "libcore/image/error_metrics.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/progress.h"
#include "render/caches.h"
#include "render/checkpoint.h"
#include "render/curve_log.h"
#include "render/options.h"
#include "render/output.h"
#include "render/proposal_layers.h"
#include "render/stage.h"

namespace lacuna {

class Session {
  public:
    /// All references must outlive the session. Loads the scene.
    Session(const RenderOptions& options, const MethodRow& row, const Settings& settings,
            const ThreadPool& pool, const InterruptGuard& interrupt, Progress& progress);
    ~Session();

    /// Renders and saves; what was written goes to stdout. Returns the exit code.
    int run();

  private:
    std::unique_ptr<Method> freshMethod() const;
    CacheStamp inputs() const;
    void loadReference();
    void describeStage() const;
    void goOn(Part part);
    bool beginBlock();
    void render();
    bool renderIteration();
    bool mayBegin() const;
    Part part() const;
    void saveCheckpoint();
    void finishCheckpoint();
    void prepareMeter();
    void estimateErrorNow();
    bool isAccurate();
    bool isEstimated() const;
    ErrorNow errorNow() const;
    int printCost();
    void measure();
    void logRow();
    void save();
    void warnIfBlack();
    void warnAboutDefects();
    std::string replayCommand(const std::string& replay) const;

    const RenderOptions& options_;
    const ThreadPool& pool_;
    const InterruptGuard& interrupt_;
    Progress& progress_;

    Stage stage_;
    Caches caches_;
    const MethodRow& row_;
    const Settings& methodSettings_;
    std::unique_ptr<Method> method_;  ///< of the open block
    BlockPlan plan_;
    Film film_;
    std::unique_ptr<BidirIntegrator> integrator_;
    std::vector<Rgb> pixels_;  ///< of an iteration
    std::optional<FeatureLayers> features_;
    std::optional<ErrorMeter> meter_;
    std::optional<TechniqueFilm> techniques_;
    std::optional<ProposalLayers> proposalLayers_;
    std::unique_ptr<WeightVerifier> verifier_;
    std::optional<ErrorReference> reference_;
    std::optional<CurveLog> log_;
    CacheStamp inputs_;  ///< where parts are written or read
    std::optional<Checkpoint> checkpoint_;
    std::string failure_;           ///< of log or checkpoint: a full disk must not cost the picture
    std::uint64_t end_ = 0;         ///< iteration behind the last one; 0: none
    double expectedSeconds_ = 0.0;  ///< of the next iteration
    /// Of iterations that are in the film, and of their blocks' warm-ups.
    struct Totals {
        double seconds = 0.0;
        IterationStatistics statistics;
    };
    Totals totals_;
    Totals ofBlocks_;               ///< of whole blocks alone
    double estimateSeconds_ = 0.0;  ///< of the totals, when the error was last estimated
    bool doubtSaid_ = false;
    RenderReport report_;
};

}  // namespace lacuna
