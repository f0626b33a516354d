// One render, from the loaded data to the saved image: iterations, curve, checkpoints, result.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libcore/image/error_metrics.h"
#include "libcore/tool/progress.h"
#include "render/background_job.h"
#include "render/block_maker.h"
#include "render/checkpoint.h"
#include "render/crew.h"
#include "render/curve_log.h"
#include "render/first_look.h"
#include "render/live/live_view.h"
#include "render/options.h"
#include "render/output.h"
#include "render/ranks/ranks.h"
#include "render/rendered.h"

namespace lacuna {

class Together;

class Session {
  public:
    /// All references must outlive the session. With several ranks, it runs on rank 0 while the
    /// others serve().
    Session(const RenderOptions& options, const MethodRow& row, const Settings& settings,
            const std::optional<RowChoice>& choice, const Stage& stage, const Caches& caches,
            const FirstLook& look, BlockMaker& maker, const Ranks& ranks, const ThreadPool& pool,
            const std::atomic<bool>& interrupted, Progress& progress);
    ~Session();

    /// Renders and saves. To be called once.
    Rendered run();

  private:
    void loadReference();
    void describeStage() const;
    void goOn(Part part);
    void render();
    std::string whyStop();
    void estimateErrorNow();
    bool isAccurate();
    bool isEstimated() const;
    ErrorNow errorNow() const;
    Rendered costs();
    Rendered finished(std::string text);
    const std::string& pictureName() const;
    bool mayBegin() const;
    void tell();
    void keep();
    Part part() const;
    const ThreadPool* idlePool() const;
    const LayeredImage& still();
    void addMattes(LayeredImage& image);
    void beginLiveView();
    std::vector<std::string> channelNames();
    LayeredImage shown(const FilmSum& sum);
    void showLive();
    void refreshOutput();
    LayeredImage output(const RenderReport& report, const FilmSum& sum);
    void saveCheckpoint();
    void finishCheckpoint();
    void measure();
    void logRow();
    PngStyle fixedExposure(const LayeredImage& image);
    void save();
    std::string savedText() const;
    void saveUnfinished();
    void warnIfBlack();
    void warnAboutDefects();
    std::string replayCommand(const std::string& replay) const;

    const RenderOptions& options_;
    const ThreadPool& pool_;
    const std::atomic<bool>& interrupted_;
    Progress& progress_;

    const Stage& stage_;
    const Caches& caches_;
    const FirstLook& look_;
    BlockMaker& maker_;
    BlockPlan plan_;
    Film film_;
    std::unique_ptr<Crew> crew_;
    Together* together_ = nullptr;  ///< the crew, if there are other ranks
    std::optional<ErrorReference> reference_;
    std::optional<CurveLog> log_;
    CacheStamp inputs_;  ///< if parts are written or read
    std::optional<Checkpoint> checkpoint_;
    std::optional<LayeredImage> still_;     ///< still(), once needed
    std::optional<BackgroundJob> refresh_;  ///< of the output
    std::optional<LiveView> live_;
    LayeredImage image_;            ///< as saved
    std::string failure_;           ///< of log or checkpoint: a full disk must not lose the picture
    std::uint64_t end_ = 0;         ///< one past the last iteration; 0: no limit
    Totals totals_;                 ///< of the iterations in the film
    Totals ofBlocks_;               ///< of whole blocks only
    double estimateSeconds_ = 0.0;  ///< totals_.seconds at the last estimate of the error
    bool doubtSaid_ = false;
    RenderReport report_;
};

}  // namespace lacuna
