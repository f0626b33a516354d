#include "render/merge.h"

#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/image/exr.h"
#include "render/output.h"
#include "render/part.h"
#include "render/relight.h"

namespace lacuna {
namespace {

struct PartFile {
    std::string path;
    Part part;  ///< without the pixels of its sums: all parts together may exceed the memory

    /// One past its last block, whole or not.
    std::uint64_t end() const { return part.sums.openBlock + (part.sums.open.empty() ? 0 : 1); }
};

std::string blocksText(const PartFile& file) {
    return std::to_string(file.part.firstBlock) + " to " + std::to_string(file.end() - 1);
}

Part readPart(const std::string& path) {
    LayeredImage image = readExrLayers(path);
    return takePart(image, path);
}

void requireSameRender(const PartFile& first, const PartFile& other) {
    const std::string different = differencesText(first.part.inputs, other.part.inputs);
    if (different.empty()) return;
    throw InputError(other.path + ": expected a part of the same picture as " + first.path +
                     ", found another " + different + "; merge parts of one command");
}

/// Checks two parts that are adjacent in the order of blocks.
void requireNeighbours(const PartFile& left, const PartFile& right, bool gaps,
                       std::vector<std::string>& warnings) {
    if (right.part.firstBlock < left.end()) {
        throw InputError(right.path + ": expected blocks behind those of " + left.path + " (" +
                         blocksText(left) + "), found blocks " + blocksText(right) +
                         "; leave one of the two out");
    }
    std::string missing;
    if (!left.part.sums.open.empty()) {
        missing = left.path + ": expected whole blocks, found block " +
                  std::to_string(left.part.sums.openBlock) + " unfinished";
    } else if (right.part.firstBlock > left.end()) {
        missing = right.path + ": expected block " + std::to_string(left.end()) +
                  " to be next, found block " + std::to_string(right.part.firstBlock);
    }
    if (missing.empty()) return;
    if (!gaps) throw InputError(missing + "; render what is missing, or add --gaps");
    warnings.push_back(missing);
}

}  // namespace

Merged mergeParts(const std::vector<std::string>& paths, bool gaps, const ThreadPool& pool) {
    Merged merged;
    std::vector<PartFile> files;
    for (const std::string& path : paths) {
        LayeredImage image = readExrLayers(path);
        files.push_back({path, takePart(image, path)});
        for (auto* nodes : {&files.back().part.sums.blocks, &files.back().part.sums.open}) {
            for (SumTree::Node& node : *nodes) node.sum.reset();
        }
        requireSameRender(files.front(), files.back());
        if (files.size() == 1) merged.image = std::move(image);
    }
    std::ranges::stable_sort(files, {}, [](const PartFile& f) { return f.part.firstBlock; });
    if (files.front().part.firstBlock > 0) {
        const std::string missing = files.front().path + ": expected block 0 to be first, found " +
                                    "blocks " + blocksText(files.front());
        if (!gaps) throw InputError(missing + "; render what is missing, or add --gaps");
        merged.warnings.push_back(missing);
    }
    for (std::size_t i = 1; i < files.size(); ++i) {
        requireNeighbours(files[i - 1], files[i], gaps, merged.warnings);
    }

    const BlockPlan plan = files.front().part.plan;
    SumTree blocks(1);
    FilmSum last;  // the open block at the end, which is not in the tree
    IterationStatistics statistics;
    double seconds = 0.0;
    for (std::size_t i = 0; i < files.size(); ++i) {
        Part part = readPart(files[i].path);
        merged.blocks += files[i].end() - part.firstBlock;
        merged.iterations += part.iterations();
        statistics.add(part.statistics);
        seconds += part.seconds;
        for (SumTree::Node& node : part.sums.blocks) blocks.add(std::move(node), &pool);
        SumTree open(plan.sampleIterations(), plan.relationInSample());
        for (SumTree::Node& node : part.sums.open) open.add(std::move(node), &pool);
        FilmSum sum;
        open.addTo(sum, &pool);
        if (i + 1 == files.size()) {
            last = std::move(sum);
        } else if (sum.iterations > 0) {
            blocks.add({part.sums.openBlock, 1, std::make_shared<FilmSum>(std::move(sum))}, &pool);
        }
    }
    FilmSum sum;
    blocks.addTo(sum, &pool);
    join(sum, last, SumRelation::Samples, &pool);

    merged.mean = sum.meanColour();
    setPicture(merged.image, sum, lightGroupsOf(merged.image, files.front().path));
    auto& a = merged.image.attributes;
    if (merged.image.find("share.t02")) {
        addShareOfFirstConnections(merged.image, std::get<int>(a.at("maxDepth")));
    }
    a["iterations"] = integerAttribute(merged.iterations);
    a["renderTimeSeconds"] = seconds;
    a["rays"] = double(statistics.totalRays());
    a["invalidSamples"] = integerAttribute(statistics.invalidSamples);
    return merged;
}

}  // namespace lacuna
