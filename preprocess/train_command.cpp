#include "preprocess/train_command.h"

#include "libcore/base/number_text.h"
#include "libcore/guide/emission_settings.h"
#include "libcore/guide/walk_settings.h"
#include "libcore/subspace/training_settings.h"
#include "libcore/tool/table_options.h"
#include "libcore/tool/tool.h"

namespace lacuna {

namespace {
const std::string kTraining = "train.";  // prefix of the options of training
}

std::uint64_t trainingPaths(const Settings& settings) {
    const auto found = settings.find(kTraining + "paths");
    return found == settings.end() ? 0 : std::uint64_t(parseNumber(found->second).value());
}

std::string trainRemedy(const AssetRequest& r) {
    if (trainingPaths(r.settings) == 0) return "add --prepare";
    const auto emission = emissionOptions(Emission::Learned);
    const auto walks = walkOptions(Walks::Plain);
    const auto training = trainingOptions();
    return "add --prepare, or run lacuna-train" +
           optionArguments(changedValues(emission, emission.read(r.settings))) +
           optionArguments(changedValues(walks, walks.read(r.settings))) +
           optionArguments(
               changedValues<TrainingSettings>(training, training.read(r.settings, kTraining))) +
           sceneArguments(r.options) + viewArguments(r.options) + " " +
           shellQuoted(r.options.scene);
}

}  // namespace lacuna
