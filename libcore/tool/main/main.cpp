// The main function of every tool; LACUNA_TOOL is the tool's function. The tools themselves are part of the library:
// the headers of command lines take seconds in every file that includes them.
#include "libcore/tool/tool.h"

namespace lacuna {
int LACUNA_TOOL(int argc, char** argv);
}

int main(int argc, char** argv) {
    return lacuna::runTool([&] { return lacuna::LACUNA_TOOL(argc, argv); });
}
