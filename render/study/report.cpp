#include "render/study/report.h"

#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "render/output.h"
#include "render/study/page.h"
#include "render/study/page_data.h"
#include "render/study/pictures.h"
#include "render/study/provenance.h"
#include "render/study/tables.h"

namespace lacuna {

std::vector<std::string> writeReport(const Results& results, const std::string& directory,
                                     const std::string& command, const std::string& chartLibrary,
                                     const ReportCopies& copies) {
    std::vector<std::string> written;
    const auto writeTo = [&](const std::string& path, const std::string& content) {
        written.push_back(path);
        writeFileAtomically(path, content);
    };
    const auto write = [&](const std::string& name, const std::string& content) {
        writeTo(directory + "/" + name, content);
    };
    write("raw.csv", rawCsv(results));
    write("runs.csv", runsCsv(results));
    const std::vector<Table> tables = makeTables(results);
    for (const Table& table : tables) write(table.id + ".csv", csv(table));
    const std::string summary = markdown(results.study, provenance(results, command), tables);
    write("tables.md", summary);
    if (!copies.summary.empty()) writeTo(copies.summary, summary);
    const nlohmann::json data = pageData(results, tables);
    write("index.html", pageHtml(results.study.title, chartLibrary, data, picturesJson(results)));
    if (!copies.json.empty()) writeJson(copies.json, data);
    return written;
}

}  // namespace lacuna
