// One render from the loaded scene to the saved image: warm-up, iterations, curve, result.
#pragma once

#include <memory>
#include <optional>

#include "libcore/image/error_metrics.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/progress.h"
#include "render/caches.h"
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
    void loadReference();
    void describeStage() const;
    void render();
    bool mayBegin() const;
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
    std::unique_ptr<Method> method_;
    std::unique_ptr<BidirIntegrator> integrator_;
    Film film_;
    std::optional<TechniqueFilm> techniques_;
    std::optional<ProposalLayers> proposalLayers_;
    std::unique_ptr<WeightVerifier> verifier_;
    std::optional<ErrorReference> reference_;
    std::optional<CurveLog> log_;
    std::string logFailure_;        ///< a full disk must not cost the picture
    double expectedSeconds_ = 0.0;  ///< of the next iteration
    RenderReport report_;
};

}  // namespace lacuna
